// SPDX-License-Identifier: BSD-3-Clause
// Rotation and expansion of a pattern that is known at every point of the plane: speckle as the sum
// of plane waves, which can be turned and stretched without any interpolation.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <random>
#include <vector>

#include "lsv/odometer.h"
#include "tests/support/calibration.h"

namespace lsv {
namespace {

using std::numbers::pi;

class PlaneWaveSpeckle {
 public:
  PlaneWaveSpeckle(double fwhm_px, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    const double edge_rad_px = pi * 1.03 / fwhm_px;  // of the aperture
    for (int i = 0; i < 120; ++i) {
      const double k = edge_rad_px * std::sqrt(unit(random));
      const double direction = 2.0 * pi * unit(random);
      waves_.push_back({k * std::cos(direction), k * std::sin(direction), 2.0 * pi * unit(random)});
    }
  }
  double intensity(double x_px, double y_px) const {
    std::complex<double> field = 0.0;
    for (const Wave& w : waves_) field += std::polar(1.0, w.kx * x_px + w.ky * y_px + w.phase);
    return std::norm(field) / static_cast<double>(waves_.size());
  }

 private:
  struct Wave {
    double kx, ky, phase;
  };
  std::vector<Wave> waves_;
};

struct Motion {
  double dx_px = 0.0, dy_px = 0.0, rotation_rad = 0.0, expansion_ratio = 0.0;
};

constexpr int kSide_px = 128;

/// The pattern after it turned and grew about the middle of the frame and then shifted.
Frame rendered(const PlaneWaveSpeckle& speckle, const Motion& m, std::int64_t index,
               std::mt19937& random) {
  Frame out({.width_px = kSide_px, .height_px = kSide_px});
  std::normal_distribution<double> noise(3.0, 0.5);
  const double middle_px = (kSide_px - 1) / 2.0;
  const double c = std::cos(m.rotation_rad), s = std::sin(m.rotation_rad);
  for (int y = 0; y < kSide_px; ++y) {
    for (int x = 0; x < kSide_px; ++x) {
      const double u = (x - middle_px - m.dx_px) / (1.0 + m.expansion_ratio);
      const double v = (y - middle_px - m.dy_px) / (1.0 + m.expansion_ratio);
      const double counts = 45.0 * speckle.intensity(c * u + s * v, -s * u + c * v) + noise(random);
      out.row8(y)[x] = static_cast<std::uint8_t>(std::clamp(std::lround(counts), 0L, 255L));
    }
  }
  out.index = index;
  out.stamp = {index * 1'000'000};
  return out;
}

StepReport measured(const Motion& motion, Preset preset = Preset::precise, unsigned seed = 3) {
  const PlaneWaveSpeckle speckle(4.0, seed);
  std::mt19937 random(seed + 100);
  TrackConfig config = test::bridget_config();
  config.preset = preset;
  config.measure_deformation = true;
  Odometer odometer =
      Odometer::create(config, {.width_px = kSide_px, .height_px = kSide_px}).value();
  EXPECT_TRUE(odometer.push(rendered(speckle, {}, 0, random).view()));
  return odometer.push(rendered(speckle, motion, 1, random).view()).value();
}

double rad(double degrees) { return degrees * pi / 180.0; }

TEST(Deformation, IsZeroWhenThereIsNone) {
  for (const Motion& motion : {Motion{}, Motion{.dx_px = 5.3, .dy_px = -2.6}}) {
    const StepReport report = measured(motion);
    ASSERT_EQ(report.shift.status, ShiftStatus::ok);
    const Deformation& d = report.deformation;
    EXPECT_LT(std::abs(d.rotation_rad), 4.0 * d.sigma_rotation_rad);
    EXPECT_LT(std::abs(d.expansion_ratio), 4.0 * d.sigma_expansion_ratio);
    EXPECT_LT(d.sigma_rotation_rad, 3e-5);
  }
}

TEST(Deformation, RotationIsRightToTenPercent) {
  for (const double degrees : {0.02, 0.1, 0.3, 1.0, -0.02, -0.5}) {
    const StepReport report = measured({.dx_px = 2.2, .dy_px = 1.1, .rotation_rad = rad(degrees)});
    ASSERT_EQ(report.shift.status, ShiftStatus::ok) << degrees;
    const Deformation& d = report.deformation;
    EXPECT_NEAR(d.rotation_rad, rad(degrees), 0.1 * std::abs(rad(degrees))) << degrees;
    EXPECT_LT(std::abs(d.expansion_ratio), 4.0 * d.sigma_expansion_ratio + 1e-4) << degrees;
    std::printf("%.2f degrees: %.4f +- %.4f\n", degrees, d.rotation_rad * 180.0 / pi,
                d.sigma_rotation_rad * 180.0 / pi);
  }
}

TEST(Deformation, ExpansionIsRightToTenPercent) {
  for (const double expansion : {0.001, 0.003, 0.01, -0.001, -0.01}) {
    const StepReport report = measured({.dx_px = -1.7, .dy_px = 3.4, .expansion_ratio = expansion});
    ASSERT_EQ(report.shift.status, ShiftStatus::ok) << expansion;
    const Deformation& d = report.deformation;
    EXPECT_NEAR(d.expansion_ratio, expansion, 0.1 * std::abs(expansion)) << expansion;
    EXPECT_LT(std::abs(d.rotation_rad), 4.0 * d.sigma_rotation_rad + 1e-4) << expansion;
    std::printf("%.2f %%: %.4f +- %.4f\n", 100.0 * expansion, 100.0 * d.expansion_ratio,
                100.0 * d.sigma_expansion_ratio);
  }
}

TEST(Deformation, FastMeasuresItToo) {
  const StepReport report = measured({.rotation_rad = rad(0.2)}, Preset::fast);
  EXPECT_NEAR(report.deformation.rotation_rad, rad(0.2), 0.1 * rad(0.2));
}

TEST(Deformation, IsUnknownUnlessAskedFor) {
  TrackConfig config = test::bridget_config();
  const PlaneWaveSpeckle speckle(4.0, 3);
  std::mt19937 random(1);
  Odometer odometer =
      Odometer::create(config, {.width_px = kSide_px, .height_px = kSide_px}).value();
  EXPECT_TRUE(odometer.push(rendered(speckle, {}, 0, random).view()));
  const StepReport report = odometer.push(rendered(speckle, {}, 1, random).view()).value();
  EXPECT_TRUE(std::isnan(report.deformation.rotation_rad));
  config.measure_deformation = true;
  EXPECT_FALSE(Odometer::create(config, {.width_px = 48, .height_px = 128}));
  config.preset = Preset::classic;
  EXPECT_FALSE(Odometer::create(config, {.width_px = kSide_px, .height_px = kSide_px}));
}

}  // namespace
}  // namespace lsv
