// SPDX-License-Identifier: BSD-3-Clause
// One line on stderr that shows how a long run is doing; nothing unless stderr is a terminal.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

namespace lsv::cli {

class Progress {
 public:
  /// `total`: frames to come, if known. `quiet` silences it.
  Progress(std::optional<std::int64_t> total, bool quiet);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// After each frame; draws at most ten times a second.
  void frame_done(bool rejected);

 private:
  using Clock = std::chrono::steady_clock;
  void draw(Clock::time_point now) const;

  std::optional<std::int64_t> total_;
  bool active_;
  Clock::time_point start_;
  Clock::time_point last_drawn_;
  std::int64_t frames_ = 0;
  std::int64_t rejected_ = 0;
};

}  // namespace lsv::cli
