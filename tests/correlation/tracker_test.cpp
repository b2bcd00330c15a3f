// SPDX-License-Identifier: BSD-3-Clause
// The tracking engine as a whole, by its laws, on every instruction set of this machine, and the
// same answer from all of them.
#include "correlation/tracker.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "sim/speckle.h"
#include "tests/correlation/every_target.h"

namespace lsv {
namespace {

using sim::FramePair;
using sim::SpeckleConfig;

constexpr int kLongWay_px = 12;  // from the true shift: nothing of the peak is left there

SpeckleConfig camera(int width_px = 128, int height_px = 128, int bit_depth = 8) {
  SpeckleConfig out;
  out.width_px = width_px;
  out.height_px = height_px;
  out.bit_depth = bit_depth;
  return out;
}

SpeckleConfig without_noise(SpeckleConfig config) {
  config.noise_sd_counts = 0.0;
  return config;
}

FramePair pair_of(const SpeckleConfig& config, std::uint64_t seed, double dx_px, double dy_px) {
  auto pair = sim::render_pair(config, seed, dx_px, dy_px);
  if (!pair) ADD_FAILURE() << pair.error().message;
  return std::move(pair).value();
}

/// Each pixel of `frame` through value(x, y), in another format.
template <class Value>
Frame redrawn(const FrameFormat& format, const Value& value) {
  Frame out(format);
  for (int y = 0; y < format.height_px; ++y) {
    for (int x = 0; x < format.width_px; ++x) {
      if (format.type == PixelType::mono8)
        out.row8(y)[x] = static_cast<std::uint8_t>(value(x, y));
      else
        out.row16(y)[x] = static_cast<std::uint16_t>(value(x, y));
    }
  }
  return out;
}

Frame transposed(const Frame& frame) {
  FrameFormat format = frame.view().format;
  std::swap(format.width_px, format.height_px);
  return redrawn(format, [&](int x, int y) { return frame.view().at(y, x); });
}

Frame constant(const FrameFormat& format, int counts) {
  return redrawn(format, [=](int, int) { return counts; });
}

TrackFrame loaded(const Frame& frame) {
  TrackFrame out(frame.view().format);
  out.load(frame.view());
  return out;
}

struct Guess {
  double dx_px = 0.0;
  double dy_px = 0.0;
};

TrackedShift measured(const Frame& earlier, const Frame& later, const Guess& guess,
                      Refinement refinement = Refinement::icgn) {
  const FrameFormat format = earlier.view().format;
  Tracker tracker(format, refinement, 0.5);
  const TrackFrame a = loaded(earlier), b = loaded(later);
  TrackReference reference(format);
  tracker.build(a, reference);
  return tracker.measure(a, reference, b, guess.dx_px, guess.dy_px);
}

/// The shift, found by the refinement asked for and not by one that took its place.
void expect_shift(const TrackedShift& got, double dx_px, double dy_px, double tolerance_px,
                  Refinement refinement = Refinement::icgn) {
  ASSERT_EQ(got.shift.status, ShiftStatus::ok);
  EXPECT_EQ(got.refined, refinement == Refinement::icgn);
  EXPECT_NEAR(got.shift.dx_px, dx_px, tolerance_px);
  EXPECT_NEAR(got.shift.dy_px, dy_px, tolerance_px);
}

/// No shift and a reason.
void expect_refused(const TrackedShift& got) {
  EXPECT_TRUE(got.shift.status == ShiftStatus::peak_at_border ||
              got.shift.status == ShiftStatus::flat_peak)
      << word(got.shift.status);
  EXPECT_TRUE(std::isnan(got.shift.dx_px));
  EXPECT_TRUE(std::isnan(got.shift.dy_px));
}

// ------------------------------------------------------------------- every target, the same answer

struct Condition {
  const char* name;
  SpeckleConfig config;
  double dx_px, dy_px;
  Guess guess;
};

std::vector<Condition> conditions() {
  SpeckleConfig saturated = camera();
  saturated.mean_signal_counts = 90.0;
  SpeckleConfig boiling = camera();
  boiling.rho = 0.8;
  SpeckleConfig large = camera();
  large.speckle_px = 7.0;
  SpeckleConfig fine = camera();
  fine.speckle_px = 2.0;
  SpeckleConfig bright = camera(256, 256, 16);
  bright.mean_signal_counts = 50000.0;
  return {{"8 bit", camera(), 1.37, -2.61, {1, -3}},
          {"10 bit", camera(128, 128, 10), -0.5, 0.25, {0, 0}},
          {"12 bit", camera(64, 64, 12), 4.49, 3.51, {3, 2}},
          {"16 bit", camera(96, 80, 16), -6.2, 7.7, {-6, 8}},
          {"wide", camera(141, 97), 20.3, -10.8, {20, -10}},
          {"tall", camera(64, 128), 0.02, 5.98, {0, 6}},
          {"saturated", saturated, 2.2, 1.1, {2, 1}},
          {"boiling", boiling, -1.4, 0.9, {-1, 1}},
          {"large speckle", large, 3.3, -3.3, {3, -3}},
          {"fine speckle", fine, 0.7, 0.3, {1, 0}},
          {"bright", bright, 1.5, 1.5, {2, 2}},
          {"guess far off", camera(), 0.4, 0.4, {30, 30}},
          {"guess outside", camera(), 0.4, 0.4, {500, 0}}};
}

TEST(TrackerTargets, AgreeOnEveryStage) {
  for (const Condition& c : conditions()) {
    SCOPED_TRACE(c.name);
    const FramePair pair = pair_of(c.config, 3, c.dx_px, c.dy_px);
    const TrackFrame earlier = loaded(pair.first), later = loaded(pair.second);
    const auto window_on = [&](std::int64_t target) {
      const test::ForcedTarget forced(target);
      return climb(earlier, later, static_cast<int>(c.guess.dx_px),
                   static_cast<int>(c.guess.dy_px));
    };
    const auto shift_on = [&](std::int64_t target, Refinement refinement) {
      const test::ForcedTarget forced(target);
      return measured(pair.first, pair.second, c.guess, refinement);
    };
    const std::vector<std::int64_t> targets = test::all_targets();
    const LagWindow window = window_on(targets.front());
    for (const std::int64_t target : targets) {
      SCOPED_TRACE(test::target_name(target));
      const LagWindow other = window_on(target);
      EXPECT_EQ(other.found, window.found);
      EXPECT_EQ(other.dx_px, window.dx_px);
      EXPECT_EQ(other.dy_px, window.dy_px);
      EXPECT_EQ(other.zncc, window.zncc);
      EXPECT_EQ(other.gain, window.gain);
      EXPECT_EQ(other.offset_counts, window.offset_counts);
      for (const Refinement refinement : {Refinement::none, Refinement::icgn}) {
        const TrackedShift want = shift_on(targets.front(), refinement);
        const TrackedShift got = shift_on(target, refinement);
        ASSERT_EQ(got.shift.status, want.shift.status);
        if (want.shift.status != ShiftStatus::ok) continue;
        EXPECT_NEAR(got.shift.dx_px, want.shift.dx_px, 1e-4);
        EXPECT_NEAR(got.shift.dy_px, want.shift.dy_px, 1e-4);
        EXPECT_NEAR(got.shift.quality.zncc, want.shift.quality.zncc, 1e-5);
        EXPECT_NEAR(got.shift.cov.xx_px2 / want.shift.cov.xx_px2, 1.0, 1e-2);
        EXPECT_NEAR(got.shift.cov.yy_px2 / want.shift.cov.yy_px2, 1.0, 1e-2);
        EXPECT_EQ(got.refined, want.refined);
      }
    }
  }
}

// --------------------------------------------------------------------------------- integer stage

/// ZNCC of the nine lags by definition: the pixels of the earlier frame that have a partner at all
/// nine, against their partners, in double.
struct Definition {
  std::array<double, 9> zncc{};
  double gain = 0.0, offset_counts = 0.0, n = 0.0;
};

Definition by_definition(const FrameView& earlier, const FrameView& later, int dx_px, int dy_px) {
  const int dropped = std::max(0, earlier.format.bit_depth - 12);
  const auto inside = [](int at, int side_px) { return at >= 1 && at < side_px - 1; };
  Definition out;
  for (int k = 0; k < 9; ++k) {
    std::vector<double> a, b;
    for (int y = 0; y < earlier.height_px(); ++y) {
      for (int x = 0; x < earlier.width_px(); ++x) {
        if (!inside(x + dx_px, later.width_px()) || !inside(y + dy_px, later.height_px())) continue;
        a.push_back(earlier.at(x, y) >> dropped);
        b.push_back(later.at(x + dx_px + k % 3 - 1, y + dy_px + k / 3 - 1) >> dropped);
      }
    }
    const auto n = static_cast<double>(a.size());
    double mean_a = 0.0, mean_b = 0.0, aa = 0.0, ab = 0.0, bb = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) mean_a += a[i] / n, mean_b += b[i] / n;
    for (std::size_t i = 0; i < a.size(); ++i) {
      aa += (a[i] - mean_a) * (a[i] - mean_a);
      ab += (a[i] - mean_a) * (b[i] - mean_b);
      bb += (b[i] - mean_b) * (b[i] - mean_b);
    }
    out.zncc[static_cast<std::size_t>(k)] = ab / std::sqrt(aa * bb);
    if (k != 4) continue;
    out.n = n;
    out.gain = std::sqrt(bb / aa);
    out.offset_counts = (mean_b - out.gain * mean_a) * (1 << dropped);
  }
  return out;
}

class LagWindowTest : public test::EveryTargetTest {};

TEST_P(LagWindowTest, IsTheZnccByDefinition) {
  struct Case {
    int width_px, height_px, bit_depth;
    std::vector<std::array<int, 2>> lags_px;
  };
  const std::vector<Case> cases = {
      {97, 64, 8, {{0, 0}, {1, -1}, {40, 3}, {-50, -20}, {84, 0}, {-84, 51}}},
      {64, 97, 12, {{0, 0}, {-1, 1}, {7, -30}}},
      {80, 75, 14, {{2, 3}}},
      {75, 80, 16, {{0, -2}, {-11, 40}}}};
  for (const Case& c : cases) {
    const FramePair pair = pair_of(
        camera(c.width_px, c.height_px, c.bit_depth == 14 ? 16 : c.bit_depth), 11, 0.6, -0.3);
    const TrackFrame earlier = loaded(pair.first), later = loaded(pair.second);
    for (const auto& [dx, dy] : c.lags_px) {
      SCOPED_TRACE(std::to_string(c.bit_depth) + " bit, lag " + std::to_string(dx) + ", " +
                   std::to_string(dy));
      LagWindow window;
      ASSERT_TRUE(lag_window_at(earlier, later, dx, dy, window));
      const Definition want = by_definition(pair.first.view(), pair.second.view(), dx, dy);
      for (std::size_t k = 0; k < 9; ++k) EXPECT_NEAR(window.zncc[k], want.zncc[k], 1e-12) << k;
      EXPECT_NEAR(window.gain, want.gain, 1e-12 * want.gain);
      EXPECT_NEAR(window.offset_counts, want.offset_counts, 1e-8);
      EXPECT_EQ(window.overlap_px, want.n);
    }
  }
}

TEST_P(LagWindowTest, LeavesTheWindowAloneWhereTooLittleOverlaps) {
  const FramePair pair = pair_of(camera(97, 64), 11, 0.0, 0.0);
  const TrackFrame frame = loaded(pair.first);
  LagWindow window;
  // 96 columns less the lag, rows alike.
  EXPECT_TRUE(lag_window_at(frame, frame, 96 - kMinOverlap_px, 63 - kMinOverlap_px, window));
  EXPECT_TRUE(lag_window_at(frame, frame, kMinOverlap_px - 96, kMinOverlap_px - 63, window));
  const LagWindow before = window;
  for (const auto& [dx, dy] :
       {std::array{97 - kMinOverlap_px, 0}, std::array{0, 64 - kMinOverlap_px},
        std::array{kMinOverlap_px - 97, 0}, std::array{400, 0}}) {
    EXPECT_FALSE(lag_window_at(frame, frame, dx, dy, window));
    EXPECT_EQ(window.zncc, before.zncc);
    EXPECT_EQ(window.dx_px, before.dx_px);
  }
}

TEST_P(LagWindowTest, ClimbsToTheHighestLag) {
  const FramePair pair = pair_of(camera(), 2, 3.2, -5.7);
  const TrackFrame earlier = loaded(pair.first), later = loaded(pair.second);
  for (const auto& [dx, dy] :
       {std::array{3, -6}, std::array{1, -6}, std::array{5, -4}, std::array{2, -8}}) {
    const LagWindow window = climb(earlier, later, dx, dy);
    EXPECT_TRUE(window.found);
    EXPECT_EQ(window.dx_px, 3);
    EXPECT_EQ(window.dy_px, -6);
    EXPECT_EQ(*std::max_element(window.zncc.begin(), window.zncc.end()), window.zncc[4]);
  }
}

// ------------------------------------------------------------------------------------------ laws

class TrackerTest : public test::EveryTargetTest {};

TEST_P(TrackerTest, FollowsTheSignAndAxisOfTheShift) {
  for (const auto& [w, h] :
       {std::array{128, 128}, std::array{97, 141}, std::array{141, 97}, std::array{64, 128}}) {
    const FramePair pair = pair_of(camera(w, h), 4, 5.3, -2.6);
    expect_shift(measured(pair.first, pair.second, {5, -3}), 5.3, -2.6, 5e-3);
    expect_shift(measured(pair.first, pair.second, {5, -3}, Refinement::none), 5.3, -2.6, 0.05,
                 Refinement::none);
  }
}

TEST_P(TrackerTest, SwappedFramesMoveTheOtherWay) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const double dx = 0.7 * static_cast<double>(seed) - 2.0, dy = 1.3 - dx;
    const FramePair pair = pair_of(camera(), seed, dx, dy);
    for (const Refinement refinement : {Refinement::icgn, Refinement::none}) {
      const Shift there = measured(pair.first, pair.second, {dx, dy}, refinement).shift;
      const Shift back = measured(pair.second, pair.first, {-dx, -dy}, refinement).shift;
      const double sigma_x = std::sqrt(there.cov.xx_px2 + back.cov.xx_px2);
      const double sigma_y = std::sqrt(there.cov.yy_px2 + back.cov.yy_px2);
      EXPECT_NEAR(there.dx_px, -back.dx_px, 3.0 * sigma_x);
      EXPECT_NEAR(there.dy_px, -back.dy_px, 3.0 * sigma_y);
      EXPECT_LT(std::max(sigma_x, sigma_y), refinement == Refinement::icgn ? 3e-3 : 2e-2);
    }
  }
}

TEST_P(TrackerTest, ThereAndBackIsNoShift) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    SpeckleConfig config = camera();
    config.seed = seed;
    auto camera = sim::SpeckleCamera::create(config);
    ASSERT_TRUE(camera);
    Frame start, away, end;
    ASSERT_TRUE(camera.value().render(0, {}, start));
    ASSERT_TRUE(camera.value().render(1, {.x_px = 2.41, .y_px = -1.18}, away));
    ASSERT_TRUE(camera.value().render(2, {}, end));
    const Shift there = measured(start, away, {2, -1}).shift;
    const Shift back = measured(away, end, {-2, 1}).shift;
    EXPECT_NEAR(there.dx_px + back.dx_px, 0.0, 3.0 * std::sqrt(there.cov.xx_px2 + back.cov.xx_px2));
    EXPECT_NEAR(there.dy_px + back.dy_px, 0.0, 3.0 * std::sqrt(there.cov.yy_px2 + back.cov.yy_px2));
  }
}

TEST_P(TrackerTest, TransposedFramesSwapTheAxes) {
  const FramePair pair = pair_of(camera(97, 141), 9, 3.62, -1.27);
  for (const Refinement refinement : {Refinement::icgn, Refinement::none}) {
    const TrackedShift upright = measured(pair.first, pair.second, {4, -1}, refinement);
    const TrackedShift turned =
        measured(transposed(pair.first), transposed(pair.second), {-1, 4}, refinement);
    expect_shift(turned, upright.shift.dy_px, upright.shift.dx_px, 1e-3, refinement);
    EXPECT_NEAR(turned.shift.cov.xx_px2 / upright.shift.cov.yy_px2, 1.0, 0.1);
  }
}

TEST_P(TrackerTest, GainAndOffsetOfTheLaterFrameDoNotMoveTheShift) {
  for (const int bits : {8, 12}) {
    const FramePair pair = pair_of(camera(128, 128, bits), 5, 1.44, 0.83);
    const TrackedShift plain = measured(pair.first, pair.second, {1, 1});
    const int full_scale = full_scale_counts(bits);
    for (const auto& [gain, offset] :
         {std::array{0.6, 0.1}, std::array{1.0, 0.2}, std::array{0.9, 0.05}}) {
      const Frame other =
          redrawn(pair.second.view().format, [&, g = gain, o = offset](int x, int y) {
            const double counts = g * pair.second.view().at(x, y) + o * full_scale;
            return std::lround(std::min(counts, static_cast<double>(full_scale)));
          });
      SCOPED_TRACE(std::to_string(bits) + " bit, gain " + std::to_string(gain));
      expect_shift(measured(pair.first, other, {1, 1}), plain.shift.dx_px, plain.shift.dy_px, 3e-3);
    }
  }
}

TEST_P(TrackerTest, WholeShiftsOfFramesWithoutNoiseAreExact) {
  for (const auto& [dx, dy] : {std::array{0, 0}, std::array{3, -2}, std::array{-7, 5},
                               std::array{1, 0}, std::array{0, -1}}) {
    const FramePair pair = pair_of(without_noise(camera()), 6, dx, dy);
    SCOPED_TRACE(std::to_string(dx) + ", " + std::to_string(dy));
    const Guess guess{static_cast<double>(dx), static_cast<double>(dy)};
    expect_shift(measured(pair.first, pair.second, guess), dx, dy, 2e-3);
  }
}

TEST_P(TrackerTest, TheDepthOfThePixelsDoesNotMoveTheShift) {
  // Dim enough for no pixel of either depth to be clipped.
  const auto dim = [](int bits) {
    SpeckleConfig out = without_noise(camera(128, 128, bits));
    out.mean_signal_counts = 0.07 * full_scale_counts(bits);
    return out;
  };
  const FramePair pair = pair_of(dim(8), 8, -1.71, 2.28);
  ASSERT_EQ(loaded(pair.first).stats().saturated_fraction, 0.0);
  const TrackedShift in_bytes = measured(pair.first, pair.second, {-2, 2});
  for (const int bits : {10, 12, 14, 16}) {
    SCOPED_TRACE(bits);
    FrameFormat format = pair.first.view().format;
    format.type = PixelType::mono16;
    format.bit_depth = bits;
    const auto in_words = [&](const Frame& frame) {
      return redrawn(format, [&](int x, int y) { return frame.view().at(x, y) << (bits - 8); });
    };
    // The same pixels in other units: the same numbers up to rounding.
    const TrackedShift same = measured(in_words(pair.first), in_words(pair.second), {-2, 2});
    expect_shift(same, in_bytes.shift.dx_px, in_bytes.shift.dy_px, 1e-5);
  }
  for (const int bits : {10, 12, 16}) {
    SCOPED_TRACE(bits);
    // The same light: an 8-bit pixel is rounded more coarsely.
    const FramePair deep = pair_of(dim(bits), 8, -1.71, 2.28);
    expect_shift(measured(deep.first, deep.second, {-2, 2}), in_bytes.shift.dx_px,
                 in_bytes.shift.dy_px, 3e-3);
  }
}

// ------------------------------------------------------------------------------------- the guess

TEST_P(TrackerTest, AGuessTwoPixelsOffGivesTheSameAnswer) {
  const FramePair pair = pair_of(camera(), 10, 2.35, -3.9);
  for (const Refinement refinement : {Refinement::icgn, Refinement::none}) {
    const TrackedShift want = measured(pair.first, pair.second, {2.35, -3.9}, refinement);
    for (const double ex : {-2.0, 0.0, 2.0}) {
      for (const double ey : {-2.0, 0.0, 2.0}) {
        expect_shift(measured(pair.first, pair.second, {2.35 + ex, -3.9 + ey}, refinement),
                     want.shift.dx_px, want.shift.dy_px, 1e-4, refinement);
      }
    }
  }
}

TEST_P(TrackerTest, AGuessFarOffIsNeverAGoodMatch) {
  const FramePair pair = pair_of(camera(), 12, 1.2, -0.8);
  int refused = 0;
  for (const Refinement refinement : {Refinement::icgn, Refinement::none}) {
    for (int dx = -60; dx <= 60; dx += 15) {
      for (int dy = -60; dy <= 60; dy += 15) {
        if (std::max(std::abs(dx - 1), std::abs(dy + 1)) < kLongWay_px) continue;
        const TrackedShift got =
            measured(pair.first, pair.second, {static_cast<double>(dx), static_cast<double>(dy)},
                     refinement);
        if (got.shift.status == ShiftStatus::ok) {
          EXPECT_LT(got.shift.quality.zncc, 0.35) << dx << ", " << dy;
        } else {
          expect_refused(got);
          ++refused;
        }
      }
    }
  }
  EXPECT_GT(refused, 0);
}

TEST_P(TrackerTest, AGuessOutsideTheFrameIsRefused) {
  const FramePair pair = pair_of(camera(), 12, 1.2, -0.8);
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const double far_px : {128.0, -128.0, 120.0, 1e18, -kInfinity, kInfinity}) {
    for (const Guess& guess : {Guess{far_px, 0.0}, Guess{0.0, far_px}}) {
      const TrackedShift got = measured(pair.first, pair.second, guess);
      EXPECT_EQ(got.shift.status, ShiftStatus::peak_at_border) << far_px;
      expect_refused(got);
    }
  }
}

// Half way between two lags both are equally high, and the windows around them, over different
// pixels, may each prefer the other.
TEST_P(TrackerTest, EqualNeighbouringLagsDoNotAlternate) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const FramePair pair = pair_of(camera(48, 48), seed, 0.5, seed % 2 == 0 ? -0.5 : 0.0);
    const double dy = seed % 2 == 0 ? -0.5 : 0.0;
    for (const Guess& guess : {Guess{0.0, 0.0}, Guess{1.0, -1.0}, Guess{2.0, 0.0}}) {
      SCOPED_TRACE("seed " + std::to_string(seed) + ", guess " + std::to_string(guess.dx_px));
      expect_shift(measured(pair.first, pair.second, guess), 0.5, dy, 0.03);
      expect_shift(measured(pair.first, pair.second, guess, Refinement::none), 0.5, dy, 0.2,
                   Refinement::none);
    }
  }
}

// ------------------------------------------------------------------------------ bad and odd frames

TEST_P(TrackerTest, ConstantFramesAreRefused) {
  const FramePair pair = pair_of(camera(), 13, 0.3, 0.0);
  const FrameFormat format = pair.first.view().format;
  for (const Refinement refinement : {Refinement::icgn, Refinement::none}) {
    for (const int counts : {0, 60, 255}) {
      const Frame flat = constant(format, counts);
      expect_refused(measured(flat, flat, {}, refinement));
      expect_refused(measured(flat, pair.second, {}, refinement));
      expect_refused(measured(pair.first, flat, {}, refinement));
    }
  }
}

TEST_P(TrackerTest, FramesTooSmallForItAreRefused) {
  for (const int side : {1, 2, 7, kMinOverlap_px + 1}) {
    const FramePair pair = pair_of(camera(side, side), 13, 0.0, 0.0);
    expect_refused(measured(pair.first, pair.second, {}));
  }
}

TEST_P(TrackerTest, FollowsSaturatedFrames) {
  for (const auto& [mean, tolerance] : {std::array{90.0, 3e-3}, std::array{150.0, 1e-2}}) {
    SpeckleConfig config = camera();
    config.mean_signal_counts = mean;
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      const FramePair pair = pair_of(config, seed, 2.63, -1.42);
      ASSERT_GT(loaded(pair.first).stats().saturated_fraction, 0.04);
      SCOPED_TRACE("mean " + std::to_string(mean) + ", seed " + std::to_string(seed));
      expect_shift(measured(pair.first, pair.second, {3, -1}), 2.63, -1.42, tolerance);
    }
  }
}

// -------------------------------------------------------------------------------- TrackFrame,
// reference

TEST_P(TrackerTest, StatisticsOfAFrameAreThoseOfItsPixels) {
  for (const int bits : {8, 12}) {
    SpeckleConfig config = camera(97, 40, bits);
    config.mean_signal_counts = 0.4 * full_scale_counts(bits);
    const FramePair pair = pair_of(config, 14, 0.0, 0.0);
    double sum = 0.0, squares = 0.0, saturated = 0.0;
    for (int y = 0; y < 40; ++y) {
      for (int x = 0; x < 97; ++x) {
        const double counts = pair.first.view().at(x, y);
        sum += counts;
        squares += counts * counts;
        saturated += counts == full_scale_counts(bits) ? 1.0 : 0.0;
      }
    }
    const double n = 97.0 * 40.0, mean = sum / n;
    const FrameStats stats = loaded(pair.first).stats();
    EXPECT_DOUBLE_EQ(stats.mean_counts, mean);
    EXPECT_NEAR(stats.sd_counts, std::sqrt(squares / n - mean * mean), 1e-9 * mean);
    EXPECT_GT(saturated, 0.0);
    EXPECT_DOUBLE_EQ(stats.saturated_fraction, saturated / n);
  }
}

TEST_P(TrackerTest, FramesAreCopiedWhateverTheirStride) {
  const FramePair pair = pair_of(camera(97, 40, 12), 14, 0.0, 0.0);
  const FrameView tight = pair.first.view();
  TrackFrame want(tight.format);
  want.load(tight);
  for (const std::ptrdiff_t stride_bytes : {194, 196, 400}) {
    std::vector<std::uint16_t> memory(static_cast<std::size_t>(stride_bytes / 2) * 40, 0xFFFF);
    FrameView view = tight;
    view.data = reinterpret_cast<const std::byte*>(memory.data());
    view.stride_bytes = stride_bytes;
    for (int y = 0; y < 40; ++y)
      std::memcpy(memory.data() + y * stride_bytes / 2, tight.row16(y), 194);
    TrackFrame got(tight.format);
    got.load(view);
    EXPECT_TRUE(got.same_pixels(want)) << stride_bytes;
    EXPECT_EQ(got.stats().mean_counts, want.stats().mean_counts);
    EXPECT_EQ(got.stats().sd_counts, want.stats().sd_counts);
    // Another pixel is another frame.
    memory[static_cast<std::size_t>(stride_bytes / 2 * 39 + 96)] ^= 1U;
    got.load(view);
    EXPECT_FALSE(got.same_pixels(want)) << stride_bytes;
  }
}

TEST_P(TrackerTest, PixelsWithinThreeOfAClippedOneAreLeftOut) {
  const FramePair pair = pair_of(camera(300, 40), 15, 0.0, 0.0);
  const std::vector<std::array<int, 2>> clipped = {
      {0, 0}, {299, 20}, {150, 39}, {255, 10}, {70, 20}};
  const Frame frame = redrawn(pair.first.view().format, [&](int x, int y) {
    const bool full = std::find(clipped.begin(), clipped.end(), std::array{x, y}) != clipped.end();
    return full ? 255 : std::min(254, pair.first.view().at(x, y));
  });
  TrackReference reference(frame.view().format);
  reference.build(loaded(frame), 4.0, 4.0);
  ASSERT_TRUE(reference.has_clipped_pixels());
  const auto all = reference.planes(false).value, unclipped = reference.planes(true).value;
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 300; ++x) {
      const bool near = std::any_of(clipped.begin(), clipped.end(), [&](const auto& at) {
        return std::max(std::abs(at[0] - x), std::abs(at[1] - y)) <= 3;
      });
      ASSERT_EQ(*unclipped.at(x, y), near ? kernels::kUnused : *all.at(x, y)) << x << ", " << y;
      ASSERT_LT(*all.at(x, y), 256.0F);
    }
  }
  // A later build of a frame without clipped pixels forgets them.
  reference.build(loaded(pair.first), 4.0, 4.0);
  EXPECT_EQ(reference.has_clipped_pixels(), loaded(pair.first).stats().saturated_fraction > 0.0);
}

LSV_INSTANTIATE_FOR_EVERY_TARGET(LagWindowTest);
LSV_INSTANTIATE_FOR_EVERY_TARGET(TrackerTest);

}  // namespace
}  // namespace lsv
