// SPDX-License-Identifier: BSD-3-Clause
#include "tools/fuse_figures.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "fusion/chi_square.h"
#include "lsv/output/number_text.h"

namespace lsv::cli {
namespace {

constexpr double kManyRefused = 0.05;       // of the readings of a sensor
constexpr double kManyContradicted = 0.05;  // of the readings of the wheels
constexpr double kSkidRatio = 1.5;          // of ground speed to rim speed
constexpr double kSkidSigmas = 5.0;         // of the rim speed
constexpr double kManyLeftOut = 0.2;        // of all rows
constexpr double kLongLost = 0.01;          // of the time
constexpr double kEndsEarly = 0.02;         // of the time, before the end
constexpr double kNisTooLarge = 2.0;        // per degree of freedom
constexpr double kNisTooSmall = 0.1;
constexpr std::size_t kFewReadings = 20;  // of less nothing is said
constexpr double kPercent = 100.0;

/// Outliers and jumps are counted by themselves.
void add_agreement(const Agreement& agreement, double gate_probability, NisFigures& out) {
  if (agreement.dof <= 0 || !std::isfinite(agreement.nis)) return;
  if (agreement.nis > chi_square_limit(gate_probability, agreement.dof)) {
    ++out.beyond_gate;
    return;
  }
  ++out.count;
  out.sum += agreement.nis;
  out.dof_sum += agreement.dof;
  if (agreement.nis >= chi_square_limit(0.975, agreement.dof) &&
      agreement.nis <= chi_square_limit(0.025, agreement.dof))
    ++out.inside;
}

void add_slip(const WheelGrip& grip, double dt_s, SlipFigures& out) {
  if (!grip.is_slip_known || !std::isfinite(grip.efficiency_ratio)) return;
  out.known_s += dt_s;
  out.slips_s += grip.is_slipping ? dt_s : 0.0;
}

double share(std::size_t part, std::size_t of) {
  return of > 0 ? static_cast<double>(part) / static_cast<double>(of) : 0.0;
}

void add_sensor_warnings(const FuseFigures& figures, std::vector<std::string>& out) {
  const std::vector<LsvConfig>& sensors = figures.config().lsv;
  for (std::size_t i = 0; i < sensors.size(); ++i) {
    const LsvFigures& one = figures.lsv[i];
    const std::string& name = sensors[i].name;
    if (one.used == 0) {
      out.push_back(name +
                    formatted(": none of its readings was used, %zu were refused", one.refused));
      continue;
    }
    const double refused = share(one.refused, one.used + one.refused);
    if (refused > kManyRefused) {
      std::string line = name + formatted(
                                    ": %.1f %% of its readings were refused: is the unit "
                                    "m/s, is [motion] that of this rover?",
                                    kPercent * refused);
      if (sensors.size() > 1) {
        line +=
            " Is the mount right and the order of --lsv that of the rover's [[lsv]]? "
            "`lsv calibrate mount --correct-ratio` makes scales agree";
      }
      out.push_back(line);
    }
    const double before_end_s = seconds_between(one.last_used, figures.last.stamp);
    if (before_end_s >
        std::max(kEndsEarly * figures.duration_s(), figures.config().optical_timeout_s)) {
      out.push_back(name + formatted(": no reading was used in the last %.6g s; the pose rests "
                                     "on the other sensors there",
                                     before_end_s));
    }
  }
}

void add_nis_warning(const char* name, const char* remedy, const NisFigures& nis,
                     std::vector<std::string>& out) {
  if (nis.count < kFewReadings) return;
  const double mean = nis.mean_per_dof();
  if (mean > kNisTooLarge) {
    out.push_back(
        formatted("%s: NIS is %.2f where 1 is right: readings scatter more than their "
                  "noise and [motion] allow, so the covariance is too small; %s",
                  name, mean, remedy));
  }
  if (mean < kNisTooSmall) {
    out.push_back(
        formatted("%s: NIS is %.3f where 1 is right: readings scatter far less than "
                  "their noise and [motion] say, so the covariance is too large",
                  name, mean));
  }
}

}  // namespace

double NisFigures::mean_per_dof() const { return dof_sum > 0.0 ? sum / dof_sum : kUnknown; }
double NisFigures::inside_share() const {
  return count > 0 ? static_cast<double>(inside) / static_cast<double>(count) : kUnknown;
}

void FuseFigures::add_skids(const NavState& s, const WheelSample& wheels) {
  const WheelConfig& config = *config_.wheels;
  const auto add = [&](double rim_rad_s, double y_m, SkidFigures& out) {
    const double rim_m_s = std::abs(config.radius_m * rim_rad_s);
    const double ground_m_s = std::abs(s.vx_m_s - s.wz_rad_s * y_m);
    const double noise_m_s = kSkidSigmas * config.radius_m * config.noise_rad_s;
    ++out.readings;
    out.skids += ground_m_s > kSkidRatio * rim_m_s + noise_m_s ? 1 : 0;
  };
  add(wheels.left_rad_s, 0.5 * config.track_m, left_skid);
  add(wheels.right_rad_s, -0.5 * config.track_m, right_skid);
}

void FuseFigures::add(const FuseRow& row) {
  const NavState& s = row.state;
  if (poses == 0) first = last = s;
  // What held from the row before on: a gap ends with the row that tells of it.
  const double dt_s = seconds_between(last.stamp, s.stamp);
  path_m += 0.5 * dt_s * (std::hypot(last.vx_m_s, last.vy_m_s) + std::hypot(s.vx_m_s, s.vy_m_s));
  status_s_[static_cast<std::size_t>(last.status)] += dt_s;
  add_slip(last.left, dt_s, left_slip);
  add_slip(last.right, dt_s, right_slip);
  add_agreement(s.lsv, config_.gate_probability, lsv_nis);
  add_agreement(s.wheels, config_.gate_probability, wheel_nis);
  add_agreement(s.gyro, config_.gate_probability, gyro_nis);
  for (std::size_t i = 0; i < config_.lsv.size(); ++i) {
    if (!row.lsv[i]) continue;
    if (s.lsv_refused[i]) {
      ++lsv[i].refused;
    } else {
      ++lsv[i].used;
      lsv[i].last_used = s.stamp;
    }
  }
  if (row.wheels && config_.wheels && !config_.lsv.empty() && s.status == NavStatus::ok)
    add_skids(s, *row.wheels);
  last = s;
  ++poses;
}

void FuseFigures::finish(const FusionCounters& all, std::size_t read, std::size_t left_out,
                         std::size_t events_told) {
  counters = all;
  rows_read = read;
  rows_left_out = left_out;
  events = events_told;
}

std::vector<std::string> fuse_warnings(const FuseFigures& figures) {
  std::vector<std::string> out = mounting_warnings(figures.config());
  add_sensor_warnings(figures, out);
  if (const double left_out = share(figures.rows_left_out, figures.rows_read);
      left_out > kManyLeftOut)
    out.push_back(
        formatted("%.1f %% of the rows hold no figures and were left out", kPercent * left_out));
  const double guessed_s = figures.status_s(NavStatus::no_motion_source);
  if (guessed_s > kLongLost * figures.duration_s()) {
    out.push_back(
        formatted("for %.3f s of %.3f s nothing said how fast the rover is: the pose is "
                  "a guess there. Readings further apart than optical_timeout_s, %g s, "
                  "count as lost; are the times seconds?",
                  guessed_s, figures.duration_s(), figures.config().optical_timeout_s));
  }
  const FusionCounters& c = figures.counters;
  const double opened = share(c.grip_opened, c.wheels_accepted);
  if (opened > kManyContradicted) {
    out.push_back(
        formatted("wheels contradicted the optics on %.1f %% of their readings: are "
                  "both in their units, does a wheel or encoder stand still?",
                  kPercent * opened));
  }
  for (const auto& [name, skid] :
       {std::pair{"left wheel", figures.left_skid}, {"right wheel", figures.right_skid}}) {
    if (const double skids = share(skid.skids, skid.readings); skids > kManyContradicted)
      out.push_back(
          formatted("%s: on %.1f %% of its readings the ground passes more than %g times "
                    "faster than its rim turns: is it braked, is its encoder dead, or "
                    "a unit wrong?",
                    name, kPercent * skids, kSkidRatio));
  }
  add_nis_warning("optics", "is noise_m_s or motion.vx_walk_m_s too small, or a unit wrong?",
                  figures.lsv_nis, out);
  add_nis_warning("wheels", "is noise_rad_s too small, or a unit wrong?", figures.wheel_nis, out);
  add_nis_warning("gyro", "is gyro_noise_rad_s or gyro_bias_sigma_rad_s too small?",
                  figures.gyro_nis, out);
  return out;
}

}  // namespace lsv::cli
