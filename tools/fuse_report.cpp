// SPDX-License-Identifier: BSD-3-Clause
#include "tools/fuse_report.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>
#include <utility>

#include "fusion/chi_square.h"
#include "lsv/output/number_text.h"
#include "tools/html_page.h"
#include "tools/sensor_axes.h"

namespace lsv::cli {
namespace {

constexpr std::size_t kMostKept = 3000;
constexpr std::size_t kMostEllipses = 24;
constexpr std::size_t kMostOutages = 64;
constexpr double kHighestNis = 8.0;  // of the page; jumps would flatten the rest
constexpr double kDegrees = 180.0 / std::numbers::pi;
constexpr double kMm = 1e3;

constexpr std::string_view kFused = "#2f80ed";
constexpr std::string_view kOther = "#d9542b";
constexpr std::string_view kThird = "#27a06d";
constexpr std::string_view kFourth = "#9b59b6";
constexpr std::string_view kSensorColours[] = {"#27a06d", "#9b59b6", "#b8860b", "#159d9d",
                                               "#c2185b", "#6d4c41", "#558b2f", "#455a64"};

nlohmann::json known(double value) {
  return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(nullptr);
}

double slip_of(const WheelGrip& grip) { return 1.0 - grip.efficiency_ratio; }

std::string slip_text(const SlipFigures& slip) {
  return std::isfinite(slip.slip_time_s()) ? formatted("%.2f s", slip.slips_s) : "not known";
}

/// As in rover.toml, without what is not used.
std::string settings_text(const FusionConfig& config) {
  std::string out;
  if (config.wheels) {
    out += formatted("wheels   radius %g m, track %g m, noise %g rad/s", config.wheels->radius_m,
                     config.wheels->track_m, config.wheels->noise_rad_s);
    out += config.wheels->ticks_per_turn
               ? formatted(", %g ticks per turn\n", *config.wheels->ticks_per_turn)
               : std::string("\n");
  }
  for (const LsvConfig& sensor : config.lsv) {
    out += "lsv      " + sensor.name +
           formatted(": x %g m, y %g m, yaw %g rad, noise %g m/s\n", sensor.x_m, sensor.y_m,
                     sensor.yaw_rad, sensor.noise_m_s);
  }
  if (config.gyro) {
    out += formatted("imu      gyro noise %g rad/s, bias sigma %g rad/s\n",
                     config.gyro->noise_rad_s, config.gyro->bias_sigma_rad_s);
  }
  out += formatted("start    x %g m, y %g m, yaw %g rad, sigma %g m, %g rad\n", config.start.x_m,
                   config.start.y_m, config.start.yaw_rad, config.start.sigma_m,
                   config.start.sigma_yaw_rad);
  const MotionConfig& motion = config.motion;
  out += motion.model == MotionModel::constant_velocity
             ? formatted("motion   constant velocity: vx_walk %g m/s, wz_walk %g rad/s",
                         motion.vx_walk_m_s, motion.wz_walk_rad_s)
             : formatted("motion   constant acceleration: ax_walk %g m/s2, az_walk %g rad/s2",
                         motion.ax_walk_m_s2, motion.az_walk_rad_s2);
  out +=
      formatted("\n         side slip %g m/s in %g s, efficiency %g in %g s\n", motion.vy_sigma_m_s,
                motion.vy_time_s, motion.efficiency_sigma_ratio, motion.efficiency_time_s);
  out += formatted("slip     alarm at %g, %g sigma\n", config.slip.alarm_ratio,
                   config.slip.threshold_sigmas);
  out += formatted("filter   gate %g, %d refused in a row, optics lost after %g s\n",
                   config.gate_probability, config.max_rejected_in_a_row, config.optical_timeout_s);
  return out;
}

}  // namespace

void ThinCurve::add(double x, double y) {
  if (is_broken_) points_.push_back({kUnknown, kUnknown});
  if (!std::exchange(is_broken_, false) && seen_ % every_ != 0) {
    ++seen_;
    return;
  }
  ++seen_;
  points_.push_back({x, y});
  if (points_.size() < kMostKept) return;
  // Every second point; a break stays one, so that no line crosses it.
  std::vector<Point> kept;
  bool is_kept = false, is_broken = false;
  for (const Point& point : points_) {
    if (std::isnan(point.x)) {
      is_broken = true;
      continue;
    }
    is_kept = !is_kept;
    if (!is_kept) continue;
    if (std::exchange(is_broken, false) && !kept.empty()) kept.push_back({kUnknown, kUnknown});
    kept.push_back(point);
  }
  points_ = std::move(kept);
  every_ *= 2;
}

void FuseReport::SlipCurves::add(double time_s, const WheelGrip& grip) {
  if (!grip.is_slip_known || !std::isfinite(grip.efficiency_ratio)) {
    for (ThinCurve* const curve : {&middle, &low, &high}) curve->end_line();
    return;
  }
  middle.add(time_s, slip_of(grip));
  low.add(time_s, slip_of(grip) - 2.0 * grip.sigma_ratio);
  high.add(time_s, slip_of(grip) + 2.0 * grip.sigma_ratio);
}

void FuseReport::follow_status(const NavState& s, double time_s) {
  if (!outages_.empty() && outages_.back().status == figures_.last.status)
    outages_.back().end_s = time_s;
  if (s.status != NavStatus::optical_lost && s.status != NavStatus::no_motion_source) return;
  const bool is_new = figures_.poses == 0 || figures_.last.status != s.status;
  if (is_new && outages_.size() < kMostOutages) outages_.push_back({s.status, time_s, time_s});
}

void FuseReport::end_lines() {
  for (ThinCurve* const curve : {&path_, &speed_, &side_slip_, &yaw_rate_, &yaw_})
    curve->end_line();
}

void FuseReport::add(const FuseRow& row) {
  const NavState& s = row.state;
  const FusionConfig& config = figures_.config();
  const double time_s = figures_.poses > 0 ? seconds_between(figures_.first.stamp, s.stamp) : 0.0;
  follow_status(s, time_s);
  if (s.status == NavStatus::no_motion_source) {
    end_lines();
    guessed_path_.add(s.x_m, s.y_m);
  } else {
    guessed_path_.end_line();
    path_.add(s.x_m, s.y_m);
    speed_.add(time_s, s.vx_m_s);
    side_slip_.add(time_s, kMm * s.vy_m_s);
    yaw_rate_.add(time_s, s.wz_rad_s);
    yaw_.add(time_s, kDegrees * s.yaw_rad);
  }
  sigma_.add(time_s, kMm * std::sqrt(s.cov[0][0] + s.cov[1][1]));
  if (row.wheels && config.wheels) {
    const double rim_m_s =
        0.5 * config.wheels->radius_m * (row.wheels->left_rad_s + row.wheels->right_rad_s);
    encoder_speed_.add(time_s, rim_m_s);
    left_.add(time_s, s.left);
    right_.add(time_s, s.right);
  }
  for (std::size_t i = 0; i < config.lsv.size(); ++i) {
    if (!row.lsv[i]) continue;
    sensor_speed_[i].add(
        time_s, forward_m_s(row.lsv[i]->vx_m_s, row.lsv[i]->vy_m_s, config.lsv[i].yaw_rad));
  }
  if (s.lsv.dof > 0) lsv_nis_curve_.add(time_s, std::min(kHighestNis, s.lsv.nis / s.lsv.dof));
  if (s.wheels.dof > 0)
    wheel_nis_curve_.add(time_s, std::min(kHighestNis, s.wheels.nis / s.wheels.dof));
  if (figures_.poses % ellipse_every_ == 0) ellipses_.push_back({s});
  if (ellipses_.size() > 2 * kMostEllipses) {
    for (std::size_t i = 0; 2 * i < ellipses_.size(); ++i) ellipses_[i] = ellipses_[2 * i];
    ellipses_.resize((ellipses_.size() + 1) / 2);
    ellipse_every_ *= 2;
  }
  figures_.add(row);
}

void FuseReport::finish(const FusionCounters& counters, const FuseSamples& samples,
                        std::size_t events) {
  figures_.finish(counters, samples.rows_read, samples.rows_left_out, events);
}

std::string FuseReport::text() const {
  const FuseFigures& f = figures_;
  const FusionConfig& config = f.config();
  std::string out = formatted("time     %.3f s, %zu poses\n", f.duration_s(), f.poses);
  if (f.rows_left_out > 0)
    out += formatted("rows     %zu of %zu left out: no figures, or a status other than ok\n",
                     f.rows_left_out, f.rows_read);
  out += formatted("path     %.4f m\n", f.path_m);
  out += formatted("end      x %.6f m, y %.6f m, yaw %.4f deg\n", f.last.x_m, f.last.y_m,
                   kDegrees * f.last.yaw_rad);
  out += formatted("sigma    %.3g mm, %.3g mm, %.3g deg\n", kMm * std::sqrt(f.last.cov[0][0]),
                   kMm * std::sqrt(f.last.cov[1][1]), kDegrees * std::sqrt(f.last.cov[2][2]));
  if (!config.lsv.empty()) {
    const FusionCounters& c = f.counters;
    out += formatted(
        "optics   %llu samples used, %llu refused by parity, %llu by innovation; "
        "lost for %.3f s\n",
        static_cast<unsigned long long>(c.lsv_accepted),
        static_cast<unsigned long long>(c.lsv_refused_by_parity),
        static_cast<unsigned long long>(c.lsv_refused_by_innovation),
        f.status_s(NavStatus::optical_lost) + f.status_s(NavStatus::no_motion_source));
  }
  for (std::size_t i = 0; config.lsv.size() > 1 && i < config.lsv.size(); ++i) {
    out += "         " + config.lsv[i].name +
           formatted(": %zu used, %zu refused", f.lsv[i].used, f.lsv[i].refused);
    if (f.lsv[i].used > 0)
      out +=
          formatted(", the last after %.3f s", seconds_between(f.first.stamp, f.lsv[i].last_used));
    out += "\n";
  }
  if (f.status_s(NavStatus::no_motion_source) > 0.0)
    out += formatted("guessed  %.3f s without anything that tells the speed\n",
                     f.status_s(NavStatus::no_motion_source));
  if (config.wheels) {
    out += "slip     left wheel " + slip_text(f.left_slip) + ", right wheel " +
           slip_text(f.right_slip) + "\n";
  }
  const auto nis = [&](const char* name, const NisFigures& figures) {
    if (figures.count + figures.beyond_gate == 0) return;
    out += formatted("NIS      %s: ", name);
    if (figures.count > 0) {
      out += formatted("%.3f per degree of freedom (1 is right), %.1f %% inside the 95 %% band",
                       figures.mean_per_dof(), 100.0 * figures.inside_share());
    }
    if (figures.beyond_gate > 0)
      out += formatted("%s%zu beyond the gate", figures.count > 0 ? "; " : "", figures.beyond_gate);
    out += "\n";
  };
  nis("optics", f.lsv_nis);
  nis("wheels", f.wheel_nis);
  nis("gyro", f.gyro_nis);
  return out;
}

std::string FuseReport::json(const FuseInputNames& inputs) const {
  const FuseFigures& f = figures_;
  nlohmann::ordered_json out;
  out["schema"] = "lsv.fusion/1";
  out["inputs"] = inputs.files;
  out["rover_sha256"] = inputs.rover_sha256;
  out["poses"] = f.poses;
  out["rows"] = f.rows_read;
  out["rows_left_out"] = f.rows_left_out;
  out["events"] = f.events;
  out["duration_s"] = f.duration_s();
  out["path_length_m"] = f.path_m;
  out["end_x_m"] = known(f.last.x_m);
  out["end_y_m"] = known(f.last.y_m);
  out["end_yaw_rad"] = known(f.last.yaw_rad);
  out["end_sigma_x_m"] = known(std::sqrt(f.last.cov[0][0]));
  out["end_sigma_y_m"] = known(std::sqrt(f.last.cov[1][1]));
  out["end_sigma_yaw_rad"] = known(std::sqrt(f.last.cov[2][2]));
  for (const NavStatus status :
       {NavStatus::ok, NavStatus::optical_lost, NavStatus::no_motion_source})
    out["time_s"][std::string(word(status))] = f.status_s(status);
  out["slip_time_s"] = {{"left", known(f.left_slip.slip_time_s())},
                        {"right", known(f.right_slip.slip_time_s())}};
  out["slip_known_time_s"] = {{"left", f.left_slip.known_s}, {"right", f.right_slip.known_s}};
  out["sensors"] = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < f.config().lsv.size(); ++i) {
    const LsvFigures& one = f.lsv[i];
    out["sensors"].push_back(
        {{"name", f.config().lsv[i].name},
         {"used", one.used},
         {"refused", one.refused},
         {"last_used_s",
          known(one.used > 0 ? seconds_between(f.first.stamp, one.last_used) : kUnknown)}});
  }
  const auto nis = [](const NisFigures& figures) {
    return nlohmann::ordered_json{{"count", figures.count},
                                  {"mean_per_dof", known(figures.mean_per_dof())},
                                  {"inside_95_share", known(figures.inside_share())},
                                  {"beyond_gate", figures.beyond_gate}};
  };
  out["nis"] = {{"lsv", nis(f.lsv_nis)}, {"wheels", nis(f.wheel_nis)}, {"gyro", nis(f.gyro_nis)}};
  const FusionCounters& c = f.counters;
  out["counters"] = {{"lsv_accepted", c.lsv_accepted},
                     {"lsv_refused_by_parity", c.lsv_refused_by_parity},
                     {"lsv_refused_by_innovation", c.lsv_refused_by_innovation},
                     {"velocity_steps", c.velocity_steps},
                     {"lsv_streaks_ended", c.lsv_streaks_ended},
                     {"wheels_accepted", c.wheels_accepted},
                     {"grip_opened", c.grip_opened},
                     {"wheel_steps", c.wheel_steps},
                     {"gyro_accepted", c.gyro_accepted},
                     {"gyro_refused", c.gyro_refused},
                     {"standstills", c.standstills},
                     {"updates_refused", c.updates_refused},
                     {"late", c.late},
                     {"too_late", c.too_late},
                     {"invalid", c.invalid}};
  const MountingRank mounting = mounting_rank(f.config().lsv);
  out["mounting"] = {{"rank", mounting.rank}, {"spread_m", mounting.spread_m}};
  out["warnings"] = warnings();
  return out.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

std::string FuseReport::path_svg() const {
  XyPlot plot{.title = "path",
              .x_name = "x, m",
              .y_name = "y, m",
              .series = {},
              .patches = {},
              .has_equal_axes = true};
  plot.series.push_back({"fused", kFused, path_.points()});
  if (!guessed_path_.points().empty())
    plot.series.push_back({"guessed", kFourth, guessed_path_.points(), XyMark::dashed});
  // chi-square with 2, 95 %
  const double scale = std::sqrt(chi_square_limit(0.05, 2));
  bool is_first = true;
  for (const Ellipse& one : ellipses_) {
    const double a = std::sqrt(one.at.cov[0][0]);
    if (!(a > 0.0)) continue;
    const double b = one.at.cov[0][1] / a;
    const double c = std::sqrt(std::max(0.0, one.at.cov[1][1] - b * b));
    XySeries outline{.name = is_first ? "95 % ellipses" : "", .colour = kOther, .points = {}};
    is_first = false;
    constexpr int kCorners = 40;
    for (int i = 0; i <= kCorners; ++i) {
      const double t = 2.0 * std::numbers::pi * i / kCorners;
      outline.points.push_back({one.at.x_m + scale * a * std::cos(t),
                                one.at.y_m + scale * (b * std::cos(t) + c * std::sin(t))});
    }
    plot.series.push_back(std::move(outline));
  }
  return draw(plot, 620, 520);
}

void FuseReport::draw_outages(XyPlot& plot) const {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  bool was_named[2] = {};
  for (const StatusSpan& one : outages_) {
    const bool is_guess = one.status == NavStatus::no_motion_source;
    bool& is_named = was_named[is_guess ? 1 : 0];
    plot.patches.push_back({one.begin_s, one.end_s, -kInfinity, kInfinity,
                            is_guess ? kFourth : kSensorColours[2],
                            is_named   ? ""
                            : is_guess ? "no motion source"
                                       : "optics lost"});
    is_named = true;
  }
}

std::string FuseReport::html(const FuseInputNames& inputs) const {
  const FusionConfig& config = figures_.config();
  const NavState& last = figures_.last;
  constexpr int kWide = 620, kTall = 300;
  const std::string time = "time, s";
  std::string out = "<h1>Fused drive</h1>\n<p>";
  for (std::size_t i = 0; i < inputs.files.size(); ++i)
    out += (i > 0 ? ", " : "") + escaped(inputs.files[i]);
  out += ", SHA-256 " + escaped(inputs.rover_sha256.substr(0, 16)) + "</p>\n";
  for (const std::string& warning : warnings())
    out += "<p class=\"warning\">" + escaped(warning) + "</p>\n";
  const auto tile = [&](const std::string& value, const std::string& name) {
    out += "<div><b>" + value + "</b>" + name + "</div>\n";
  };
  out += "<div class=\"tiles\">\n";
  tile(formatted("%.3f m", figures_.path_m), "path");
  tile(formatted("%.2f mm", kMm * std::hypot(std::sqrt(last.cov[0][0]), std::sqrt(last.cov[1][1]))),
       "sigma of the end");
  tile(formatted("%.3f deg", kDegrees * std::sqrt(last.cov[2][2])), "sigma of the heading");
  if (config.wheels)
    tile(slip_text(figures_.left_slip) + ", " + slip_text(figures_.right_slip),
         "slip, left and right");
  out += "</div>\n<div class=\"plots\">\n<figure>" + path_svg() + "</figure>\n";

  const auto figure = [&](XyPlot plot) {
    plot.x_name = time;
    draw_outages(plot);
    out += "<figure>" + draw(plot, kWide, kTall) + "</figure>\n";
  };
  XyPlot speeds{
      .title = "forward speed", .x_name = {}, .y_name = "m/s", .series = {}, .patches = {}};
  speeds.includes_zero_y = true;
  if (config.wheels)
    speeds.series.push_back({"encoders", kOther, encoder_speed_.points(), XyMark::dots});
  for (std::size_t i = 0; i < config.lsv.size(); ++i)
    speeds.series.push_back({config.lsv[i].name, kSensorColours[i % std::size(kSensorColours)],
                             sensor_speed_[i].points(), XyMark::dots});
  speeds.series.push_back({"fused", kFused, speed_.points()});
  figure(speeds);
  if (config.wheels && left_.middle.points().empty() && right_.middle.points().empty()) {
    out += "<p class=\"note\">Slip is not known: no optics watched a wheel that turns.</p>\n";
  } else if (config.wheels) {
    figure({.title = "slip, 1 - ground speed / rim speed, while optics tell it",
            .x_name = {},
            .y_name = "slip",
            .series = {{"left", kFused, left_.middle.points()},
                       {"2 sigma", "#2f80ed66", left_.low.points()},
                       {"", "#2f80ed66", left_.high.points()},
                       {"right", kOther, right_.middle.points()},
                       {"2 sigma", "#d9542b66", right_.low.points()},
                       {"", "#d9542b66", right_.high.points()}},
            .patches = {}});
  }
  figure({.title = "yaw rate",
          .x_name = {},
          .y_name = "rad/s",
          .series = {{"fused", kFused, yaw_rate_.points()}},
          .patches = {}});
  figure({.title = "heading",
          .x_name = {},
          .y_name = "deg",
          .series = {{"fused", kFused, yaw_.points()}},
          .patches = {}});
  figure({.title = "side slip, positive to the left",
          .x_name = {},
          .y_name = "mm/s",
          .series = {{"fused", kThird, side_slip_.points()}},
          .patches = {}});
  figure({.title = "sigma of the position",
          .x_name = {},
          .y_name = "mm",
          .series = {{"root of the trace", kFourth, sigma_.points()}},
          .patches = {}});
  XyPlot nis{.title = "innovations: NIS per degree of freedom, 95 % below the dashed line",
             .x_name = {},
             .y_name = "NIS / dof",
             .series = {},
             .patches = {}};
  const double end_s = figures_.duration_s();
  const auto add_nis = [&](const char* name, std::string_view colour, const ThinCurve& curve,
                           int dof) {
    if (curve.points().empty()) return;
    nis.series.push_back({name, colour, curve.points(), XyMark::dots});
    const double limit = chi_square_limit(0.05, dof) / dof;
    std::vector<Point> line;
    for (int i = 0; i <= 60; ++i) line.push_back({end_s * i / 60.0, limit});
    nis.series.push_back({"", colour, line, XyMark::dashed});
  };
  add_nis("optics", kFused, lsv_nis_curve_, std::max(2, 2 * static_cast<int>(config.lsv.size())));
  add_nis("wheels", kOther, wheel_nis_curve_, 2);
  figure(nis);
  out += "</div>\n<h2>Figures</h2>\n<pre>" + escaped(text()) + "</pre>\n<h2>Settings</h2>\n<pre>" +
         escaped(settings_text(config)) + "</pre>\n";
  return html_page("lsv fuse", out);
}

}  // namespace lsv::cli
