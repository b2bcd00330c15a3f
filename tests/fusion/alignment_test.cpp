// SPDX-License-Identifier: BSD-3-Clause
// The alignment against closed forms of other authors, written here from their definitions: the
// complex plane for SE(2) and Sim(2), Horn's quaternion (JOSA A 4(4), 1987) for SE(3) and Sim(3).
#include "fusion/alignment.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <complex>
#include <random>

#include "tests/fusion/trajectories.h"

namespace lsv {
namespace {

using test::normal;

using Point3 = std::array<double, 3>;
using Rotation3 = std::array<std::array<double, 3>, 3>;

struct Similarity {
  Rotation3 rotation{};
  Point3 translation_m{};
  double scale = 1.0;
};

Point3 point(const TrajectoryPose& pose) { return {pose.x_m, pose.y_m, pose.z_m}; }

Point3 mean_of(const std::vector<TrajectoryPose>& poses) {
  Point3 out{};
  for (const TrajectoryPose& pose : poses) {
    for (std::size_t k = 0; k < 3; ++k)
      out[k] += point(pose)[k] / static_cast<double>(poses.size());
  }
  return out;
}

Point3 times(const Rotation3& r, const Point3& p) {
  Point3 out{};
  for (std::size_t i = 0; i < 3; ++i) out[i] = r[i][0] * p[0] + r[i][1] * p[1] + r[i][2] * p[2];
  return out;
}

Similarity in_the_complex_plane(const PosePairs& pairs, bool has_scale) {
  using Complex = std::complex<double>;
  const Point3 from = mean_of(pairs.estimate), to = mean_of(pairs.truth);
  Complex relation = 0.0;
  double spread_m2 = 0.0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const Complex e(pairs.estimate[i].x_m - from[0], pairs.estimate[i].y_m - from[1]);
    const Complex t(pairs.truth[i].x_m - to[0], pairs.truth[i].y_m - to[1]);
    relation += t * std::conj(e);
    spread_m2 += std::norm(e);
  }
  const Complex turn = relation / std::abs(relation);
  const double scale = has_scale ? std::abs(relation) / spread_m2 : 1.0;
  const Complex shift = Complex(to[0], to[1]) - scale * turn * Complex(from[0], from[1]);
  return {.rotation = {{{turn.real(), -turn.imag(), 0}, {turn.imag(), turn.real(), 0}, {0, 0, 1}}},
          .translation_m = {shift.real(), shift.imag(), 0.0},
          .scale = scale};
}

/// Eigenvector of the largest eigenvalue, by Jacobi's rotations.
std::array<double, 4> strongest(std::array<std::array<double, 4>, 4> a) {
  std::array<std::array<double, 4>, 4> v{};
  for (std::size_t i = 0; i < 4; ++i) v[i][i] = 1.0;
  for (int sweep = 0; sweep < 60; ++sweep) {
    for (std::size_t p = 0; p < 4; ++p) {
      for (std::size_t q = p + 1; q < 4; ++q) {
        const double angle = 0.5 * std::atan2(2.0 * a[p][q], a[q][q] - a[p][p]);
        const double c = std::cos(angle), s = std::sin(angle);
        for (std::size_t k = 0; k < 4; ++k) {
          const double kp = a[k][p], kq = a[k][q];
          a[k][p] = c * kp - s * kq;
          a[k][q] = s * kp + c * kq;
        }
        for (std::size_t k = 0; k < 4; ++k) {
          const double pk = a[p][k], qk = a[q][k];
          a[p][k] = c * pk - s * qk;
          a[q][k] = s * pk + c * qk;
          const double vp = v[k][p], vq = v[k][q];
          v[k][p] = c * vp - s * vq;
          v[k][q] = s * vp + c * vq;
        }
      }
    }
  }
  std::size_t best = 0;
  for (std::size_t i = 1; i < 4; ++i) {
    if (a[i][i] > a[best][best]) best = i;
  }
  return {v[0][best], v[1][best], v[2][best], v[3][best]};
}

Similarity by_horn(const PosePairs& pairs, bool has_scale) {
  const Point3 from = mean_of(pairs.estimate), to = mean_of(pairs.truth);
  double s[3][3] = {};  // of estimate and truth, as Horn's left and right
  double spread_m2 = 0.0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      const double e = point(pairs.estimate[i])[j] - from[j];
      spread_m2 += e * e;
      for (std::size_t k = 0; k < 3; ++k) s[j][k] += e * (point(pairs.truth[i])[k] - to[k]);
    }
  }
  const auto [w, x, y, z] = strongest(
      {{{s[0][0] + s[1][1] + s[2][2], s[1][2] - s[2][1], s[2][0] - s[0][2], s[0][1] - s[1][0]},
        {s[1][2] - s[2][1], s[0][0] - s[1][1] - s[2][2], s[0][1] + s[1][0], s[2][0] + s[0][2]},
        {s[2][0] - s[0][2], s[0][1] + s[1][0], s[1][1] - s[0][0] - s[2][2], s[1][2] + s[2][1]},
        {s[0][1] - s[1][0], s[2][0] + s[0][2], s[1][2] + s[2][1], s[2][2] - s[0][0] - s[1][1]}}});
  Similarity out;
  out.rotation = {{{w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)},
                   {2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)},
                   {2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z}}};
  if (has_scale) {
    double along = 0.0;
    for (std::size_t j = 0; j < 3; ++j) {
      for (std::size_t k = 0; k < 3; ++k) along += out.rotation[k][j] * s[j][k];
    }
    out.scale = along / spread_m2;
  }
  const Point3 turned = times(out.rotation, from);
  for (std::size_t k = 0; k < 3; ++k) out.translation_m[k] = to[k] - out.scale * turned[k];
  return out;
}

double worst_difference(const Alignment& found, const Similarity& expected) {
  double out = std::abs(found.scale - expected.scale);
  const auto matrix = rotation_matrix(found.rotation);
  for (std::size_t i = 0; i < 3; ++i) {
    out = std::max(out, std::abs(found.translation_m[i] - expected.translation_m[i]));
    for (std::size_t j = 0; j < 3; ++j)
      out = std::max(out, std::abs(matrix[i][j] - expected.rotation[i][j]));
  }
  return out;
}

/// A cloud of points and the same turned, scaled and shifted, with noise.
PosePairs cloud(std::mt19937& random, bool is_planar, double noise_m, bool is_mirrored = false) {
  PosePairs out;
  double q[4];
  for (double& part : q) part = normal(random);
  if (is_planar) q[0] = q[1] = 0.0;
  const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  const Alignment transform{
      .kind = AlignmentKind::sim3,
      .rotation = {q[0] / length, q[1] / length, q[2] / length, q[3] / length},
      .translation_m = {3.0 * normal(random), normal(random), is_planar ? 0.0 : normal(random)},
      .scale = 0.8 + 0.05 * normal(random)};
  for (int i = 0; i < 60; ++i) {
    const TrajectoryPose estimate{.stamp = {i},
                                  .x_m = 4.0 * normal(random),
                                  .y_m = 2.0 * normal(random) + 7.0,
                                  .z_m = is_planar ? 0.0 : normal(random),
                                  .rotation = test::turn_about_z(normal(random))};
    TrajectoryPose truth = aligned(transform, estimate);
    if (is_mirrored) truth.y_m = -truth.y_m;
    truth.x_m += noise_m * normal(random);
    truth.y_m += noise_m * normal(random);
    if (!is_planar) truth.z_m += noise_m * normal(random);
    out.estimate.push_back(estimate);
    out.truth.push_back(truth);
  }
  out.has_rotation = true;
  out.is_planar = is_planar;
  return out;
}

TEST(Alignment, AgreesWithIndependentClosedForms) {
  constexpr std::uint32_t kSeed = 61;
  std::mt19937 random(kSeed);
  double worst = 0.0;
  for (int run = 0; run < 40; ++run) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + ", run " + std::to_string(run));
    const PosePairs plane = cloud(random, true, 0.3);
    const PosePairs space = cloud(random, false, 0.3);
    const double differences[] = {
        worst_difference(align(plane, AlignmentKind::se2), in_the_complex_plane(plane, false)),
        worst_difference(align(plane, AlignmentKind::se3), in_the_complex_plane(plane, false)),
        worst_difference(align(plane, AlignmentKind::sim3), in_the_complex_plane(plane, true)),
        worst_difference(align(space, AlignmentKind::se3), by_horn(space, false)),
        worst_difference(align(space, AlignmentKind::sim3), by_horn(space, true))};
    for (const double difference : differences) {
      EXPECT_LT(difference, 1e-9);
      worst = std::max(worst, difference);
    }
  }
  RecordProperty("worst_difference", testing::PrintToString(worst));
}

// Of a mirror image a rotation is the best answer, never the mirror.
TEST(Alignment, AMirrorImageIsAlignedByARotation) {
  std::mt19937 random(62);
  for (int run = 0; run < 10; ++run) {
    const PosePairs mirrored = cloud(random, false, 0.1, true);
    const Alignment found = align(mirrored, AlignmentKind::sim3);
    EXPECT_LT(worst_difference(found, by_horn(mirrored, true)), 1e-9);
    const auto r = rotation_matrix(found.rotation);
    EXPECT_NEAR(r[0][0] * (r[1][1] * r[2][2] - r[1][2] * r[2][1]) -
                    r[0][1] * (r[1][0] * r[2][2] - r[1][2] * r[2][0]) +
                    r[0][2] * (r[1][0] * r[2][1] - r[1][1] * r[2][0]),
                1.0, 1e-12);
  }
}

// Which way it turns and shifts: the estimate is brought to the truth, not the truth to it.
TEST(Alignment, BringsTheEstimateToTheTruth) {
  Trajectory estimate = test::winding(50);
  Trajectory truth = estimate;
  const Alignment transform{.kind = AlignmentKind::se2,
                            .rotation = test::turn_about_z(0.7),
                            .translation_m = {3.0, -2.0, 0.0}};
  for (TrajectoryPose& pose : truth.poses) pose = aligned(transform, pose);
  for (const AlignmentKind kind : {AlignmentKind::origin, AlignmentKind::se2, AlignmentKind::se3}) {
    const Alignment found = align(test::pairs_of(estimate, truth), kind);
    EXPECT_EQ(found.status, AlignmentStatus::determined);
    EXPECT_NEAR(heading_rad(found.rotation), 0.7, 1e-12) << word(kind);
    EXPECT_NEAR(found.translation_m[0], 3.0, 1e-12) << word(kind);
    EXPECT_NEAR(found.translation_m[1], -2.0, 1e-12) << word(kind);
    EXPECT_EQ(found.scale, 1.0);
    const TrajectoryPose there = aligned(found, estimate.poses[20]);
    const TrajectoryPose back = unaligned(found, there);
    EXPECT_NEAR(there.y_m, truth.poses[20].y_m, 1e-12);
    EXPECT_NEAR(back.x_m, estimate.poses[20].x_m, 1e-12);
    EXPECT_NEAR(heading_rad(back.rotation), heading_rad(estimate.poses[20].rotation), 1e-12);
  }
}

TEST(Alignment, Se2LeavesHeightAlone) {
  std::mt19937 random(63);
  const PosePairs space = cloud(random, false, 0.1);
  const Alignment found = align(space, AlignmentKind::se2);
  EXPECT_EQ(found.translation_m[2], 0.0);
  EXPECT_EQ(rotation_matrix(found.rotation)[2][2], 1.0);
}

TEST(Alignment, IdenticalTrajectoriesNeedNone) {
  const Trajectory path = test::winding(100);
  const PosePairs pairs = test::pairs_of(path, path);
  for (const AlignmentKind kind : kAllAlignmentKinds) {
    const Alignment found = align(pairs, kind);
    EXPECT_EQ(found.kind, kind);
    EXPECT_EQ(found.rotation.w, 1.0);
    EXPECT_EQ(found.rotation.z, 0.0);
    EXPECT_EQ(found.translation_m, (std::array{0.0, 0.0, 0.0}));
    EXPECT_EQ(found.scale, 1.0);
  }
}

void expect_finite(const Alignment& found) {
  for (const double value :
       {found.rotation.x, found.rotation.y, found.rotation.z, found.rotation.w, found.scale,
        found.translation_m[0], found.translation_m[1], found.translation_m[2]})
    EXPECT_TRUE(std::isfinite(value)) << word(found.kind);
  EXPECT_GT(found.scale, 0.0);
}

TEST(Alignment, OnePlaceTellsNoTurnAndNoScale) {
  using test::planar_pose;
  const Trajectory still = test::planar({planar_pose(0, 1, 2, 0.1), planar_pose(1, 1, 2, 0.2)});
  const Trajectory moving = test::planar({planar_pose(0, 5, 2, 0.1), planar_pose(1, 6, 2, 0.2)});
  const Trajectory point = test::planar({planar_pose(0, 5, 5, 0.1)});
  const Trajectory other = test::planar({planar_pose(0, 1, 5, 2.0)});
  const std::array<PosePairs, 4> cases = {
      test::pairs_of(still, moving), test::pairs_of(moving, still), test::pairs_of(still, still),
      test::pairs_of(point, other)};
  for (const PosePairs& pairs : cases) {
    for (const AlignmentKind kind : {AlignmentKind::se2, AlignmentKind::se3, AlignmentKind::sim3}) {
      const Alignment found = align(pairs, kind);
      expect_finite(found);
      EXPECT_EQ(found.status, AlignmentStatus::free_turn) << word(kind);
      EXPECT_EQ(found.rotation.w, 1.0);
      EXPECT_EQ(found.scale, 1.0);
    }
  }
  EXPECT_EQ(align(cases[3], AlignmentKind::se3).translation_m, (std::array{-4.0, 0.0, 0.0}));
  expect_finite(align(cases[3], AlignmentKind::origin));
  expect_finite(align(PosePairs{}, AlignmentKind::sim3));
}

// Both on a line: the line is turned by the least, and the way about it is left alone.
TEST(Alignment, OneLineIsTurnedByTheLeast) {
  PosePairs pairs;
  for (int i = 0; i < 20; ++i) {
    pairs.estimate.push_back({.stamp = {i}, .x_m = 1e6 + 0.5 * i, .y_m = 3.0, .z_m = 1.0});
    pairs.truth.push_back({.stamp = {i}, .x_m = 3.0, .y_m = 4.0 + i, .z_m = -5.0});
  }
  const Alignment found = align(pairs, AlignmentKind::sim3);
  expect_finite(found);
  EXPECT_EQ(found.status, AlignmentStatus::free_about_line);
  EXPECT_NEAR(found.rotation.z, std::sqrt(0.5), 1e-9);  // +90 degrees about z
  EXPECT_NEAR(found.rotation.x, 0.0, 1e-9);
  EXPECT_NEAR(found.rotation.y, 0.0, 1e-9);
  EXPECT_NEAR(found.scale, 2.0, 1e-9);
  for (TrajectoryPose& pose : pairs.truth) std::swap(pose.x_m, pose.y_m), pose.x_m = -pose.x_m;
  const Alignment turned_round = align(pairs, AlignmentKind::se3);
  expect_finite(turned_round);
  EXPECT_EQ(turned_round.status, AlignmentStatus::free_about_line);
  EXPECT_NEAR(std::abs(turned_round.rotation.z), 1.0, 1e-9);
  EXPECT_EQ(align(pairs, AlignmentKind::se2).status, AlignmentStatus::determined);
}

TEST(Alignment, Words) {
  for (const AlignmentKind kind : kAllAlignmentKinds) EXPECT_EQ(alignment_kind(word(kind)), kind);
  EXPECT_FALSE(alignment_kind("SE2").has_value());
}

}  // namespace
}  // namespace lsv
