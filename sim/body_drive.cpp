// SPDX-License-Identifier: BSD-3-Clause
#include "sim/body_drive.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace lsv::sim {
namespace {

// Of the quadrature of the place: a panel is so short that five Gauss nodes leave nothing.
constexpr double kPanel_s = 0.1;
constexpr double kMark_s = 0.5;
constexpr double kNodes[5] = {-0.906179845938664, -0.538469310105683, 0.0, 0.538469310105683,
                              0.906179845938664};
constexpr double kWeights[5] = {0.236926885056189, 0.478628670499366, 0.568888888888889,
                                0.478628670499366, 0.236926885056189};

/// Value at the share u of the way from `from` to `to`.
double smooth(double from, double to, double u) {
  return from + (to - from) * u * u * (3.0 - 2.0 * u);
}

/// Integral of smooth() over time.
double smooth_integral(double from, double to, double u, double duration_s) {
  return duration_s * (from * u + (to - from) * u * u * u * (1.0 - 0.5 * u));
}

}  // namespace

BodyDrive::BodyDrive(const std::vector<DriveSegment>& segments) {
  for (const DriveSegment& segment : segments) {
    Piece piece{.to = segment, .begin_s = duration_s_};
    if (!pieces_.empty()) {
      const Piece& before = pieces_.back();
      piece.from_speed_m_s = before.to.speed_m_s;
      piece.from_yaw_rate_rad_s = before.to.yaw_rate_rad_s;
      piece.begin = way_after(before, before.to.duration_s);
      piece.places = {pose_after(before, before.to.duration_s)};
    } else {
      piece.places = {BodyPose{}};
    }
    for (double mark_s = kMark_s; mark_s < segment.duration_s; mark_s += kMark_s)
      piece.places.push_back(moved(piece, piece.places.back(), mark_s - kMark_s, mark_s));
    pieces_.push_back(piece);
    duration_s_ += segment.duration_s;
  }
}

BodyWay BodyDrive::way_after(const Piece& piece, double since_s) {
  const double duration_s = piece.to.duration_s;
  const double u = since_s / duration_s;
  return {.way_m = piece.begin.way_m +
                   smooth_integral(piece.from_speed_m_s, piece.to.speed_m_s, u, duration_s),
          .yaw_rad = piece.begin.yaw_rad + smooth_integral(piece.from_yaw_rate_rad_s,
                                                           piece.to.yaw_rate_rad_s, u, duration_s)};
}

BodyPose BodyDrive::pose_after(const Piece& piece, double since_s) {
  const auto mark = std::min(static_cast<std::size_t>(since_s / kMark_s), piece.places.size() - 1);
  return moved(piece, piece.places[mark], kMark_s * static_cast<double>(mark), since_s);
}

BodyPose BodyDrive::moved(const Piece& piece, const BodyPose& from, double from_s, double to_s) {
  BodyPose out = from;
  out.yaw_rad = way_after(piece, to_s).yaw_rad;
  const int panels = std::max(1, static_cast<int>(std::ceil((to_s - from_s) / kPanel_s)));
  const double half_s = 0.5 * (to_s - from_s) / panels;
  for (int panel = 0; panel < panels; ++panel) {
    for (int node = 0; node < 5; ++node) {
      const double time_s = from_s + half_s * (2.0 * panel + 1.0 + kNodes[node]);
      const double speed_m_s =
          smooth(piece.from_speed_m_s, piece.to.speed_m_s, time_s / piece.to.duration_s);
      const double yaw_rad = way_after(piece, time_s).yaw_rad;
      out.x_m += half_s * kWeights[node] * speed_m_s * std::cos(yaw_rad);
      out.y_m += half_s * kWeights[node] * speed_m_s * std::sin(yaw_rad);
    }
  }
  return out;
}

BodyDrive::Moment BodyDrive::moment(double time_s) const {
  const auto later =
      std::upper_bound(pieces_.begin(), pieces_.end(), std::max(time_s, 0.0),
                       [](double time, const Piece& piece) { return time < piece.begin_s; });
  const Piece& piece = *std::prev(later);
  return {&piece, std::clamp(time_s - piece.begin_s, 0.0, piece.to.duration_s)};
}

BodyWay BodyDrive::way(double time_s) const {
  const auto [piece, since_s] = moment(time_s);
  return way_after(*piece, since_s);
}

BodyPose BodyDrive::pose(double time_s) const {
  const auto [piece, since_s] = moment(time_s);
  return pose_after(*piece, since_s);
}

BodyDrive slalom(double duration_s, double speed_m_s, double yaw_rate_rad_s, double period_s) {
  constexpr double kRamp_s = 1.0;
  std::vector<DriveSegment> segments = {{kRamp_s, speed_m_s, yaw_rate_rad_s}};
  double side = -1.0;
  for (double time_s = kRamp_s; time_s + 0.5 * period_s <= duration_s - kRamp_s;
       time_s += 0.5 * period_s) {
    segments.push_back({0.5 * period_s, speed_m_s, side * yaw_rate_rad_s});
    side = -side;
  }
  segments.push_back({kRamp_s, 0.0, 0.0});
  return BodyDrive(segments);
}

BodyDrive straight(double duration_s, double speed_m_s) {
  constexpr double kRamp_s = 1.0;
  return BodyDrive({{kRamp_s, speed_m_s, 0.0},
                    {duration_s - 2.0 * kRamp_s, speed_m_s, 0.0},
                    {kRamp_s, 0.0, 0.0}});
}

BodyDrive circle(double duration_s, double speed_m_s, double radius_m) {
  // So short a start that nothing is seen of it.
  constexpr double kStart_s = 1e-6;
  return BodyDrive({{kStart_s, speed_m_s, speed_m_s / radius_m},
                    {duration_s - kStart_s, speed_m_s, speed_m_s / radius_m}});
}

BodyDrive figure_drive(double duration_s, double speed_m_s, double yaw_rate_rad_s) {
  const double v = speed_m_s;
  const double w = yaw_rate_rad_s;
  std::vector<DriveSegment> segments = {
      {1.0, v, 0.0}, {6.0, v, 0.0},  {1.0, v, w},    {5.0, v, w},    {1.0, v, 0.0},
      {4.0, v, 0.0}, {2.0, -v, 0.0}, {3.0, -v, 0.0}, {2.0, v, -w},   {5.0, v, -w},
      {1.5, v, w},   {1.5, v, -w},   {1.5, v, w},    {1.5, v, -w},   {1.5, v, w},
      {1.5, v, -w},  {1.0, v, 0.0},  {3.0, v, 0.0},  {1.0, 0.0, 0.0}};
  double total_s = 0.0;
  for (const DriveSegment& segment : segments) total_s += segment.duration_s;
  for (DriveSegment& segment : segments) segment.duration_s *= duration_s / total_s;
  return BodyDrive(segments);
}

}  // namespace lsv::sim
