// SPDX-License-Identifier: BSD-3-Clause
#include "tools/fuse_report.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "fusion/chi_square.h"
#include "lsv/output/number_text.h"
#include "tools/html_page.h"
#include "tools/sensor_axes.h"

namespace lsv::cli {
namespace {

constexpr std::size_t kMostKept = 3000;
constexpr std::size_t kMostEllipses = 24;
constexpr double kHighestNis = 8.0;  // of the page; jumps would flatten the rest
constexpr double kDegrees = 180.0 / std::numbers::pi;
constexpr double kMm = 1e3;

constexpr std::string_view kFused = "#2f80ed";
constexpr std::string_view kOther = "#d9542b";
constexpr std::string_view kThird = "#27a06d";
constexpr std::string_view kFourth = "#9b59b6";
constexpr std::string_view kSensorColours[] = {"#27a06d", "#9b59b6", "#b8860b", "#159d9d",
                                               "#c2185b", "#6d4c41", "#558b2f", "#455a64"};

/// Of what the gates let pass: outliers and jumps are counted, and told, by themselves.
void add(const Agreement& agreement, double gate_probability, NisFigures& out) {
  if (agreement.dof <= 0 || !std::isfinite(agreement.nis)) return;
  if (agreement.nis > chi_square_limit(gate_probability, agreement.dof)) return;
  ++out.count;
  out.sum += agreement.nis;
  out.dof_sum += agreement.dof;
  if (agreement.nis >= chi_square_limit(0.975, agreement.dof) &&
      agreement.nis <= chi_square_limit(0.025, agreement.dof))
    ++out.inside;
}

nlohmann::json known(double value) {
  return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(nullptr);
}

double slip_of(const WheelGrip& grip) { return 1.0 - grip.efficiency_ratio; }

}  // namespace

void ThinCurve::add(double x, double y) {
  if (seen_++ % every_ != 0) return;
  points_.push_back({x, y});
  if (points_.size() < kMostKept) return;
  for (std::size_t i = 0; 2 * i < points_.size(); ++i) points_[i] = points_[2 * i];
  points_.resize((points_.size() + 1) / 2);
  every_ *= 2;
}

double NisFigures::mean_per_dof() const { return dof_sum > 0.0 ? sum / dof_sum : kUnknown; }
double NisFigures::inside_share() const {
  return count > 0 ? static_cast<double>(inside) / static_cast<double>(count) : kUnknown;
}

void FuseReport::add(const FuseRow& row) {
  const NavState& s = row.state;
  if (rows_ == 0) first_ = s;
  const double time_s = seconds_between(first_.stamp, s.stamp);
  if (rows_ > 0) {
    const double dt_s = seconds_between(last_.stamp, s.stamp);
    path_m_ += std::hypot(s.x_m - last_.x_m, s.y_m - last_.y_m);
    status_s_[static_cast<std::size_t>(s.status)] += dt_s;
    left_slip_s_ += s.left.is_slipping ? dt_s : 0.0;
    right_slip_s_ += s.right.is_slipping ? dt_s : 0.0;
  }
  cli::add(s.lsv, config_.gate_probability, lsv_nis_);
  cli::add(s.wheels, config_.gate_probability, wheel_nis_);
  cli::add(s.gyro, config_.gate_probability, gyro_nis_);

  path_.add(s.x_m, s.y_m);
  speed_.add(time_s, s.vx_m_s);
  side_slip_.add(time_s, kMm * s.vy_m_s);
  yaw_rate_.add(time_s, s.wz_rad_s);
  yaw_.add(time_s, kDegrees * s.yaw_rad);
  sigma_.add(time_s, kMm * std::sqrt(s.cov[0][0] + s.cov[1][1]));
  if (row.wheels && config_.wheels) {
    const double rim_m_s =
        0.5 * config_.wheels->radius_m * (row.wheels->left_rad_s + row.wheels->right_rad_s);
    encoder_speed_.add(time_s, rim_m_s);
    left_.add(time_s, slip_of(s.left));
    left_low_.add(time_s, slip_of(s.left) - 2.0 * s.left.sigma_ratio);
    left_high_.add(time_s, slip_of(s.left) + 2.0 * s.left.sigma_ratio);
    right_.add(time_s, slip_of(s.right));
  }
  for (std::size_t i = 0; i < config_.lsv.size(); ++i) {
    if (!row.lsv[i]) continue;
    sensor_speed_[i].add(
        time_s, forward_m_s(row.lsv[i]->vx_m_s, row.lsv[i]->vy_m_s, config_.lsv[i].yaw_rad));
  }
  if (s.lsv.dof > 0) lsv_nis_curve_.add(time_s, std::min(kHighestNis, s.lsv.nis / s.lsv.dof));
  if (s.wheels.dof > 0)
    wheel_nis_curve_.add(time_s, std::min(kHighestNis, s.wheels.nis / s.wheels.dof));
  if (rows_ % ellipse_every_ == 0) ellipses_.push_back({s});
  if (ellipses_.size() > 2 * kMostEllipses) {
    for (std::size_t i = 0; 2 * i < ellipses_.size(); ++i) ellipses_[i] = ellipses_[2 * i];
    ellipses_.resize((ellipses_.size() + 1) / 2);
    ellipse_every_ *= 2;
  }
  last_ = s;
  ++rows_;
}

void FuseReport::finish(const FusionCounters& counters, std::size_t rows_left_out,
                        std::size_t events) {
  counters_ = counters;
  rows_left_out_ = rows_left_out;
  events_ = events;
}

std::string FuseReport::text() const {
  const double duration_s = seconds_between(first_.stamp, last_.stamp);
  std::string out = formatted("time     %.3f s, %zu poses\n", duration_s, rows_);
  out += formatted("path     %.4f m\n", path_m_);
  out += formatted("end      x %.6f m, y %.6f m, yaw %.4f deg\n", last_.x_m, last_.y_m,
                   kDegrees * last_.yaw_rad);
  out += formatted("sigma    %.3g mm, %.3g mm, %.3g deg\n", kMm * std::sqrt(last_.cov[0][0]),
                   kMm * std::sqrt(last_.cov[1][1]), kDegrees * std::sqrt(last_.cov[2][2]));
  if (!config_.lsv.empty()) {
    out += formatted(
        "optics   %llu samples used, %llu refused by parity, %llu by innovation; "
        "lost for %.3f s\n",
        static_cast<unsigned long long>(counters_.lsv_accepted),
        static_cast<unsigned long long>(counters_.lsv_refused_by_parity),
        static_cast<unsigned long long>(counters_.lsv_refused_by_innovation),
        status_s_[static_cast<std::size_t>(NavStatus::optical_lost)] +
            status_s_[static_cast<std::size_t>(NavStatus::no_motion_source)]);
  }
  if (config_.wheels)
    out +=
        formatted("slip     left wheel %.2f s, right wheel %.2f s\n", left_slip_s_, right_slip_s_);
  const auto nis = [&](const char* name, const NisFigures& figures) {
    if (figures.count == 0) return;
    out += formatted(
        "NIS      %s: %.3f per degree of freedom (1 is right), %.1f %% inside the "
        "95 %% band\n",
        name, figures.mean_per_dof(), 100.0 * figures.inside_share());
  };
  nis("optics", lsv_nis_);
  nis("wheels", wheel_nis_);
  nis("gyro", gyro_nis_);
  return out;
}

std::string FuseReport::json(const std::vector<std::string>& inputs,
                             const std::string& rover_sha256) const {
  nlohmann::ordered_json out;
  out["schema"] = "lsv.fusion/1";
  out["inputs"] = inputs;
  out["rover_sha256"] = rover_sha256;
  out["poses"] = rows_;
  out["rows_left_out"] = rows_left_out_;
  out["events"] = events_;
  out["duration_s"] = seconds_between(first_.stamp, last_.stamp);
  out["path_length_m"] = path_m_;
  out["end_x_m"] = known(last_.x_m);
  out["end_y_m"] = known(last_.y_m);
  out["end_yaw_rad"] = known(last_.yaw_rad);
  out["end_sigma_x_m"] = known(std::sqrt(last_.cov[0][0]));
  out["end_sigma_y_m"] = known(std::sqrt(last_.cov[1][1]));
  out["end_sigma_yaw_rad"] = known(std::sqrt(last_.cov[2][2]));
  for (const NavStatus status :
       {NavStatus::ok, NavStatus::optical_lost, NavStatus::no_motion_source})
    out["time_s"][std::string(word(status))] = status_s_[static_cast<std::size_t>(status)];
  out["slip_time_s"] = {{"left", left_slip_s_}, {"right", right_slip_s_}};
  const auto nis = [](const NisFigures& figures) {
    return nlohmann::ordered_json{{"count", figures.count},
                                  {"mean_per_dof", known(figures.mean_per_dof())},
                                  {"inside_95_share", known(figures.inside_share())}};
  };
  out["nis"] = {{"lsv", nis(lsv_nis_)}, {"wheels", nis(wheel_nis_)}, {"gyro", nis(gyro_nis_)}};
  const FusionCounters& c = counters_;
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
  const MountingRank mounting = mounting_rank(config_.lsv);
  out["mounting"] = {{"rank", mounting.rank}, {"spread_m", mounting.spread_m}};
  out["warnings"] = mounting_warnings(config_);
  return out.dump(2) + "\n";
}

std::string FuseReport::path_svg() const {
  XyPlot plot{.title = "path, with 95 % ellipses",
              .x_name = "x, m",
              .y_name = "y, m",
              .series = {},
              .patches = {},
              .has_equal_axes = true};
  plot.series.push_back({"fused", kFused, path_.points()});
  // chi-square with 2, 95 %
  const double scale = std::sqrt(chi_square_limit(0.05, 2));
  for (const Ellipse& one : ellipses_) {
    const double a = std::sqrt(one.at.cov[0][0]);
    if (!(a > 0.0)) continue;
    const double b = one.at.cov[0][1] / a;
    const double c = std::sqrt(std::max(0.0, one.at.cov[1][1] - b * b));
    XySeries outline{.name = {}, .colour = kOther, .points = {}};
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

std::string FuseReport::html() const {
  constexpr int kWide = 620, kTall = 300;
  const std::string time = "time, s";
  std::string out = "<h1>Fused drive</h1>\n";
  for (const std::string& warning : mounting_warnings(config_))
    out += "<p class=\"warning\">" + escaped(warning) + "</p>\n";
  const auto tile = [&](const std::string& value, const std::string& name) {
    out += "<div><b>" + value + "</b>" + name + "</div>\n";
  };
  out += "<div class=\"tiles\">\n";
  tile(formatted("%.3f m", path_m_), "path");
  tile(formatted("%.2f mm",
                 kMm * std::hypot(std::sqrt(last_.cov[0][0]), std::sqrt(last_.cov[1][1]))),
       "sigma of the end");
  tile(formatted("%.3f deg", kDegrees * std::sqrt(last_.cov[2][2])), "sigma of the heading");
  if (config_.wheels)
    tile(formatted("%.1f s, %.1f s", left_slip_s_, right_slip_s_), "slip, left and right");
  out += "</div>\n<div class=\"plots\">\n<figure>" + path_svg() + "</figure>\n";

  const auto figure = [&](XyPlot plot) {
    plot.x_name = time;
    out += "<figure>" + draw(plot, kWide, kTall) + "</figure>\n";
  };
  XyPlot speeds{
      .title = "forward speed", .x_name = {}, .y_name = "m/s", .series = {}, .patches = {}};
  speeds.includes_zero_y = true;
  if (config_.wheels)
    speeds.series.push_back({"encoders", kOther, encoder_speed_.points(), XyMark::dots});
  for (std::size_t i = 0; i < config_.lsv.size(); ++i)
    speeds.series.push_back({config_.lsv[i].name, kSensorColours[i % std::size(kSensorColours)],
                             sensor_speed_[i].points(), XyMark::dots});
  speeds.series.push_back({"fused", kFused, speed_.points()});
  figure(speeds);
  if (config_.wheels) {
    figure({.title = "slip, 1 - ground speed / rim speed, with 2 sigma",
            .x_name = {},
            .y_name = "slip",
            .series = {{"left", kFused, left_.points()},
                       {"", "#2f80ed66", left_low_.points()},
                       {"", "#2f80ed66", left_high_.points()},
                       {"right", kOther, right_.points()}},
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
  const double end_s = seconds_between(first_.stamp, last_.stamp);
  const auto add_nis = [&](const char* name, std::string_view colour, const ThinCurve& curve,
                           int dof) {
    if (curve.points().empty()) return;
    nis.series.push_back({name, colour, curve.points(), XyMark::dots});
    const double limit = chi_square_limit(0.05, dof) / dof;
    std::vector<Point> line;
    for (int i = 0; i <= 60; ++i) line.push_back({end_s * i / 60.0, limit});
    nis.series.push_back({"", colour, line, XyMark::dashed});
  };
  add_nis("optics", kFused, lsv_nis_curve_, std::max(2, 2 * static_cast<int>(config_.lsv.size())));
  add_nis("wheels", kOther, wheel_nis_curve_, 2);
  figure(nis);
  out += "</div>\n<h2>Figures</h2>\n<pre>" + escaped(text()) + "</pre>\n";
  return html_page("lsv fuse", out);
}

}  // namespace lsv::cli
