// SPDX-License-Identifier: BSD-3-Clause
#include "tools/faults/checker.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <utility>

namespace lsv::faults {
namespace {

constexpr double kSilentSigmas = 5.0;
constexpr double kSilent_px = 0.05;
// A fault is told within this of its end, or was not.
constexpr std::int64_t kTellingFrames = 5;
// For so long after a fault alarms are its consequence (I5).
constexpr std::int64_t kRecoveryFrames = 20;

/// In standard deviations, of a deviation in two axes with this covariance.
double sigmas(double dx, double dy, const ShiftCovariance& cov) {
  const double det = cov.xx_px2 * cov.yy_px2 - cov.xy_px2 * cov.xy_px2;
  if (!(det > 0.0)) return dx == 0.0 && dy == 0.0 ? 0.0 : HUGE_VAL;
  return std::sqrt((cov.yy_px2 * dx * dx - 2.0 * cov.xy_px2 * dx * dy + cov.xx_px2 * dy * dy) /
                   det);
}

std::int64_t sum(const HealthSnapshot& health) {
  return std::accumulate(health.rejected.begin(), health.rejected.end(), std::int64_t{0});
}

}  // namespace

Checker::Checker(const Footage& footage, const std::vector<Delivery>& deliveries,
                 const std::vector<Episode>& episodes, unsigned alarms, const VirtualClock& clock)
    : footage_(footage),
      episodes_(episodes),
      alarms_(alarms),
      clock_(clock),
      scale_(pixel_scale(footage.config().calibration)) {
  for (const Delivery& delivery : deliveries)
    exposure_by_arrival_[delivery.label.arrival_ns] = delivery.exposure;
}

namespace {

bool is_about_light(ShiftStatus status) {
  return status == ShiftStatus::dark || status == ShiftStatus::saturated ||
         status == ShiftStatus::low_contrast;
}

}  // namespace

void Checker::tell(Alarm alarm) { told_.push_back({clock_.now_ns(), alarm}); }

void Checker::on_books(const HealthSnapshot& health) {
  const std::int64_t rejected = sum(health);
  if (health.received != health.processed + rejected + health.dropped + health.queued)
    ++findings_.unsound;
  if (rejected > sum(last_books_)) tell(kRejected);
  if (health.missing > last_books_.missing) tell(kMissing);
  if (health.dropped > last_books_.dropped) tell(kDropped);
  if (health.bad_stamps > last_books_.bad_stamps) tell(kStamp);
  last_books_ = health;
}

void Checker::on_event(const StreamEvent& event) {
  if (event.name == "source_lost") told_.push_back({event.host_ns, kLost});
}

void Checker::on_report(const StreamReport& report, Frame&) {
  const StepReport& step = report.step;
  const std::int64_t exposure = exposure_by_arrival_.at(report.label.arrival_ns);
  if (first_exposure_ < 0) first_exposure_ = exposure;
  if (step.segment != last_segment_) {
    tell(kSegment);
    findings_.segments += step.segment - last_segment_;
    last_segment_ = step.segment;
  }
  check_sound(step);
  const bool is_first = measured_.empty();
  if (step.shift.status == ShiftStatus::ok) {
    check_shift(step, exposure);
    accepted_ns_.push_back(report.label.arrival_ns);
  } else if (!is_first) {
    tell(kRefused);
    if (is_about_light(step.shift.status)) tell(kLight);
  }
  if (const Episode* const episode = episode_before(report.label.arrival_ns);
      episode != nullptr && report.label.arrival_ns <= episode->end_ns) {
    ++findings_.faulty_frames;
    findings_.faulty_accepted += step.shift.status == ShiftStatus::ok ? 1 : 0;
  }
  if (!is_excused(report.label.arrival_ns) && !is_first) {
    ++findings_.good_frames;
    findings_.good_measured += step.shift.status == ShiftStatus::ok ? 1 : 0;
  }
  if (step.segment == 0) check_position(step, exposure);
  measured_.push_back({step.stamp.ns, exposure});
  last_position_ = step.position;
  findings_.path.push_back(step.position);
}

void Checker::check_shift(const StepReport& step, std::int64_t exposure) {
  const std::int64_t since_ns = step.stamp.ns - step.dt_ns;
  const auto from = std::find_if(measured_.rbegin(), measured_.rend(),
                                 [&](const Known& known) { return known.stamp_ns == since_ns; });
  if (from == measured_.rend()) {
    ++findings_.unsound;
    return;
  }
  ++findings_.accepted;
  const Position& begin = footage_.position(from->exposure);
  const Position& end = footage_.position(exposure);
  const double ex_px = step.shift.dx_px - (end.x_px - begin.x_px);
  const double ey_px = step.shift.dy_px - (end.y_px - begin.y_px);
  const double off_sigmas = sigmas(ex_px, ey_px, step.shift.cov);
  const double off_px = std::hypot(ex_px, ey_px);
  findings_.largest_error_px = std::max(findings_.largest_error_px, off_px);
  findings_.largest_error_sigmas = std::max(findings_.largest_error_sigmas, off_sigmas);
  if (off_sigmas > kSilentSigmas && off_px > kSilent_px) ++findings_.silent_errors;
  for (const auto& [error_px, variance_px2] :
       {std::pair(ex_px, step.shift.cov.xx_px2), std::pair(ey_px, step.shift.cov.yy_px2)}) {
    const double sigma_px = std::sqrt(variance_px2);
    ++findings_.axes;
    findings_.axes_in_1_sigma += std::abs(error_px) <= sigma_px ? 1 : 0;
    findings_.axes_in_196_sigma += std::abs(error_px) <= 1.96 * sigma_px ? 1 : 0;
  }
}

/// Where the position stands for the ground of this frame, it is held against it.
void Checker::check_position(const StepReport& step, std::int64_t exposure) {
  if (step.shift.status != ShiftStatus::ok) return;
  const Position& begin = footage_.position(first_exposure_);
  const Position& end = footage_.position(exposure);
  const Travel truth = travel(end.x_px - begin.x_px, end.y_px - begin.y_px, {0, 0, 0}, scale_);
  const double m_per_px = std::hypot(scale_.xx, scale_.yx);
  const double ex_m = step.position.x_m - truth.x_m;
  const double ey_m = step.position.y_m - truth.y_m;
  const bool is_off = std::abs(ex_m) > kSilentSigmas * step.position.sigma_x_m ||
                      std::abs(ey_m) > kSilentSigmas * step.position.sigma_y_m;
  if (is_off && std::hypot(ex_m, ey_m) > kSilent_px * m_per_px) ++findings_.lies;
  end_error_px_ = std::hypot(ex_m, ey_m) / m_per_px;
}

void Checker::check_sound(const StepReport& step) {
  const bool is_ok = step.shift.status == ShiftStatus::ok;
  const ShiftCovariance& cov = step.shift.cov;
  const bool finite = std::isfinite(step.position.x_m) && std::isfinite(step.position.y_m) &&
                      std::isfinite(step.position.sigma_x_m) &&
                      std::isfinite(step.position.sigma_y_m);
  bool sound = finite;
  if (is_ok) {
    sound = sound && std::isfinite(step.shift.dx_px) && std::isfinite(step.shift.dy_px) &&
            std::isfinite(step.velocity.vx_m_s) && std::isfinite(step.velocity.vy_m_s) &&
            cov.xx_px2 > 0.0 && cov.yy_px2 > 0.0 &&
            cov.xx_px2 * cov.yy_px2 > cov.xy_px2 * cov.xy_px2 && step.dt_ns > 0;
  } else {
    // Unknown is NaN; and what is not measured makes nothing more certain.
    sound = sound && std::isnan(step.shift.dx_px) && std::isnan(step.velocity.vx_m_s) &&
            (measured_.empty() || (step.position.sigma_x_m >= last_position_.sigma_x_m &&
                                   step.position.x_m == last_position_.x_m));
  }
  findings_.unsound += sound ? 0 : 1;
}

/// Within an episode or its recovery.
bool Checker::is_excused(std::int64_t at_ns) const {
  const Episode* const episode = episode_before(at_ns);
  return episode != nullptr && at_ns <= episode->end_ns + kRecoveryFrames * kPeriod_ns;
}

/// The last one that has begun.
const Episode* Checker::episode_before(std::int64_t at_ns) const {
  const auto after = std::upper_bound(
      episodes_.begin(), episodes_.end(), at_ns,
      [](std::int64_t ns, const Episode& episode) { return ns < episode.begin_ns; });
  return after == episodes_.begin() ? nullptr : &*std::prev(after);
}

void Checker::judge_episodes() {
  findings_.episodes = std::count_if(episodes_.begin(), episodes_.end(),
                                     [](const Episode& one) { return one.must_be_told; });
  for (std::size_t i = 0; i < episodes_.size(); ++i) {
    const Episode& episode = episodes_[i];
    const std::int64_t until_ns = episode.end_ns + kTellingFrames * kPeriod_ns;
    const auto told = std::find_if(told_.begin(), told_.end(), [&](const Told& one) {
      return (one.alarm & alarms_) != 0 && one.at_ns >= episode.begin_ns && one.at_ns <= until_ns;
    });
    if (told != told_.end() && episode.must_be_told) {
      findings_.latencies_frames.push_back(static_cast<double>(told->at_ns - episode.begin_ns) /
                                           kPeriod_ns);
    }
    const bool has_time = i + 1 == episodes_.size() ||
                          episodes_[i + 1].begin_ns > episode.end_ns + kRecoveryFrames * kPeriod_ns;
    const auto back = std::upper_bound(accepted_ns_.begin(), accepted_ns_.end(), episode.end_ns);
    if (has_time && back != accepted_ns_.end()) {
      findings_.recoveries_frames.push_back(static_cast<double>(*back - episode.end_ns) /
                                            kPeriod_ns);
    }
  }
  for (const Told& one : told_) findings_.false_alarms += is_excused(one.at_ns) ? 0 : 1;
}

Findings Checker::finish(const HealthSnapshot& health) {
  on_books(health);
  std::sort(told_.begin(), told_.end(),
            [](const Told& a, const Told& b) { return a.at_ns < b.at_ns; });
  judge_episodes();
  findings_.health = health;
  findings_.exposures = footage_.exposures();
  double way_px = 0.0;
  for (std::int64_t k = 1; k < footage_.exposures(); ++k) {
    way_px += std::hypot(footage_.position(k).x_px - footage_.position(k - 1).x_px,
                         footage_.position(k).y_px - footage_.position(k - 1).y_px);
  }
  findings_.end_error_ratio = findings_.segments == 0 ? end_error_px_ / way_px : kUnknown;
  return findings_;
}

}  // namespace lsv::faults
