// SPDX-License-Identifier: BSD-3-Clause
// What receives the StepReports of a run, and what every output says about the run.
// A sink is handed every report in order, the first_frame report included, then finish() once.
// finish() brings everything to the disk, commit() lets it appear under its name: with several
// sinks, all finish before the first commits, so that a failed run leaves no new file. A sink that
// is destroyed before commit() leaves nothing behind. A sink belongs to one thread at a time.
#pragma once

#include <cstdint>
#include <string>

#include "lsv/core/config.h"
#include "lsv/core/frame.h"
#include "lsv/core/result.h"
#include "lsv/core/step_report.h"

namespace lsv {

/// Everything about a run that is known before its first frame. Text may hold any bytes.
struct RunInfo {
  std::string version;             // of lsv
  std::string source_description;  // e.g. "PNG sequence frames/*.png"
  FrameFormat format;
  std::string time_base;  // "1000 Hz" or the name of the timestamp file
  TrackConfig config;
  LagRange max_shift;           // as resolved, see CorrelationConfig::max_shift_px
  std::int64_t index_step = 1;  // between the indices of consecutive frames, >= 1
};

struct RunEnd {
  bool interrupted = false;  // stopped by a signal before the source ended
};

class TrackSink {
 public:
  virtual ~TrackSink() = default;

  /// An error ends the output: destroy the sink, do not finish it.
  virtual Result<void> write(const StepReport& report) = 0;
  virtual Result<void> finish(const RunEnd& end) = 0;
  virtual Result<void> commit() = 0;
};

}  // namespace lsv
