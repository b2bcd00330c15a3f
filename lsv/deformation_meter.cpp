// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/deformation_meter.h"

#include <algorithm>
#include <cmath>

namespace lsv {
namespace {

FrameFormat window_of(FrameFormat format) {
  format.width_px = format.width_px * 3 / 8;
  format.height_px = format.height_px * 3 / 8;
  return format;
}

/// First pixel of the windows at either end of what overlaps along one axis.
std::array<int, 2> window_places(int whole_shift_px, int side_px, int window_px) {
  return {std::max(0, -whole_shift_px), std::min(side_px, side_px - whole_shift_px) - window_px};
}

// Below, the windows show no common pattern and their shifts mean nothing.
constexpr double kMinZncc = 0.4;
constexpr double kMinZnccSigmas = 6.0;
// Four unknowns: shift along both axes, rotation, expansion.
constexpr int kMinWindows = 3;

}  // namespace

Result<DeformationMeter> DeformationMeter::create(const FrameFormat& format,
                                                  double noise_sd_counts) {
  if (std::min(format.width_px, format.height_px) < kMinSide_px) {
    return Error{ErrorCode::invalid_argument,
                 "deformation needs frames of at least 64 x 64 px, these are " +
                     std::to_string(format.width_px) + " x " + std::to_string(format.height_px) +
                     " px"};
  }
  return DeformationMeter(format, noise_sd_counts);
}

DeformationMeter::DeformationMeter(const FrameFormat& format, double noise_sd_counts)
    : format_(format),
      window_format_(window_of(format)),
      tracker_(window_format_, Refinement::icgn, noise_sd_counts),
      earlier_(window_format_),
      later_(window_format_),
      reference_(window_format_) {}

DeformationMeter::Window DeformationMeter::measure_window(const TrackFrame& earlier,
                                                          const TrackFrame& later, const Roi& at,
                                                          int whole_dx_px, int whole_dy_px) {
  Window out{.x_px = at.x_px + 0.5 * (at.width_px - 1),
             .y_px = at.y_px + 0.5 * (at.height_px - 1),
             .dx_px = kUnknown,
             .dy_px = kUnknown,
             .weight_1_px2 = 0.0};
  earlier_.load(crop(earlier.view(), at));
  later_.load(crop(later.view(),
                   {at.x_px + whole_dx_px, at.y_px + whole_dy_px, at.width_px, at.height_px}));
  tracker_.build(earlier_, reference_);
  const Shift shift = tracker_.measure(earlier_, reference_, later_, 0.0, 0.0).shift;
  if (shift.status != ShiftStatus::ok || !(shift.quality.zncc >= kMinZncc) ||
      !(shift.quality.zncc_sigmas >= kMinZnccSigmas))
    return out;
  out.dx_px = whole_dx_px + shift.dx_px;
  out.dy_px = whole_dy_px + shift.dy_px;
  out.weight_1_px2 = 2.0 / (shift.cov.xx_px2 + shift.cov.yy_px2);
  return out;
}

Deformation DeformationMeter::measure(const TrackFrame& earlier, const TrackFrame& later,
                                      double dx_px, double dy_px) {
  const int whole_dx = static_cast<int>(std::lround(dx_px));
  const int whole_dy = static_cast<int>(std::lround(dy_px));
  const int width = window_format_.width_px;
  const int height = window_format_.height_px;
  const std::array<int, 2> xs = window_places(whole_dx, format_.width_px, width);
  const std::array<int, 2> ys = window_places(whole_dy, format_.height_px, height);
  if (xs[0] > xs[1] || ys[0] > ys[1]) return {};

  std::array<Window, 4> windows{};
  double weight = 0.0, x = 0.0, y = 0.0, dx = 0.0, dy = 0.0;
  int measured = 0;
  for (std::size_t i = 0; i < windows.size(); ++i) {
    Window& w = windows[i];
    w = measure_window(earlier, later, {xs[i % 2], ys[i / 2], width, height}, whole_dx, whole_dy);
    if (w.weight_1_px2 == 0.0) continue;
    ++measured;
    weight += w.weight_1_px2;
    x += w.weight_1_px2 * w.x_px;
    y += w.weight_1_px2 * w.y_px;
    dx += w.weight_1_px2 * w.dx_px;
    dy += w.weight_1_px2 * w.dy_px;
  }
  if (measured < kMinWindows) return {};
  x /= weight, y /= weight, dx /= weight, dy /= weight;

  // Displacement about the mean: (e x - theta y, theta x + e y).
  double arm = 0.0, turn = 0.0, growth = 0.0;
  for (const Window& w : windows) {
    if (w.weight_1_px2 == 0.0) continue;
    const double rx = w.x_px - x, ry = w.y_px - y;
    const double ux = w.dx_px - dx, uy = w.dy_px - dy;
    arm += w.weight_1_px2 * (rx * rx + ry * ry);
    turn += w.weight_1_px2 * (rx * uy - ry * ux);
    growth += w.weight_1_px2 * (rx * ux + ry * uy);
  }
  if (!(arm > 0.0)) return {};
  Deformation out{.rotation_rad = turn / arm, .expansion_ratio = growth / arm};
  double misfit = 0.0;
  for (const Window& w : windows) {
    if (w.weight_1_px2 == 0.0) continue;
    const double rx = w.x_px - x, ry = w.y_px - y;
    const double ex = w.dx_px - dx - (out.expansion_ratio * rx - out.rotation_rad * ry);
    const double ey = w.dy_px - dy - (out.rotation_rad * rx + out.expansion_ratio * ry);
    misfit += w.weight_1_px2 * (ex * ex + ey * ey);
  }
  const double per_freedom = misfit / (2 * measured - 4);
  out.sigma_rotation_rad = std::sqrt(std::max(1.0, per_freedom) / arm);
  out.sigma_expansion_ratio = out.sigma_rotation_rad;
  return out;
}

}  // namespace lsv
