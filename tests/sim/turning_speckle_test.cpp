// SPDX-License-Identifier: BSD-3-Clause
#include "sim/turning_speckle.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "sim/philox.h"
#include "tests/sim/speckle_frames.h"

namespace lsv::sim {
namespace {

constexpr std::uint64_t kSeed = 20261126;
constexpr double kPx_m = 14e-6 / 2.0;  // of travel, for a shift of 1 px
constexpr double kPi = std::numbers::pi;

TurningSpeckleCamera turning_camera(const TurningSpeckleConfig& config) {
  auto camera = TurningSpeckleCamera::create(config);
  if (!camera) ADD_FAILURE() << camera.error().message;
  return std::move(camera).value();
}

TurningSpeckleConfig square(int side_px, std::uint64_t seed = kSeed) {
  TurningSpeckleConfig config;
  config.width_px = side_px;
  config.height_px = side_px;
  config.seed = seed;
  return config;
}

/// Of a pose given in px of shift.
std::vector<double> light_at(TurningSpeckleCamera& camera, double x_px, double y_px,
                             double yaw_rad) {
  std::vector<double> out;
  const auto done = camera.render_intensity({x_px * kPx_m, y_px * kPx_m, yaw_rad}, out);
  if (!done) ADD_FAILURE() << done.error().message;
  return out;
}

/// The light at a place of the plane, by its definition: the sum over all scatterers in reach.
double direct_sum(double x, double y, double s) {
  const int reach = static_cast<int>(std::ceil(kKernelRadius * s)) + 1;
  std::complex<double> field;
  double energy = 0.0;
  for (auto j = std::llround(y) - reach; j <= std::llround(y) + reach; ++j) {
    for (auto i = std::llround(x) - reach; i <= std::llround(x) + reach; ++i) {
      const double h =
          point_spread(std::hypot(x - static_cast<double>(i), y - static_cast<double>(j)), s);
      if (h == 0.0) continue;
      field += h * complex_normal(kSeed, Stream::ground, i, j, 0);
      energy += h * h;
    }
  }
  return std::norm(field) / energy;
}

struct Offset {
  double x_px, y_px;     // along columns and rows
  double largest_light;  // difference
};

/// By how much the frame lies beside the direct sum, around a pixel: least squares on its slopes.
Offset offset_near(const std::vector<double>& image, int side_px, int column, int row, double x_px,
                   double y_px, double yaw_rad, double speckle_px) {
  const auto at = [&](double c, double r) {
    const double u = c - 0.5 * (side_px - 1);
    const double v = r - 0.5 * (side_px - 1);
    const double per_px = kTurningScale * kSoftApertureFwhm / speckle_px;
    return direct_sum(per_px * (x_px - std::cos(yaw_rad) * u + std::sin(yaw_rad) * v),
                      per_px * (y_px - std::sin(yaw_rad) * u - std::cos(yaw_rad) * v),
                      kTurningScale);
  };
  constexpr double kH = 1e-3;
  double xx = 0.0, xy = 0.0, yy = 0.0, xd = 0.0, yd = 0.0, largest = 0.0;
  for (int r = row; r < row + 9; r += 2) {
    for (int c = column; c < column + 9; c += 2) {
      const double here = at(c, r);
      const double slope_x = (at(c + kH, r) - here) / kH;
      const double slope_y = (at(c, r + kH) - here) / kH;
      const double difference = image[static_cast<std::size_t>(r * side_px + c)] - here;
      largest = std::max(largest, std::abs(difference));
      xx += slope_x * slope_x;
      xy += slope_x * slope_y;
      yy += slope_y * slope_y;
      xd -= slope_x * difference;
      yd -= slope_y * difference;
    }
  }
  const double determinant = xx * yy - xy * xy;
  return {(yy * xd - xy * yd) / determinant, (xx * yd - xy * xd) / determinant, largest};
}

TEST(TurningSpeckle, LiesWhereTheSumOverTheScatterersLies) {
  constexpr int kSide_px = 48;
  double largest_px = 0.0;
  double largest_light = 0.0;
  for (const double speckle_px : {3.0, 4.0}) {
    TurningSpeckleConfig config = square(kSide_px);
    config.speckle_px = speckle_px;
    TurningSpeckleCamera camera = turning_camera(config);
    for (const auto& [x_px, y_px, yaw_rad] :
         {std::array{0.0, 0.0, 0.0}, std::array{-1234.3719, 77.8125, 0.61},
          std::array{151.499, 160.7, -2.9}, std::array{9e7, -9e7, 7.3}}) {
      const std::vector<double> image = light_at(camera, x_px, y_px, yaw_rad);
      for (const auto& [column, row] : {std::pair{0, 0}, std::pair{39, 3}, std::pair{11, 39}}) {
        const Offset off =
            offset_near(image, kSide_px, column, row, x_px, y_px, yaw_rad, speckle_px);
        largest_px = std::max({largest_px, std::abs(off.x_px), std::abs(off.y_px)});
        largest_light = std::max(largest_light, off.largest_light);
      }
    }
  }
  std::printf("largest offset %.1e px over 5 x 5 places, largest difference in light %.1e\n",
              largest_px, largest_light);
  // Interpolation errs by some 1e-3 of the field; over 25 places it does not average out yet.
  EXPECT_LT(largest_px, 1.5e-3);
  EXPECT_LT(largest_light, 4e-3);
}

/// Largest difference between `after` at (column + dx, row + dy) and `before` at (column, row).
double difference_when_moved(const std::vector<double>& before, const std::vector<double>& after,
                             int side_px, int dx_px, int dy_px) {
  double largest = 0.0;
  for (int r = 8; r < side_px - 8; ++r) {
    for (int c = 8; c < side_px - 8; ++c) {
      const double a = before[static_cast<std::size_t>(r * side_px + c)];
      const double b = after[static_cast<std::size_t>((r + dy_px) * side_px + c + dx_px)];
      largest = std::max(largest, std::abs(a - b));
    }
  }
  return largest;
}

TEST(TurningSpeckle, ForwardIsToLargerColumnsAndLeftToLargerRows) {
  constexpr int kSide_px = 64;
  TurningSpeckleCamera camera = turning_camera(square(kSide_px));
  for (const double yaw_rad : {0.0, 0.7, -2.0}) {
    const double c = std::cos(yaw_rad), s = std::sin(yaw_rad);
    const auto before = light_at(camera, 20.3, -9.1, yaw_rad);
    const auto forward = light_at(camera, 20.3 + 5.0 * c, -9.1 + 5.0 * s, yaw_rad);
    const auto left = light_at(camera, 20.3 - 3.0 * s, -9.1 + 3.0 * c, yaw_rad);
    EXPECT_LT(difference_when_moved(before, forward, kSide_px, 5, 0), 5e-3) << yaw_rad;
    EXPECT_LT(difference_when_moved(before, left, kSide_px, 0, 3), 5e-3) << yaw_rad;
  }
}

// A quarter of a turn to the left takes what was on +row to +column, what was on +column to -row.
TEST(TurningSpeckle, TurningLeftTurnsThePatternFromRowsToColumns) {
  constexpr int kSide_px = 65;
  TurningSpeckleCamera camera = turning_camera(square(kSide_px));
  const auto before = light_at(camera, 20.3, -9.1, 0.2);
  const auto after = light_at(camera, 20.3, -9.1, 0.2 + kPi / 2.0);
  double largest = 0.0;
  for (int v = -32; v <= 32; ++v) {
    for (int u = -32; u <= 32; ++u) {
      const double a = before[static_cast<std::size_t>((v + 32) * kSide_px + u + 32)];
      const double b = after[static_cast<std::size_t>((-u + 32) * kSide_px + v + 32)];
      largest = std::max(largest, std::abs(a - b));
    }
  }
  EXPECT_LT(largest, 5e-3);
}

TEST(TurningSpeckle, HasContrastOneAndTheWidthAskedFor) {
  constexpr int kSide_px = 256;
  constexpr int kPlaces = 8;
  for (const double speckle_px : {3.0, 4.0, 6.0}) {
    TurningSpeckleConfig config = square(kSide_px, 11);
    config.speckle_px = speckle_px;
    TurningSpeckleCamera camera = turning_camera(config);
    double light = 0.0, square_light = 0.0, along = 0.0, down = 0.0;
    const int lag = static_cast<int>(std::lround(speckle_px / 2.0));
    const std::size_t side = kSide_px, step = static_cast<std::size_t>(lag);
    double n = 0.0, pairs = 0.0;
    for (int place = 0; place < kPlaces; ++place) {
      const auto image = light_at(camera, 1000.25 * place, 0.4 * place, 0.8 * place);
      for (std::size_t r = 0; r < side; ++r) {
        for (std::size_t c = 0; c < side; ++c) {
          const double here = image[r * side + c];
          light += here;
          square_light += here * here;
          n += 1.0;
          if (r + step >= side || c + step >= side) continue;
          along += (here - 1.0) * (image[r * side + c + step] - 1.0);
          down += (here - 1.0) * (image[(r + step) * side + c] - 1.0);
          pairs += 1.0;
        }
      }
    }
    const double mean_light = light / n;
    const double contrast = std::sqrt(square_light / n - mean_light * mean_light) / mean_light;
    const double five_sigma = 5.0 / std::sqrt(speckle_count(n, speckle_px));
    EXPECT_NEAR(mean_light, 1.0, five_sigma);
    EXPECT_NEAR(contrast, 1.0, 2.0 * five_sigma);
    // |2 J1(x) / x|^2 of the hard aperture, which the soft one follows to 0.003.
    const double x = kPi * lag * kHardApertureFwhm / speckle_px;
    const double expected = std::pow(2.0 * ::j1(x) / x, 2);
    EXPECT_NEAR(along / pairs, expected, 2.0 * five_sigma + 0.003) << speckle_px;
    EXPECT_NEAR(down / pairs, expected, 2.0 * five_sigma + 0.003) << speckle_px;
  }
}

std::vector<int> counts_at(TurningSpeckleCamera& camera, std::int64_t frame,
                           const SensorPose& pose) {
  Frame out;
  const auto done = camera.render(frame, pose, out);
  if (!done) ADD_FAILURE() << done.error().message;
  EXPECT_EQ(out.index, frame);
  EXPECT_EQ(out.stamp.ns, frame * 1'000'000);
  return counts(out);
}

TEST(TurningSpeckle, AFrameDependsOnItsNumberAndItsPoseOnly) {
  TurningSpeckleCamera camera = turning_camera(square(64));
  const SensorPose here{0.01, -0.02, 0.3};
  const auto first = counts_at(camera, 7, here);
  // Far enough around for every tile to be forgotten.
  for (int n = 0; n < 60; ++n) counts_at(camera, 100 + n, {0.05 + 0.003 * n, 0.0, 0.0});
  EXPECT_EQ(counts_at(camera, 7, here), first);
  EXPECT_NE(counts_at(camera, 8, here), first) << "noise";
  TurningSpeckleCamera same = turning_camera(square(64));
  EXPECT_EQ(counts_at(same, 7, here), first);
  TurningSpeckleCamera other = turning_camera(square(64, kSeed + 1));
  EXPECT_NE(counts_at(other, 7, here), first);
}

TEST(TurningSpeckle, TellsWhatItCannotDo) {
  TurningSpeckleConfig config;
  config.speckle_px = 0.4;
  EXPECT_FALSE(TurningSpeckleCamera::create(config));
  config = {};
  config.pixel_pitch_m = 0.0;
  EXPECT_FALSE(TurningSpeckleCamera::create(config));
  config = {};
  config.sc_ratio = NAN;
  EXPECT_FALSE(TurningSpeckleCamera::create(config));
  config = {};
  config.width_px = 0;
  EXPECT_FALSE(TurningSpeckleCamera::create(config));

  TurningSpeckleCamera camera = turning_camera(square(16));
  Frame out;
  EXPECT_FALSE(camera.render(-1, {}, out));
  EXPECT_FALSE(camera.render(0, {1e3, 0.0, 0.0}, out));
  EXPECT_FALSE(camera.render(0, {NAN, 0.0, 0.0}, out));
  EXPECT_FALSE(camera.render(0, {0.0, 0.0, NAN}, out));
}

}  // namespace
}  // namespace lsv::sim
