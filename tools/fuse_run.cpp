// SPDX-License-Identifier: BSD-3-Clause
#include "tools/fuse_run.h"

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
    now = {};
  }
  return navigator.counters();
}

}  // namespace lsv::cli
