// SPDX-License-Identifier: BSD-3-Clause
#include "tools/budget_measure.h"

#include <sched.h>
#include <sys/prctl.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <memory>
#include <utility>

#include "correlation/peak.h"
#include "correlation/quality.h"
#include "lsv/odometer.h"
#include "tools/interrupt.h"

namespace lsv::cli {
namespace {

/// First frames are slow (page faults, cold caches, a sleeping clock) and are not counted.
constexpr int kWarmUpFrames = 16;

/// The stages of a full search one by one, with clocks between them.
class StageTimer {
 public:
  StageTimer(std::unique_ptr<Correlator> correlator, PeakFit fit, std::size_t capacity)
      : correlator_(std::move(correlator)),
        fit_(fit),
        earlier_(correlator_->make_prepared_frame()),
        later_(correlator_->make_prepared_frame()),
        plane_(correlator_->make_plane()),
        prepare_(capacity),
        correlate_(capacity),
        peak_and_quality_(capacity) {}

  void run(const FrameView& frame, bool counted) {
    const std::int64_t start = clock_now_ns();
    correlator_->prepare(frame, later_);
    const std::int64_t prepared = clock_now_ns();
    correlator_->correlate(earlier_, later_, plane_);
    const std::int64_t correlated = clock_now_ns();
    find_and_judge();
    const std::int64_t end = clock_now_ns();
    std::swap(earlier_, later_);
    if (!counted) return;
    prepare_.add(prepared - start);
    correlate_.add(correlated - prepared);
    peak_and_quality_.add(end - correlated);
  }

  void report(UnpacedTimes& out) const {
    out.prepare = prepare_.summary();
    out.correlate = correlate_.summary();
    out.peak_and_quality = peak_and_quality_.summary();
  }

 private:
  void find_and_judge() {
    const Peak peak = find_peak(plane_, fit_);
    const FrameFormat& format = correlator_->format();
    const double overlap_px = static_cast<double>(format.width_px - std::abs(peak.lag_dx_px)) *
                              (format.height_px - std::abs(peak.lag_dy_px));
    quality_ = measure_quality(plane_, peak, overlap_px);
  }

  std::unique_ptr<Correlator> correlator_;
  PeakFit fit_;
  PreparedFrame earlier_;
  PreparedFrame later_;
  CorrelationPlane plane_;
  ShiftQuality quality_;
  DurationSamples prepare_;
  DurationSamples correlate_;
  DurationSamples peak_and_quality_;
};

/// Whole pushes, and whether their answers are right.
class PushTimer {
 public:
  PushTimer(Odometer odometer, const SimulatedLoop& loop, std::size_t capacity)
      : odometer_(std::move(odometer)), loop_(loop), push_(capacity) {}

  Result<void> run(std::int64_t k, bool counted) {
    const std::int64_t start = clock_now_ns();
    const Result<StepReport> report = odometer_.push(loop_.frame(k));
    const std::int64_t end = clock_now_ns();
    if (!report) return report.error();
    if (!counted) return {};
    push_.add(end - start);
    check(report.value().shift, loop_.shift(k));
    return {};
  }

  void report(UnpacedTimes& out) const {
    out.push = push_.summary();
    out.shifts_refused = shifts_refused_;
    out.largest_error_px = largest_error_px_;
  }

 private:
  void check(const Shift& shift, const TrueShift& truth) {
    if (shift.status != ShiftStatus::ok) {
      ++shifts_refused_;
      return;
    }
    largest_error_px_ = std::max({largest_error_px_, std::abs(shift.dx_px - truth.dx_px),
                                  std::abs(shift.dy_px - truth.dy_px)});
  }

  Odometer odometer_;
  const SimulatedLoop& loop_;
  DurationSamples push_;
  std::size_t shifts_refused_ = 0;
  double largest_error_px_ = 0.0;
};

void sleep_until(std::int64_t due_ns) {
  const timespec due{.tv_sec = due_ns / kNsPerS, .tv_nsec = due_ns % kNsPerS};
  while (::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &due, nullptr) == EINTR) {
    if (interrupted()) return;
  }
}

/// Linux lets the timers of ordinary threads slip by 50 us to save power; a camera's interrupt does
/// not wait for that.
class ExactTimers {
 public:
  ExactTimers() : slack_ns_(::prctl(PR_GET_TIMERSLACK, 0, 0, 0, 0)) {
    ::prctl(PR_SET_TIMERSLACK, 1, 0, 0, 0);
  }
  ~ExactTimers() {
    if (slack_ns_ > 0) ::prctl(PR_SET_TIMERSLACK, slack_ns_, 0, 0, 0);
  }
  ExactTimers(const ExactTimers&) = delete;
  ExactTimers& operator=(const ExactTimers&) = delete;

 private:
  int slack_ns_;
};

/// Linux holds a real-time thread back once it has used 95 % of a second, as running unpaced does;
/// the next second starts afresh.
std::int64_t settling_time_ns() { return ::sched_getscheduler(0) == SCHED_OTHER ? 0 : kNsPerS; }

}  // namespace

Result<UnpacedTimes> measure_unpaced(const TrackConfig& config, const SimulatedLoop& loop,
                                     std::size_t frames, double limit_s) {
  Result<std::unique_ptr<Correlator>> correlator =
      make_correlator(config.correlation, loop.format());
  if (!correlator) return correlator.error();
  Result<Odometer> odometer = Odometer::create(config, loop.format());
  if (!odometer) return odometer.error();
  StageTimer stages(std::move(correlator).value(), config.correlation.peak_fit, frames);
  PushTimer pushes(std::move(odometer).value(), loop, frames);

  // In turns, so that both see the machine in the same state; in blocks, so that each finds its
  // own memory in the caches.
  constexpr std::int64_t kBlock = 16;
  const auto total = static_cast<std::int64_t>(frames) + kWarmUpFrames;
  const std::int64_t stop_ns = clock_now_ns() + std::llround(limit_s * 1e9);
  for (std::int64_t first = 0; first < total && !interrupted(); first += kBlock) {
    const std::int64_t end = std::min(first + kBlock, total);
    for (std::int64_t k = first; k < end; ++k) stages.run(loop.frame(k), k >= kWarmUpFrames);
    for (std::int64_t k = first; k < end; ++k) {
      if (Result<void> pushed = pushes.run(k, k >= kWarmUpFrames); !pushed) return pushed.error();
    }
    if (first >= kWarmUpFrames && clock_now_ns() > stop_ns) break;
  }

  UnpacedTimes out;
  stages.report(out);
  pushes.report(out);
  return out;
}

Result<PacedTimes> measure_paced(const TrackConfig& config, const SimulatedLoop& loop,
                                 std::size_t frames, double rate_hz) {
  Result<Odometer> odometer = Odometer::create(config, loop.format());
  if (!odometer) return odometer.error();
  const auto count = static_cast<std::int64_t>(frames);
  const double period_ns = 1e9 / rate_hz;
  DurationSamples wake_up(frames);
  DurationSamples push(frames);
  DurationSamples latency(frames);

  const ExactTimers exact;
  for (std::int64_t k = 0; k < kWarmUpFrames; ++k) {
    if (const Result<StepReport> first = odometer.value().push(loop.frame(k)); !first)
      return first.error();
  }
  const std::int64_t begin_ns = clock_now_ns() + settling_time_ns() + std::llround(period_ns);
  const std::int64_t give_up_ns =
      begin_ns + std::llround(static_cast<double>(count) * period_ns) + kNsPerS;
  for (std::int64_t k = 0; k < count && !interrupted(); ++k) {
    const std::int64_t due_ns = begin_ns + std::llround(static_cast<double>(k) * period_ns);
    std::int64_t start_ns = clock_now_ns();
    if (start_ns > give_up_ns) break;
    if (start_ns < due_ns) {
      sleep_until(due_ns);
      start_ns = clock_now_ns();
      wake_up.add(start_ns - due_ns);
    }
    const Result<StepReport> report = odometer.value().push(loop.frame(kWarmUpFrames + k));
    const std::int64_t end_ns = clock_now_ns();
    if (!report) return report.error();
    push.add(end_ns - start_ns);
    latency.add(end_ns - due_ns);
  }

  PacedTimes out{.period_us = period_ns / 1e3,
                 .frames_due = frames,
                 .wake_up = wake_up.summary(),
                 .push = push.summary(),
                 .latency = latency.summary()};
  out.late = latency.count_above(std::llround(period_ns)) + (frames - out.latency.samples);
  return out;
}

}  // namespace lsv::cli
