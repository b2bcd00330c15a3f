// SPDX-License-Identifier: BSD-3-Clause
// Engines against the reference, on frames that are not square, odd, small, 8 and 16 bit.
#include "correlation/correlator.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "correlation/peak.h"
#include "tests/support/pattern.h"

namespace lsv {
namespace {

constexpr FrameFormat kFormats[] = {
    {.width_px = 48, .height_px = 64, .type = PixelType::mono8, .bit_depth = 8},
    {.width_px = 64, .height_px = 48, .type = PixelType::mono8, .bit_depth = 8},
    {.width_px = 37, .height_px = 53, .type = PixelType::mono8, .bit_depth = 8},
    {.width_px = 40, .height_px = 40, .type = PixelType::mono16, .bit_depth = 12},
    {.width_px = 33, .height_px = 40, .type = PixelType::mono16, .bit_depth = 16},
};

double mean_for(const FrameFormat& format) { return 0.25 * full_scale_counts(format.bit_depth); }

Frame noise_frame(const FrameFormat& format, unsigned seed) {
  std::mt19937 random(seed);
  Frame out(format);
  for (int y = 0; y < format.height_px; ++y) {
    for (int x = 0; x < format.width_px; ++x) {
      const auto counts = random() % static_cast<unsigned>(full_scale_counts(format.bit_depth) + 1);
      if (format.type == PixelType::mono8)
        out.row8(y)[x] = static_cast<std::uint8_t>(counts);
      else
        out.row16(y)[x] = static_cast<std::uint16_t>(counts);
    }
  }
  return out;
}

struct Pair {
  std::unique_ptr<Correlator> correlator;
  PreparedFrame earlier, later;
  CorrelationPlane plane;
};

Pair correlate(Engine engine, const Frame& earlier, const Frame& later,
               std::optional<int> max_shift_px = std::nullopt) {
  const CorrelationConfig config{.engine = engine, .max_shift_px = max_shift_px};
  Pair out{.correlator = make_correlator(config, earlier.view().format).value(),
           .earlier = {},
           .later = {},
           .plane = {}};
  out.earlier = out.correlator->make_prepared_frame();
  out.later = out.correlator->make_prepared_frame();
  out.plane = out.correlator->make_plane();
  out.correlator->prepare(earlier.view(), out.earlier);
  out.correlator->prepare(later.view(), out.later);
  out.correlator->correlate(out.earlier, out.later, out.plane);
  return out;
}

// Single-precision FFT: the raw correlation carries about 1e-7 of the energy per butterfly stage,
// and border lags divide by a smaller overlap.
constexpr double kPlaneTolerance = 2e-5;

TEST(ZnccCorrelator, EqualsTheReferenceAtEveryLag) {
  for (const FrameFormat& format : kFormats) {
    const Frame a = noise_frame(format, 11);
    const test::PlaneWavePattern pattern(5, 4.0);
    const Frame b = pattern.frame(format, 2.4, -1.7, mean_for(format));
    const Frame c = pattern.frame(format, -3.1, 4.2, mean_for(format));
    for (const auto& [earlier, later] : {std::pair{&a, &b}, std::pair{&b, &c}}) {
      const Pair fast = correlate(Engine::zncc, *earlier, *later);
      const Pair direct = correlate(Engine::direct, *earlier, *later);
      ASSERT_EQ(fast.plane.lags, direct.plane.lags);
      for (std::size_t i = 0; i < fast.plane.values.size(); ++i) {
        ASSERT_NEAR(fast.plane.values[i], direct.plane.values[i], kPlaneTolerance)
            << format.width_px << "x" << format.height_px << " lag " << i;
      }
    }
  }
}

// A frame cut from a larger one moved by whole pixels correlates to exactly 1 at that lag: pins
// the sign of both axes and the overlap.
TEST(ZnccCorrelator, IsOneAtAWholePixelShift) {
  const FrameFormat large{.width_px = 160, .height_px = 140};
  const Frame ground = noise_frame(large, 7);
  for (const auto& [dx, dy] : {std::pair{0, 0}, {13, 0}, {0, -9}, {-17, 21}, {32, -24}}) {
    const Roi first{.x_px = 40, .y_px = 40, .width_px = 72, .height_px = 56};
    Roi second = first;
    second.x_px -= dx;  // the camera sees ground further left, so the pattern moves right
    second.y_px -= dy;
    ASSERT_TRUE(contains(large, second));
    Frame a(crop(ground.view(), first).format), b(a.view().format);
    for (int y = 0; y < 56; ++y) {
      for (int x = 0; x < 72; ++x) {
        a.row8(y)[x] = static_cast<std::uint8_t>(ground.view().at(40 + x, 40 + y));
        b.row8(y)[x] =
            static_cast<std::uint8_t>(ground.view().at(second.x_px + x, second.y_px + y));
      }
    }
    const Pair pair = correlate(Engine::zncc, a, b, 40);
    EXPECT_NEAR(pair.plane.at(dx, dy), 1.0, 1e-5) << dx << "," << dy;
    EXPECT_NEAR(zncc_at(pair.earlier, pair.later, dx, dy), 1.0, 1e-12);
  }
}

TEST(ZnccCorrelator, DoesNotChangeWithBrightnessAndGain) {
  const FrameFormat format{
      .width_px = 48, .height_px = 56, .type = PixelType::mono16, .bit_depth = 16};
  const Frame a = noise_frame({.width_px = 48, .height_px = 56}, 3);
  Frame scaled(format);
  Frame plain(format);
  for (int y = 0; y < 56; ++y) {
    for (int x = 0; x < 48; ++x) {
      plain.row16(y)[x] = static_cast<std::uint16_t>(a.view().at(x, y));
      scaled.row16(y)[x] = static_cast<std::uint16_t>(200 * a.view().at(x, y) + 4000);
    }
  }
  const Pair self = correlate(Engine::zncc, plain, plain);
  const Pair gained = correlate(Engine::zncc, plain, scaled);
  for (std::size_t i = 0; i < self.plane.values.size(); ++i)
    ASSERT_NEAR(self.plane.values[i], gained.plane.values[i], kPlaneTolerance);
}

TEST(EveryEngine, FindsTheShiftAndItsReverse) {
  const test::PlaneWavePattern pattern(9, 3.5);
  for (const Engine engine : {Engine::zncc, Engine::cross, Engine::phase, Engine::direct}) {
    for (const FrameFormat& format : {kFormats[0], kFormats[2], kFormats[3]}) {
      const Frame a = pattern.frame(format, 0.0, 0.0, mean_for(format));
      const Frame b = pattern.frame(format, 3.0, -5.0, mean_for(format));
      const Peak there = find_peak(correlate(engine, a, b).plane, PeakFit::parabola3);
      const Peak back = find_peak(correlate(engine, b, a).plane, PeakFit::parabola3);
      EXPECT_EQ(there.lag_dx_px, 3) << word(engine);
      EXPECT_EQ(there.lag_dy_px, -5) << word(engine);
      EXPECT_EQ(back.lag_dx_px, -3) << word(engine);
      EXPECT_EQ(back.lag_dy_px, 5) << word(engine);
    }
  }
}

TEST(EveryEngine, ReversedPairGivesTheMirroredPlane) {
  const Frame a = noise_frame(kFormats[0], 1);
  const Frame b = noise_frame(kFormats[0], 2);
  for (const Engine engine : {Engine::zncc, Engine::cross, Engine::phase, Engine::direct}) {
    const Pair there = correlate(engine, a, b);
    const Pair back = correlate(engine, b, a);
    const std::size_t n = there.plane.values.size();
    for (std::size_t i = 0; i < n; ++i)
      ASSERT_NEAR(there.plane.values[i], back.plane.values[n - 1 - i], kPlaneTolerance);
  }
}

TEST(EveryEngine, ConstantFramesGiveAFinitePlane) {
  Frame flat(kFormats[0]);
  for (int y = 0; y < 64; ++y) std::fill_n(flat.row8(y), 48, std::uint8_t{77});
  const Frame noise = noise_frame(kFormats[0], 2);
  for (const Engine engine : {Engine::zncc, Engine::cross, Engine::phase, Engine::direct}) {
    for (const Frame* later : std::initializer_list<const Frame*>{&flat, &noise}) {
      const Pair pair = correlate(engine, flat, *later);
      for (const float value : pair.plane.values.span()) ASSERT_TRUE(std::isfinite(value));
    }
  }
}

TEST(ResolveLags, DefaultsToTheRangeOfTheSourceOrHalfTheFrame) {
  EXPECT_EQ(resolve_lags({}, {.width_px = 128, .height_px = 100}).value(), (LagRange{32, 32}));
  EXPECT_EQ(resolve_lags({}, {.width_px = 48, .height_px = 200}).value(), (LagRange{24, 32}));
}

TEST(ResolveLags, RefusesWhatLeavesNoOverlap) {
  const FrameFormat format{.width_px = 64, .height_px = 48};
  EXPECT_TRUE(resolve_lags({.max_shift_px = 40}, format));
  const auto refused = resolve_lags({.max_shift_px = 41}, format);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::invalid_argument);
  EXPECT_NE(refused.error().message.find("at most 40"), std::string::npos);
  EXPECT_FALSE(resolve_lags({}, {.width_px = 15, .height_px = 48}));
}

TEST(IdenticalPixels, SeesOneCountInOnePixel) {
  const Frame a = noise_frame(kFormats[2], 21);
  Frame b = noise_frame(kFormats[2], 21);
  EXPECT_TRUE([&] {
    const Pair pair = correlate(Engine::zncc, a, b);
    return identical_pixels(pair.earlier, pair.later);
  }());
  b.row8(50)[36] = static_cast<std::uint8_t>(b.row8(50)[36] ^ 1);
  const Pair pair = correlate(Engine::zncc, a, b);
  EXPECT_FALSE(identical_pixels(pair.earlier, pair.later));
}

}  // namespace
}  // namespace lsv
