// SPDX-License-Identifier: BSD-3-Clause
// The track as JSON Lines: one object per frame, the first included. null where a value is
// unknown; unlike the CSV, the measured quality of a refused shift is kept. Keys: docs/formats.md.
#pragma once

#include "lsv/output/output_file.h"
#include "lsv/output/track_sink.h"

namespace lsv {

class JsonlSink : public TrackSink {
 public:
  explicit JsonlSink(OutputFile file) : file_(std::move(file)) {}

  Result<void> write(const StepReport& report) override;
  Result<void> finish(const RunEnd& end) override;
  Result<void> commit() override { return file_.commit(); }

 private:
  OutputFile file_;
};

}  // namespace lsv
