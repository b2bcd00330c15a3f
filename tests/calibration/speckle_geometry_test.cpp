// SPDX-License-Identifier: BSD-3-Clause
// Three oracles: numbers worked out by hand, difference quotients, and waves summed over exact
// (not paraxial) path lengths, which know nothing of the formulas.
#include "calibration/speckle_geometry.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <limits>
#include <random>
#include <vector>

namespace lsv {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kPi = 3.14159265358979323846;
constexpr double kDegree_rad = kPi / 180.0;

// ---- the waves -------------------------------------------------------------------------------

struct Point {
  double x_m = 0.0;
  double z_m = 0.0;  // height above the mean surface
};

double distance_m(const Point& a, const Point& b) {
  return std::hypot(a.x_m - b.x_m, a.z_m - b.z_m);
}

/// A lit line of the ground, its source, and what looks at it. All on one normal.
struct Bench {
  static constexpr double kWavelength_m = 532e-9;

  double source_m = 0.1;  // kInfinity: collimated
  double incidence_rad = 0.0;
  double sensor_m = 0.1;          // objective: the sensor; imaged: the plane of focus
  double lens_m = kUnknown;       // imaged: height of the lens
  double magnification = 1.0;     // imaged
  std::vector<Point> scatterers;  // as they lie when nothing has moved

  static Bench with_rough_surface() {
    constexpr double kSpot_m = 1e-3;
    Bench out;
    std::mt19937_64 random(20240607);
    std::uniform_real_distribution<double> across(-0.5 * kSpot_m, 0.5 * kSpot_m);
    std::uniform_real_distribution<double> up(0.0, 3e-6);
    for (int i = 0; i < 60; ++i) {
      const double x_m = across(random);
      out.scatterers.push_back({x_m, up(random)});
    }
    return out;
  }

  bool imaged() const { return !std::isnan(lens_m); }

  std::vector<Point> moved(double travel_m, double tilt_rad) const {
    std::vector<Point> out;
    for (const Point& p : scatterers) {
      out.push_back({p.x_m * std::cos(tilt_rad) - p.z_m * std::sin(tilt_rad) + travel_m,
                     p.x_m * std::sin(tilt_rad) + p.z_m * std::cos(tilt_rad)});
    }
    return out;
  }

  std::complex<double> wave(double path_m) const {
    return std::polar(1.0, std::remainder(2.0 * kPi * path_m / kWavelength_m, 2.0 * kPi));
  }

  double path_to_m(const Point& surface) const {
    if (std::isinf(source_m)) return -surface.z_m;
    return distance_m({source_m * std::sin(incidence_rad), source_m * std::cos(incidence_rad)},
                      surface);
  }

  std::complex<double> field(const std::vector<Point>& surface, const Point& at) const {
    std::complex<double> sum;
    for (const Point& p : surface) sum += wave(path_to_m(p) + distance_m(p, at));
    return sum;
  }

  /// Along the sensor.
  std::vector<double> intensity(const std::vector<Point>& surface,
                                const std::vector<double>& x_m) const {
    std::vector<double> out;
    if (!imaged()) {
      for (const double x : x_m) out.push_back(std::norm(field(surface, {x, sensor_m})));
      return out;
    }
    // A perfect lens for the plane of focus: every path from that point to its image is as long.
    constexpr int kPupilPoints = 240;
    constexpr double kPupil_m = 6e-3;
    const double object_m = lens_m - sensor_m, image_m = magnification * object_m;
    std::vector<Point> pupil;
    std::vector<std::complex<double>> behind;
    for (int i = 0; i < kPupilPoints; ++i) {
      const Point u{((i + 0.5) / kPupilPoints - 0.5) * kPupil_m, lens_m};
      pupil.push_back(u);
      behind.push_back(field(surface, u) *
                       wave(-std::hypot(object_m, u.x_m) - std::hypot(image_m, u.x_m)));
    }
    for (const double x : x_m) {
      std::complex<double> sum;
      for (std::size_t i = 0; i < pupil.size(); ++i)
        sum += behind[i] * wave(distance_m(pupil[i], {x, lens_m + image_m}));
      out.push_back(std::norm(sum));
    }
    return out;
  }

  /// The shift at which the moved pattern looks most like the one before.
  double pattern_shift_m(double travel_m, double tilt_rad, double around_m, double reach_m) const {
    std::vector<double> here_m;
    for (int i = 0; i < 120; ++i) here_m.push_back((i - 59.5) * 10e-6);
    const std::vector<double> before = intensity(scatterers, here_m);
    const std::vector<Point> surface = moved(travel_m, tilt_rad);
    const auto mismatch = [&](double shift_m) {
      std::vector<double> there_m = here_m;
      for (double& x : there_m) x += shift_m;
      const std::vector<double> after = intensity(surface, there_m);
      double sum = 0.0;
      for (std::size_t i = 0; i < after.size(); ++i)
        sum += (after[i] - before[i]) * (after[i] - before[i]);
      return sum;
    };
    double low_m = around_m - reach_m, high_m = around_m + reach_m;
    while (high_m - low_m > 1e-3 * reach_m) {
      const double third_m = (high_m - low_m) / 3.0;
      if (mismatch(low_m + third_m) < mismatch(high_m - third_m))
        high_m -= third_m;
      else
        low_m += third_m;
    }
    return 0.5 * (low_m + high_m);
  }
};

TEST(SpeckleGeometryWaves, ThePatternMovesByThePredictedFactor) {
  Bench bench = Bench::with_rough_surface();
  constexpr double kTravel_m = 20e-6;
  const ObjectiveGeometry cases[] = {{0.1, 0.1}, {0.2, 0.4}, {0.15, 0.1}, {kInfinity, 0.1}};
  for (const ObjectiveGeometry& g : cases) {
    bench.source_m = g.source_distance_m;
    bench.sensor_m = g.sensor_distance_m;
    const double sc = predicted_sc(g);
    EXPECT_NEAR(bench.pattern_shift_m(kTravel_m, 0.0, 1.9 * kTravel_m, 1.5 * kTravel_m) / kTravel_m,
                sc, 0.005 * sc)
        << g.source_distance_m << ' ' << g.sensor_distance_m;
  }
}

TEST(SpeckleGeometryWaves, TheAngleOfAnObliqueBeamIsFoundInTheScale) {
  Bench bench = Bench::with_rough_surface();
  constexpr double kTravel_m = 20e-6;
  bench.sensor_m = 0.12;
  for (const double incidence_deg : {7.0, 15.0, 30.0}) {
    bench.incidence_rad = incidence_deg * kDegree_rad;
    const double sc = bench.pattern_shift_m(kTravel_m, 0.0, 40e-6, 20e-6) / kTravel_m;
    const auto found = explain_sc({bench.source_m, bench.sensor_m}, sc, 0.0).incidence;
    ASSERT_TRUE(found.has_value()) << incidence_deg;
    EXPECT_NEAR(found->angle_rad, bench.incidence_rad, 0.2 * kDegree_rad) << incidence_deg;
  }
}

TEST(SpeckleGeometryWaves, ATiltMovesThePatternWhateverTheSource) {
  Bench bench = Bench::with_rough_surface();
  constexpr double kTilt_rad = 2e-4;
  for (const double source_m : {0.05, 0.1, kInfinity}) {
    bench.source_m = source_m;
    const double expected_m = kTilt_rad * tilt_shift_m_per_rad({source_m, bench.sensor_m});
    // The side that rises sends its light to the other side.
    EXPECT_NEAR(bench.pattern_shift_m(0.0, -kTilt_rad, expected_m, 20e-6), expected_m,
                0.01 * expected_m)
        << source_m;
  }
}

TEST(SpeckleGeometryWaves, DefocusChangesTheScaleOfImagedSpeckleByTheSourceNotByTheLens) {
  Bench bench = Bench::with_rough_surface();
  constexpr double kTravel_m = 40e-6;
  constexpr double kDefocus_m = 5e-3;
  bench.lens_m = 0.1;
  for (const double source_m : {0.05, 0.15, kInfinity}) {
    bench.source_m = source_m;
    for (const double defocus_m : {-kDefocus_m, 0.0, kDefocus_m}) {
      bench.sensor_m = defocus_m;  // the plane of focus lies above a surface that is too far
      const double relative = defocus_m * fixed_focus_slope_per_m(source_m);
      const double sc = -bench.pattern_shift_m(kTravel_m, 0.0, -kTravel_m, 12e-6) / kTravel_m;
      EXPECT_NEAR(sc, 1.0 + relative, 0.01) << source_m << ' ' << defocus_m;
      if (std::isfinite(source_m)) {
        EXPECT_NEAR(defocus_for_sc_m(source_m, 1.0, sc), defocus_m, 0.01 * source_m);
      }
    }
  }
}

TEST(SpeckleGeometryWaves, ATiltMovesImagedSpeckleOnlyOutOfFocus) {
  Bench bench = Bench::with_rough_surface();
  constexpr double kTilt_rad = 2e-3;
  bench.lens_m = 0.1;
  for (const double defocus_m : {-5e-3, 0.0, 5e-3}) {
    bench.sensor_m = defocus_m;
    const double expected_m = -kTilt_rad * imaged_tilt_travel_m_per_rad(defocus_m);
    EXPECT_NEAR(bench.pattern_shift_m(0.0, -kTilt_rad, expected_m, 10e-6), expected_m, 1e-6)
        << defocus_m;
  }
}

/// The width of the speckles of an evenly lit disc: coherence of the light from its points.
TEST(SpeckleGeometryWaves, SpeckleSizeIsTheWidthOfTheAutocovariance) {
  constexpr double kWavelength_m = 532e-9, kSensor_m = 0.1, kSpot_m = 2e-3;
  const auto coherence = [&](double apart_m) {
    constexpr int kSteps = 200;
    std::complex<double> sum;
    double area = 0.0;
    for (int i = 0; i < kSteps; ++i) {  // strips of the disc across the direction of `apart_m`
      const double x_m = ((i + 0.5) / kSteps - 0.5) * kSpot_m;
      const double width = std::sqrt(0.25 * kSpot_m * kSpot_m - x_m * x_m);
      const double path_m = std::hypot(kSensor_m, x_m - apart_m) - std::hypot(kSensor_m, x_m);
      sum += std::polar(width, 2.0 * kPi * path_m / kWavelength_m);
      area += width;
    }
    return std::norm(sum / area);
  };
  double low_m = 0.0, high_m = 30e-6;
  while (high_m - low_m > 1e-10)
    (coherence(0.5 * (low_m + high_m)) > 0.5 ? low_m : high_m) = 0.5 * (low_m + high_m);
  EXPECT_NEAR(2.0 * low_m / objective_speckle_m(kWavelength_m, kSensor_m, kSpot_m), 1.029, 0.002);
}

// ---- by hand ---------------------------------------------------------------------------------

TEST(PredictedSc, IsExactlyTwoAndFreeOfHeightForSourceAndSensorAtOneHeight) {
  for (const double both_m : {0.03, 0.1, 1.7}) {
    EXPECT_EQ(predicted_sc({both_m, both_m}), 2.0);
    EXPECT_EQ(sc_slopes({both_m, both_m}).height_per_m, 0.0);
  }
}

TEST(PredictedSc, OfPublishedGeometries) {
  EXPECT_DOUBLE_EQ(predicted_sc({0.2, 0.4}), 3.0);
  EXPECT_EQ(predicted_sc({kInfinity, 0.4}), 1.0);
}

TEST(ScSlopes, VanishForCollimatedLight) {
  const ScSlopes slopes = sc_slopes({kInfinity, 0.4});
  EXPECT_EQ(slopes.source_per_m, 0.0);
  EXPECT_EQ(slopes.sensor_per_m, 0.0);
  EXPECT_EQ(slopes.height_per_m, 0.0);
}

TEST(ScSlopes, AreThoseOfTheDifferenceQuotient) {
  constexpr double kStep_m = 1e-6;
  const ObjectiveGeometry cases[] = {{0.1, 0.11}, {0.2, 0.4}, {0.5, 0.05}};
  const auto quotient = [&](const ObjectiveGeometry& g, double d_source, double d_sensor) {
    const ObjectiveGeometry more{g.source_distance_m + d_source * kStep_m,
                                 g.sensor_distance_m + d_sensor * kStep_m};
    const ObjectiveGeometry less{g.source_distance_m - d_source * kStep_m,
                                 g.sensor_distance_m - d_sensor * kStep_m};
    return (predicted_sc(more) - predicted_sc(less)) / (2.0 * kStep_m);
  };
  for (const ObjectiveGeometry& g : cases) {
    const ScSlopes slopes = sc_slopes(g);
    EXPECT_NEAR(slopes.source_per_m, quotient(g, 1, 0), 1e-7);
    EXPECT_NEAR(slopes.sensor_per_m, quotient(g, 0, 1), 1e-7);
    EXPECT_NEAR(slopes.height_per_m, quotient(g, 1, 1), 1e-7);
    EXPECT_NEAR(slopes.height_per_m, slopes.source_per_m + slopes.sensor_per_m, 1e-12);
  }
  // 10 mm between source and sensor at 100 mm: 0.001 per mm.
  EXPECT_NEAR(sc_slopes({0.1, 0.11}).height_per_m, -1.0, 1e-12);
}

TEST(Tilt, OneDegreePerSecondAtTenCentimetres) {
  EXPECT_NEAR(tilt_shift_m_per_rad({0.1, 0.1}) * kDegree_rad, 3.5e-3, 0.01e-3);
  EXPECT_NEAR(tilt_travel_m_per_rad({0.1, 0.1}) * kDegree_rad, 1.75e-3, 0.005e-3);
  EXPECT_NEAR(tilt_travel_m_per_rad({kInfinity, 0.1}) * kDegree_rad, 3.5e-3, 0.01e-3);
}

TEST(SensorScale, NumbersOfTheThesis) {
  const SensorScale bridget{.sc_ratio = 2.0, .pixel_pitch_m = 14e-6, .rate_hz = 1000.0};
  EXPECT_NEAR(velocity_sigma_m_s(bridget, 0.1), 0.700e-3, 1e-15);
  EXPECT_NEAR(shift_px_per_frame(bridget, 0.080), 11.43, 0.005);
  EXPECT_NEAR(shift_px_per_frame(bridget, -0.080), -11.43, 0.005);
  EXPECT_NEAR(window_on_ground_m(bridget, 128.0), 0.896e-3, 1e-15);
}

TEST(SensorScale, TheLargestSpeedShiftsByAQuarterOfTheWindow) {
  const SensorScale scale{.sc_ratio = 2.0, .pixel_pitch_m = 5.5e-6, .rate_hz = 1000.0};
  EXPECT_NEAR(largest_speed_m_s(scale, 64.0), 0.044, 1e-12);
  EXPECT_NEAR(largest_speed_m_s(scale, 256.0), 0.176, 1e-12);
  EXPECT_NEAR(shift_px_per_frame(scale, largest_speed_m_s(scale, 100.0)), 25.0, 1e-9);
}

TEST(ImagedSpeckle, SizeAndDistanceOfASimpleLens) {
  EXPECT_NEAR(imaged_speckle_m(532e-9, 1.0, 8.0), 8.512e-6, 1e-12);
  EXPECT_DOUBLE_EQ(object_distance_m(0.025, 0.25), 0.125);
  // M = f / (z - f), moved and focused again.
  constexpr double kFocal_m = 0.025, kObject_m = 0.125, kStep_m = 1e-6;
  const auto magnification = [&](double z_m) { return kFocal_m / (z_m - kFocal_m); };
  const double slope = (magnification(kObject_m + kStep_m) - magnification(kObject_m - kStep_m)) /
                       (2.0 * kStep_m) / magnification(kObject_m);
  EXPECT_NEAR(refocused_slope_per_m(kFocal_m, magnification(kObject_m)), slope, 1e-6);
}

// ---- explaining a measured Sc ----------------------------------------------------------------

TEST(ExplainSc, GivesBackTheErrorThatWasMade) {
  const ObjectiveGeometry cases[] = {{0.1, 0.11}, {0.2, 0.4}, {0.5, 0.05}};
  for (const ObjectiveGeometry& g : cases) {
    for (const double error_m : {-0.01, -1e-6, 3e-4, 0.02}) {
      ObjectiveGeometry real = g;
      real.source_distance_m += error_m;
      const auto source = explain_sc(g, predicted_sc(real), 0.0).source;
      ASSERT_TRUE(source.has_value());
      EXPECT_NEAR(source->change_m, error_m, 1e-12);
      EXPECT_NEAR(source->distance_m, real.source_distance_m, 1e-12);

      real.sensor_distance_m += error_m;
      const auto height = explain_sc(g, predicted_sc(real), 0.0).height;
      ASSERT_TRUE(height.has_value());
      EXPECT_NEAR(height->change_m, error_m, 1e-12);
      EXPECT_NEAR(height->distance_m, real.sensor_distance_m, 1e-12);

      real.source_distance_m = g.source_distance_m;
      const ScExplanation all = explain_sc(g, predicted_sc(real), 0.0);
      ASSERT_TRUE(all.sensor.has_value());
      EXPECT_NEAR(all.sensor->change_m, error_m, 1e-12);
      EXPECT_NEAR(all.difference_ratio, error_m / g.source_distance_m, 1e-12);
    }
  }
}

TEST(ExplainSc, SigmaIsThatOfTheMeasurementTimesTheSlope) {
  const ObjectiveGeometry g{0.1, 0.12};
  const double sc = predicted_sc(g);
  constexpr double kSigma = 1e-5;
  const ScExplanation at = explain_sc(g, sc, kSigma);
  const ScExplanation above = explain_sc(g, sc + kSigma, kSigma);
  const auto moved_m = [](const auto& from, const auto& to) {
    return std::abs(to->distance_m - from->distance_m);
  };
  EXPECT_NEAR(at.source->sigma_m / moved_m(at.source, above.source), 1.0, 1e-3);
  EXPECT_NEAR(at.sensor->sigma_m / moved_m(at.sensor, above.sensor), 1.0, 1e-3);
  EXPECT_NEAR(at.height->sigma_m / moved_m(at.height, above.height), 1.0, 1e-3);
  EXPECT_TRUE(std::isnan(explain_sc(g, sc, kUnknown).height->sigma_m));
}

TEST(ExplainSc, SaysWhenADistanceCannotBeTheReason) {
  // A common height leaves a factor of 2 alone...
  EXPECT_FALSE(explain_sc({0.1, 0.1}, 1.98, kUnknown).height.has_value());
  EXPECT_TRUE(explain_sc({0.1, 0.1}, 1.98, kUnknown).source.has_value());
  // ...and never carries another one across 2.
  EXPECT_FALSE(explain_sc({0.1, 0.11}, 1.98, kUnknown).height.has_value());
  EXPECT_FALSE(explain_sc({0.1, 0.11}, 2.0, kUnknown).height.has_value());
  EXPECT_FALSE(explain_sc({0.11, 0.1}, 2.02, kUnknown).height.has_value());
  EXPECT_TRUE(explain_sc({0.11, 0.1}, 1.98, kUnknown).height.has_value());
  // Under 1 the beam would have to converge.
  const ScExplanation under = explain_sc({0.11, 0.1}, 0.9, kUnknown);
  EXPECT_FALSE(under.source.has_value());
  EXPECT_FALSE(under.sensor.has_value());
  EXPECT_FALSE(under.height.has_value());
}

// The thesis measured 1.985 along x and 2.000 along y.
TEST(ExplainSc, SevenDegreesOfIncidenceMakeTheAxesOfTheThesis) {
  const auto beam = explain_sc({0.1, 0.1}, 1.985, 0.001).incidence;
  ASSERT_TRUE(beam.has_value());
  EXPECT_NEAR(beam->angle_rad, 7.03 * kDegree_rad, 0.01 * kDegree_rad);
  const auto more = explain_sc({0.1, 0.1}, 1.985 - 1e-6, 0.001).incidence;
  EXPECT_NEAR(beam->sigma_rad, (more->angle_rad - beam->angle_rad) / 1e-6 * 0.001, 1e-5);
  EXPECT_FALSE(explain_sc({0.1, 0.1}, 2.001, 0.001).incidence.has_value());
  EXPECT_FALSE(explain_sc({0.1, 0.1}, 0.999, 0.001).incidence.has_value());
  EXPECT_FALSE(explain_sc({kInfinity, 0.1}, 1.01, 0.001).incidence.has_value());
}

TEST(ExplainSc, OfCollimatedLightOnlyTheSourceCan) {
  const ScExplanation off = explain_sc({kInfinity, 0.1}, 1.02, kUnknown);
  ASSERT_TRUE(off.source.has_value());
  EXPECT_NEAR(off.source->distance_m, 5.0, 1e-9);
  EXPECT_EQ(off.source->change_m, -kInfinity);
  EXPECT_FALSE(off.sensor.has_value());
  EXPECT_FALSE(off.height.has_value());
  const ScExplanation exact = explain_sc({kInfinity, 0.1}, 1.0, kUnknown);
  ASSERT_TRUE(exact.source.has_value());
  EXPECT_EQ(exact.source->change_m, 0.0);
}

}  // namespace
}  // namespace lsv
