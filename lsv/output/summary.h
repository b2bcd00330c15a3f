// SPDX-License-Identifier: BSD-3-Clause
// A whole run in a few numbers. Every frame is added once and nothing is kept of it, so memory
// does not grow with the run. The numbers depend on the frames and settings alone - no date, no
// machine, no timing - so that the same input gives the same bytes. Definitions: docs/formats.md.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lsv/output/output_file.h"
#include "lsv/output/track_sink.h"

namespace lsv {

struct Summary {
  std::int64_t frames = 0;
  std::int64_t shifts_ok = 0;
  std::int64_t shifts_rejected = 0;
  /// In the order of kAllShiftStatuses; only reasons that occurred.
  std::vector<std::pair<ShiftStatus, std::int64_t>> rejected;
  double rejected_share = kUnknown;  // of all shifts, [0, 1]
  std::int64_t missing_frames = 0;   // holes between the frame indices
  double duration_s = kUnknown;      // first to last stamp
  double held_time_s = 0.0;          // time that passed during refused shifts
  double path_length_m = 0.0;        // sum of the lengths of the accepted steps
  SensorPosition end;                // unknown when there was no frame
  double mean_speed_m_s = kUnknown;  // path length over the time of accepted shifts
  double max_speed_m_s = kUnknown;
  double mean_zncc = kUnknown;     // of accepted shifts
  double median_q = kUnknown;      // of accepted shifts, within 0.5 %
  double static_share = kUnknown;  // as last known, see StepReport
  bool interrupted = false;
};

/// The text of summary.json.
std::string summary_json(const RunInfo& info, const Summary& summary);

/// The same for a person: a few lines with units, for stderr.
std::string summary_text(const Summary& summary);

/// Median of values >= 1 from counts in classes that are 1 % wide.
class MedianCounter {
 public:
  void add(double value);
  double median() const;

 private:
  static constexpr int kClasses = 2048;  // up to 1.01^2048 = 7e8
  std::array<std::int64_t, kClasses> counts_{};
  std::int64_t total_ = 0;
};

class SummaryBuilder : public TrackSink {
 public:
  /// Without a file only summary() is of use.
  explicit SummaryBuilder(RunInfo info, std::optional<OutputFile> file = std::nullopt);

  Result<void> write(const StepReport& report) override;
  Result<void> finish(const RunEnd& end) override;
  Result<void> commit() override;

  /// Of the frames written so far.
  Summary summary() const;

 private:
  void add_accepted(const StepReport& report);
  void add_gap(const StepReport& report);

  RunInfo info_;
  std::optional<OutputFile> file_;
  bool interrupted_ = false;

  std::int64_t frames_ = 0;
  std::int64_t first_ns_ = 0;
  StepReport last_;
  std::array<std::int64_t, kAllShiftStatuses.size()> count_by_status_{};
  std::int64_t missing_frames_ = 0;
  std::int64_t accepted_ns_ = 0;
  std::int64_t held_ns_ = 0;
  double path_length_m_ = 0.0;
  double max_speed_m_s_ = kUnknown;
  double zncc_sum_ = 0.0;
  MedianCounter q_;
};

}  // namespace lsv
