// SPDX-License-Identifier: BSD-3-Clause
#include "sim/motion_profile.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <memory>
#include <numbers>
#include <string_view>
#include <utility>

#include "sim/philox.h"

namespace lsv::sim {
namespace {

using std::numbers::pi;

struct Point {
  double x_px = 0.0;
  double y_px = 0.0;
};

MotionProfile through(std::vector<Point> points) {
  const auto shared = std::make_shared<const std::vector<Point>>(std::move(points));
  return [shared](std::int64_t frame) {
    const auto last = static_cast<std::int64_t>(shared->size()) - 1;
    const auto point = [&](std::int64_t n) {
      return (*shared)[static_cast<std::size_t>(std::clamp(n, std::int64_t{0}, last))];
    };
    // At both ends the mean of one shift and none would be half the velocity: take the one shift.
    const std::int64_t before = std::clamp(frame - 1, std::int64_t{0}, last);
    const std::int64_t after = std::clamp(frame + 1, std::int64_t{0}, last);
    const double frames = static_cast<double>(std::max(after - before, std::int64_t{1}));
    const Point here = point(frame);
    return PatternMotion{here.x_px, here.y_px, (point(after).x_px - point(before).x_px) / frames,
                         (point(after).y_px - point(before).y_px) / frames};
  };
}

struct Leg {
  double start_frame;
  double frames;
  PatternMotion start;
  double vx_end;
  double vy_end;
};

PatternMotion on_leg(const Leg& leg, double frame) {
  const double elapsed = frame - leg.start_frame;
  const double u = std::clamp(elapsed / leg.frames, 0.0, 1.0);
  const double after_leg = std::max(elapsed - leg.frames, 0.0);
  const double blend = u * u * (3.0 - 2.0 * u);
  const double blend_integral = u * u * u * (1.0 - 0.5 * u);
  const auto along = [&](double p, double v, double v_end) {
    return p + leg.frames * (v * u + (v_end - v) * blend_integral) + v_end * after_leg;
  };
  const PatternMotion& start = leg.start;
  return {along(start.x_px, start.vx_px_per_frame, leg.vx_end),
          along(start.y_px, start.vy_px_per_frame, leg.vy_end),
          start.vx_px_per_frame + (leg.vx_end - start.vx_px_per_frame) * blend,
          start.vy_px_per_frame + (leg.vy_end - start.vy_px_per_frame) * blend};
}

std::vector<std::string_view> split(std::string_view line) {
  std::vector<std::string_view> fields;
  for (;;) {
    const std::size_t comma = line.find(',');
    fields.push_back(line.substr(0, comma));
    if (comma == std::string_view::npos) return fields;
    line.remove_prefix(comma + 1);
  }
}

bool parse_number(std::string_view text, double& value) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() && std::isfinite(value);
}

Error bad_table(const std::string& path, const std::string& what) {
  return {ErrorCode::bad_input, path + ": " + what};
}

}  // namespace

MotionProfile parked() { return constant_velocity(0.0, 0.0); }

MotionProfile constant_velocity(double vx_px_per_frame, double vy_px_per_frame) {
  return [=](std::int64_t frame) {
    const auto t = static_cast<double>(frame);
    return PatternMotion{vx_px_per_frame * t, vy_px_per_frame * t, vx_px_per_frame,
                         vy_px_per_frame};
  };
}

MotionProfile sinusoid(double vx_px_per_frame, double vy_px_per_frame, double period_frames) {
  return [=](std::int64_t frame) {
    const double phase_rad = 2.0 * pi * static_cast<double>(frame) / period_frames;
    const double travel = period_frames / (2.0 * pi) * std::sin(phase_rad);
    const double speed = std::cos(phase_rad);
    return PatternMotion{vx_px_per_frame * travel, vy_px_per_frame * travel,
                         vx_px_per_frame * speed, vy_px_per_frame * speed};
  };
}

MotionProfile piecewise(const std::vector<VelocitySegment>& segments) {
  const auto legs = std::make_shared<std::vector<Leg>>();
  Leg leg{0.0, 1.0, {}, 0.0, 0.0};
  double frame = 0.0;
  for (const VelocitySegment& segment : segments) {
    const PatternMotion start = legs->empty() ? PatternMotion{} : on_leg(leg, frame);
    leg = {frame, segment.frames, start, segment.vx_px_per_frame, segment.vy_px_per_frame};
    legs->push_back(leg);
    frame += segment.frames;
  }
  if (legs->empty()) legs->push_back(leg);
  return [legs](std::int64_t k) {
    const auto t = static_cast<double>(k);
    const auto next = std::find_if(legs->begin() + 1, legs->end(),
                                   [t](const Leg& later) { return later.start_frame > t; });
    return on_leg(*(next - 1), t);
  };
}

MotionProfile drive(double vx_px_per_frame, double vy_px_per_frame, double frames) {
  const double vx = vx_px_per_frame;
  const double vy = vy_px_per_frame;
  return piecewise({{0.05 * frames, 0.0, 0.0},
                    {0.20 * frames, vx, vy},
                    {0.10 * frames, vx, vy},
                    {0.15 * frames, 0.0, 0.0},
                    {0.10 * frames, 0.0, 0.0},
                    {0.15 * frames, -0.8 * vx, 0.5 * vy},
                    {0.05 * frames, -0.8 * vx, 0.5 * vy},
                    {0.15 * frames, 0.0, 0.0}});
}

MotionProfile random_shifts(double max_dx_px, double max_dy_px, std::int64_t frames,
                            std::uint64_t seed) {
  std::vector<Point> points(1);
  for (std::int64_t frame = 1; frame < frames; ++frame) {
    const auto [u, v] = uniform_pair(seed, Stream::profile, frame, 0, 0);
    points.push_back({points.back().x_px + max_dx_px * (2.0 * u - 1.0),
                      points.back().y_px + max_dy_px * (2.0 * v - 1.0)});
  }
  return through(std::move(points));
}

Result<MotionTable> read_motion_table(const std::string& path) {
  std::ifstream file(path);
  if (!file) return bad_table(path, "cannot be opened: give a readable file");
  std::vector<Point> points;
  std::size_t x_field = 0;
  std::size_t y_field = 0;
  std::size_t field_count = 0;
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (line.empty() || line.front() == '#') continue;
    const std::vector<std::string_view> fields = split(line);
    if (field_count == 0) {
      field_count = fields.size();
      const auto find = [&](std::string_view name) {
        return static_cast<std::size_t>(std::find(fields.begin(), fields.end(), name) -
                                        fields.begin());
      };
      x_field = find("x_px");
      y_field = find("y_px");
      if (x_field == field_count || y_field == field_count)
        return bad_table(path, "the first row must name the columns x_px and y_px");
      continue;
    }
    Point point;
    if (fields.size() != field_count || !parse_number(fields[x_field], point.x_px) ||
        !parse_number(fields[y_field], point.y_px)) {
      return bad_table(path, "line " + std::to_string(number) + " must hold " +
                                 std::to_string(field_count) +
                                 " columns with numbers in x_px and y_px");
    }
    points.push_back(point);
  }
  if (file.bad()) return bad_table(path, "cannot be read to its end");
  if (points.empty()) return bad_table(path, "holds no positions: give one row per frame");
  const auto frames = static_cast<std::int64_t>(points.size());
  return MotionTable{through(std::move(points)), frames};
}

}  // namespace lsv::sim
