// SPDX-License-Identifier: BSD-3-Clause
#include "fusion/navigator.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "fusion/fusion_filter.h"

namespace lsv {
namespace {

/// So that differences of stamps fit as well: 73 years.
constexpr std::int64_t kFurthest_ns = std::int64_t{1} << 62;

bool is_within_reach(Stamp stamp) {
  return stamp.ns < kFurthest_ns / 2 && stamp.ns > -kFurthest_ns / 2;
}

struct Past {
  fusion::Epoch epoch;
  fusion::FilterState after;
};

}  // namespace

struct Navigator::Impl {
  explicit Impl(const FusionConfig& config)
      : filter(config),
        same_time_ns(static_cast<std::int64_t>(config.same_time_s * static_cast<double>(kNsPerS))),
        ring(config.late_epochs) {}

  /// From the oldest, 0, to the newest, count - 1.
  Past& past(std::size_t i) { return ring[(first + i) % ring.size()]; }
  const Past& past(std::size_t i) const { return ring[(first + i) % ring.size()]; }

  /// `put` the sample into the epoch of its time; what follows is computed when it is asked for, or
  /// when time goes on, so that samples of one time are weighed once.
  template <typename Put>
  SampleStatus add(Stamp stamp, Put put);
  /// The start pose belongs to the beginning of what was measured first.
  void begin(Stamp from, Stamp to);
  void settle();

  fusion::FusionFilter filter;
  std::int64_t same_time_ns;
  std::vector<Past> ring;
  std::size_t first = 0;
  std::size_t count = 0;
  fusion::FilterState before{};  // all that the ring holds
  std::size_t settled = 0;       // epochs whose state is computed, from the oldest on
  bool has_begun = false;
  bool holds_start = true;  // no epoch has left the ring
  std::uint64_t late = 0, too_late = 0, invalid = 0;
};

void Navigator::Impl::settle() {
  for (; settled < count; ++settled) {
    Past& now = past(settled);
    now.after = settled == 0 ? before : past(settled - 1).after;
    filter.process(now.epoch, now.after);
  }
}

void Navigator::Impl::begin(Stamp from, Stamp to) {
  const bool is_earlier = has_begun && holds_start && from < before.stamp && !(to < before.stamp);
  if (has_begun && !is_earlier) return;
  before = filter.start_at(from);
  has_begun = true;
  settled = 0;
}

template <typename Put>
SampleStatus Navigator::Impl::add(Stamp stamp, Put put) {
  if (!is_within_reach(stamp)) {
    ++invalid;
    return SampleStatus::invalid;
  }
  begin(stamp, stamp);
  // The first epoch that is not clearly before the stamp.
  std::size_t at = count;
  while (at > 0 && past(at - 1).epoch.stamp.ns >= stamp.ns - same_time_ns) --at;
  const bool is_known = at < count && std::abs(past(at).epoch.stamp.ns - stamp.ns) <= same_time_ns;
  if (at < count && !(is_known && at + 1 == count)) ++late;
  if (!is_known) {
    if (at == 0 && stamp < before.stamp) {
      ++too_late;
      --late;
      return SampleStatus::too_late;
    }
    if (at == count) settle();
    if (count == ring.size()) {
      if (at == 0) {
        ++too_late;
        --late;
        return SampleStatus::too_late;
      }
      settle();
      before = past(0).after;
      holds_start = false;
      first = (first + 1) % ring.size();
      --count;
      --settled;
      --at;
    }
    ++count;
    for (std::size_t i = count - 1; i > at; --i) past(i).epoch = past(i - 1).epoch;
    past(at).epoch = {};
    past(at).epoch.stamp = stamp;
  }
  put(past(at).epoch);
  settled = std::min(settled, at);
  return SampleStatus::taken;
}

Result<Navigator> Navigator::create(const FusionConfig& config) {
  if (Result<void> valid = validate(config); !valid) return valid.error();
  return Navigator(std::make_unique<Impl>(config));
}

Navigator::Navigator(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Navigator::Navigator(Navigator&&) noexcept = default;
Navigator& Navigator::operator=(Navigator&&) noexcept = default;
Navigator::~Navigator() = default;

SampleStatus Navigator::add(std::size_t sensor, const LsvSample& sample) {
  const std::vector<LsvConfig>& sensors = impl_->filter.config().lsv;
  if (sensor >= sensors.size()) {
    ++impl_->invalid;
    return SampleStatus::unknown_sensor;
  }
  const auto sigma = [&](double own_m_s) {
    return std::isnan(own_m_s) ? sensors[sensor].noise_m_s : own_m_s;
  };
  const Eigen::Vector2d sigmas{sigma(sample.sigma_vx_m_s), sigma(sample.sigma_vy_m_s)};
  if (!std::isfinite(sample.vx_m_s) || !std::isfinite(sample.vy_m_s) || !sigmas.allFinite() ||
      !(sigmas.minCoeff() > 0.0) || !(sample.interval_s >= 0.0 && sample.interval_s < 1e9) ||
      !is_within_reach(sample.stamp)) {
    ++impl_->invalid;
    return SampleStatus::invalid;
  }
  const auto half_ns =
      static_cast<std::int64_t>(sample.interval_s / 2.0 * static_cast<double>(kNsPerS));
  const Stamp middle{sample.stamp.ns - half_ns};
  impl_->begin({middle.ns - half_ns}, sample.stamp);
  const Eigen::Vector2d v_m_s{sample.vx_m_s, sample.vy_m_s};
  const Eigen::Vector2d scale_m_s = sensors[sensor].sigma_scale_ratio * v_m_s;
  return impl_->add(middle, [&](fusion::Epoch& epoch) {
    epoch.lsv[sensor] = {true, v_m_s, sigmas.cwiseAbs2() + scale_m_s.cwiseAbs2()};
  });
}

SampleStatus Navigator::add(const WheelSample& sample) {
  if (!impl_->filter.config().wheels) {
    ++impl_->invalid;
    return SampleStatus::unknown_sensor;
  }
  if (!std::isfinite(sample.left_rad_s) || !std::isfinite(sample.right_rad_s)) {
    ++impl_->invalid;
    return SampleStatus::invalid;
  }
  return impl_->add(sample.stamp, [&](fusion::Epoch& epoch) { epoch.wheels = sample; });
}

SampleStatus Navigator::add(const GyroSample& sample) {
  if (!impl_->filter.config().gyro) {
    ++impl_->invalid;
    return SampleStatus::unknown_sensor;
  }
  if (!std::isfinite(sample.wz_rad_s)) {
    ++impl_->invalid;
    return SampleStatus::invalid;
  }
  return impl_->add(sample.stamp, [&](fusion::Epoch& epoch) { epoch.gyro = sample; });
}

SampleStatus Navigator::add(const StandstillSample& sample) {
  if (!(sample.sigma_m_s > 0.0) || !(sample.sigma_rad_s > 0.0) ||
      !std::isfinite(sample.sigma_m_s) || !std::isfinite(sample.sigma_rad_s)) {
    ++impl_->invalid;
    return SampleStatus::invalid;
  }
  return impl_->add(sample.stamp, [&](fusion::Epoch& epoch) { epoch.standstill = sample; });
}

NavState Navigator::state() const {
  if (impl_->count == 0) return {};
  impl_->settle();
  const fusion::FilterState& newest = impl_->past(impl_->count - 1).after;
  return impl_->filter.describe(newest, newest.stamp);
}

NavState Navigator::state_at(Stamp stamp) const {
  if (impl_->count == 0) return {};
  impl_->settle();
  fusion::FilterState newest = impl_->past(impl_->count - 1).after;
  if (stamp <= newest.stamp) return impl_->filter.describe(newest, newest.stamp);
  impl_->filter.predict_to(stamp, newest);
  return impl_->filter.describe(newest, stamp);
}

FusionCounters Navigator::counters() const {
  FusionCounters out;
  impl_->settle();
  if (impl_->count > 0) out = impl_->past(impl_->count - 1).after.counters;
  out.late = impl_->late;
  out.too_late = impl_->too_late;
  out.invalid = impl_->invalid;
  return out;
}

}  // namespace lsv
