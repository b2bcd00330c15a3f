// SPDX-License-Identifier: BSD-3-Clause
// How a live run is doing, on stderr: a block that is drawn again and again on a terminal, a line a
// second elsewhere, and events as lines between.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "lsv/core/health_snapshot.h"
#include "lsv/core/step_report.h"
#include "lsv/stream/stream_sink.h"

namespace lsv::cli {

/// The lines of the block, without line ends.
std::vector<std::string> dashboard_block(const HealthSnapshot& health, const StepReport& last);
std::string latency_line(const HealthSnapshot& health);
std::string losses_line(const HealthSnapshot& health);
/// The same in one line.
std::string dashboard_line(const HealthSnapshot& health, const StepReport& last);

class LiveDashboard {
 public:
  explicit LiveDashboard(bool quiet);
  ~LiveDashboard();
  LiveDashboard(const LiveDashboard&) = delete;
  LiveDashboard& operator=(const LiveDashboard&) = delete;

  void measured(const StepReport& report) { last_ = report; }
  /// Events are told even when it is quiet, but for those that are mere information.
  void tell(const StreamEvent& event);
  bool is_due() const;
  void draw(const HealthSnapshot& health);

 private:
  using Clock = std::chrono::steady_clock;
  void wipe();

  bool quiet_;
  bool terminal_;
  Clock::time_point drawn_;
  std::size_t lines_ = 0;  // of the block that stands on the terminal
  StepReport last_{};
};

}  // namespace lsv::cli
