// SPDX-License-Identifier: BSD-3-Clause
#include "tools/progress.h"

#include <unistd.h>

#include <cstdio>

namespace lsv::cli {

Progress::Progress(std::optional<std::int64_t> total, bool quiet)
    : total_(total),
      active_(!quiet && isatty(STDERR_FILENO) != 0),
      start_(Clock::now()),
      last_drawn_(start_) {}

Progress::~Progress() {
  if (active_) std::fputs("\r\033[K", stderr);
}

void Progress::frame_done(bool rejected) {
  ++frames_;
  rejected_ += rejected ? 1 : 0;
  if (!active_) return;
  const Clock::time_point now = Clock::now();
  if (now - last_drawn_ < std::chrono::milliseconds(100)) return;
  last_drawn_ = now;
  draw(now);
}

void Progress::draw(Clock::time_point now) const {
  const double elapsed_s = std::chrono::duration<double>(now - start_).count();
  const double rate_hz = static_cast<double>(frames_) / elapsed_s;
  const double rejected_percent =
      100.0 * static_cast<double>(rejected_) / static_cast<double>(frames_);
  std::fprintf(stderr, "\r\033[K%lld", static_cast<long long>(frames_));
  if (total_) std::fprintf(stderr, "/%lld", static_cast<long long>(*total_));
  std::fprintf(stderr, " frames, %.0f frames/s, %.1f %% rejected", rate_hz, rejected_percent);
  if (total_ && *total_ > frames_)
    std::fprintf(stderr, ", %.0f s left", static_cast<double>(*total_ - frames_) / rate_hz);
}

}  // namespace lsv::cli
