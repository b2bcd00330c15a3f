// SPDX-License-Identifier: BSD-3-Clause
#include "tools/fuse_run.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace lsv::cli {
namespace {

/// Into the navigator, and into what came at this time.
void add(const FuseSample& sample, Navigator& navigator, FuseRow& row) {
  if (const auto* const lsv = std::get_if<LsvSample>(&sample.what)) {
    row.lsv[sample.sensor] = *lsv;
    (void)navigator.add(sample.sensor, *lsv);
  } else if (const auto* const wheels = std::get_if<WheelSample>(&sample.what)) {
    row.wheels = *wheels;
    (void)navigator.add(*wheels);
  } else if (const auto* const gyro = std::get_if<GyroSample>(&sample.what)) {
    row.gyro = *gyro;
    (void)navigator.add(*gyro);
  } else {
    (void)navigator.add(std::get<StandstillSample>(sample.what));
  }
}

constexpr double kMostInAGap = 50.0;

using TakeRow = std::function<Result<void>(const FuseRow&)>;

/// Without what belongs to the samples before.
FuseRow predicted(const Navigator& navigator, Stamp stamp) {
  FuseRow out{.state = navigator.state_at(stamp), .is_predicted = true};
  out.state.lsv = out.state.wheels = out.state.gyro = {};
  out.state.lsv_refused.fill(false);
  out.state.lsv_nis.fill(kUnknown);
  return out;
}

/// The first instant after `from`, up to `to`, whose status is not that of `from`; that of `to` is
/// not. Between samples a status changes for the worse only.
Stamp change_of_status(const Navigator& navigator, const NavState& from, Stamp to) {
  std::int64_t same_ns = from.stamp.ns;
  while (to.ns - same_ns > 1) {
    const std::int64_t middle_ns = same_ns + (to.ns - same_ns) / 2;
    if (navigator.state_at({middle_ns}).status == from.status)
      same_ns = middle_ns;
    else
      to.ns = middle_ns;
  }
  return to;
}

/// What is to be told between `now` and the samples at `end`.
Result<void> tell_gap(const Navigator& navigator, NavState now, Stamp end, double step_s,
                      const TakeRow& row) {
  const Stamp last{end.ns - 1};
  step_s = std::max(step_s, seconds_between(now.stamp, end) / kMostInAGap);
  const std::int64_t step_ns = std::llround(step_s * static_cast<double>(kNsPerS));
  while (now.stamp < last) {
    Stamp next = end;
    if (now.status == NavStatus::no_motion_source)  // the worst: it stays
      next.ns = now.stamp.ns + step_ns;
    else if (navigator.state_at(last).status != now.status)
      next = change_of_status(navigator, now, last);
    if (next >= end) return {};
    const FuseRow told = predicted(navigator, next);
    if (Result<void> done = row(told); !done) return done;
    now = told.state;
  }
  return {};
}

}  // namespace

Result<FusionCounters> fuse(const FusionConfig& config, const FuseSamples& samples,
                            const std::function<Result<void>(const FuseRow&)>& row) {
  Result<Navigator> created = Navigator::create(config);
  if (!created) return created.error();
  Navigator& navigator = created.value();
  FuseRow now;
  for (std::size_t i = 0; i < samples.samples.size(); ++i) {
    add(samples.samples[i], navigator, now);
    const bool is_last = i + 1 == samples.samples.size();
    if (!is_last &&
        seconds_between(navigator.state().stamp, samples.samples[i + 1].when) <= config.same_time_s)
      continue;
    now.state = navigator.state();
    if (Result<void> done = row(now); !done) return done.error();
    if (!is_last) {
      const Result<void> told = tell_gap(navigator, now.state, samples.samples[i + 1].when,
                                         config.optical_timeout_s, row);
      if (!told) return told.error();
    }
    now = {};
  }
  return navigator.counters();
}

}  // namespace lsv::cli
