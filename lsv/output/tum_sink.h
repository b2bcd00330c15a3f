// SPDX-License-Identifier: BSD-3-Clause
// The trajectory in the TUM RGB-D format, "t x y z qx qy qz qw", for evo and other evaluators:
// the first frame and every frame with an accepted shift. z is 0 and the rotation is identity:
// the sensor axes do not turn. No header and no comment lines, so an interrupted run is not
// marked here.
#pragma once

#include <string>

#include "lsv/output/output_file.h"
#include "lsv/output/track_sink.h"

namespace lsv {

class TumSink : public TrackSink {
 public:
  explicit TumSink(OutputFile file) : file_(std::move(file)) {}

  Result<void> write(const StepReport& report) override;
  Result<void> finish(const RunEnd& end) override;
  Result<void> commit() override { return file_.commit(); }

 private:
  OutputFile file_;
  std::string row_;  // kept for its memory
};

}  // namespace lsv
