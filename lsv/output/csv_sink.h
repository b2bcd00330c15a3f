// SPDX-License-Identifier: BSD-3-Clause
// The track as CSV: "# key: value" lines that tell the run, one header line, one row per frame
// after the first. Cells other than frame, time_s, dt_s and status are empty where the shift was
// refused. Layout and column meanings: docs/formats.md.
#pragma once

#include <string>
#include <string_view>

#include "lsv/output/output_file.h"
#include "lsv/output/track_sink.h"

namespace lsv {

inline constexpr std::string_view kCsvHeader =
    "frame,time_s,dt_s,dx_px,dy_px,sigma_dx_px,sigma_dy_px,zncc,q,status,"
    "vx_m_s,vy_m_s,x_m,y_m,sigma_vx_m_s,sigma_vy_m_s,motion";

class CsvSink : public TrackSink {
 public:
  CsvSink(OutputFile file, const RunInfo& info);

  Result<void> write(const StepReport& report) override;
  Result<void> finish(const RunEnd& end) override;
  Result<void> commit() override { return file_.commit(); }

 private:
  Result<void> write_head();

  OutputFile file_;
  std::string head_;  // written with the first row, or at the end of an empty run
  std::string row_;   // kept for its memory
};

}  // namespace lsv
