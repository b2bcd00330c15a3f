// SPDX-License-Identifier: BSD-3-Clause
// What the tests of the simulator share: cameras without noise, and statistics of their light.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "sim/speckle.h"

namespace lsv::sim {

/// A camera, or a failed test.
inline SpeckleCamera make_camera(const SpeckleConfig& config) {
  auto camera = SpeckleCamera::create(config);
  if (!camera) ADD_FAILURE() << camera.error().message;
  return std::move(camera).value();
}

inline std::vector<double> light(SpeckleCamera& camera, std::int64_t frame,
                                 const PatternMotion& motion) {
  std::vector<double> intensity;
  const auto done = camera.render_intensity(frame, motion, intensity);
  if (!done) ADD_FAILURE() << done.error().message;
  return intensity;
}

inline Frame render(SpeckleCamera& camera, std::int64_t frame, const PatternMotion& motion) {
  Frame out;
  const auto done = camera.render(frame, motion, out);
  if (!done) ADD_FAILURE() << done.error().message;
  return out;
}

inline std::vector<int> counts(const Frame& frame) {
  const FrameView view = frame.view();
  std::vector<int> out;
  for (int y = 0; y < view.height_px(); ++y) {
    for (int x = 0; x < view.width_px(); ++x) out.push_back(view.at(x, y));
  }
  return out;
}

template <typename Number>
double mean(const std::vector<Number>& values) {
  double sum = 0.0;
  for (const Number value : values) sum += static_cast<double>(value);
  return sum / static_cast<double>(values.size());
}

template <typename Number>
double standard_deviation(const std::vector<Number>& values) {
  const double centre = mean(values);
  double sum = 0.0;
  for (const Number value : values) sum += std::pow(static_cast<double>(value) - centre, 2);
  return std::sqrt(sum / static_cast<double>(values.size()));
}

/// Pearson's coefficient.
template <typename Number>
double correlation(const std::vector<Number>& a, const std::vector<Number>& b) {
  const double mean_a = mean(a);
  const double mean_b = mean(b);
  double sum = 0.0;
  for (std::size_t n = 0; n < a.size(); ++n)
    sum += (static_cast<double>(a[n]) - mean_a) * (static_cast<double>(b[n]) - mean_b);
  return sum / static_cast<double>(a.size()) / standard_deviation(a) / standard_deviation(b);
}

inline double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double largest = 0.0;
  for (std::size_t n = 0; n < a.size(); ++n) largest = std::max(largest, std::abs(a[n] - b[n]));
  return a.size() == b.size() ? largest : HUGE_VAL;
}

/// How many independent speckles `pixels` hold: the coherence area of a circular aperture is
/// 4 s^2 / pi (Goodman, Speckle Phenomena in Optics, sec. 4.5).
inline double speckle_count(double pixels, double speckle_px) {
  const double s_px = speckle_px / kHardApertureFwhm;
  return pixels / (4.0 * s_px * s_px / 3.14159265358979);
}

}  // namespace lsv::sim
