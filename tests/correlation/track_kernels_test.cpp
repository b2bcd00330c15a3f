// SPDX-License-Identifier: BSD-3-Clause
// Every kernel of the tracker on every instruction set of this machine, scalar included, against
// track_kernels_ref.h.
#include "correlation/track_kernels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <set>
#include <vector>

#include "correlation/aligned_buffer.h"
#include "correlation/track_kernels_ref.h"
#include "tests/correlation/every_target.h"

namespace lsv::kernels {
namespace {

/// Pixels with the padding that the kernels ask for, the padding filled with `poison`. The memory
/// ends with the padding of the last row, so that a sanitizer sees what reaches further.
template <typename T>
class Image {
 public:
  Image(int width_px, int height_px, T poison)
      : width_px_(width_px),
        height_px_(height_px),
        stride_((width_px + 2 * kPadding + 63) / 64 * 64),
        values_(static_cast<std::size_t>(stride_ * height_px)) {
    std::fill(values_.span().begin(), values_.span().end(), poison);
  }

  int width_px() const { return width_px_; }
  int height_px() const { return height_px_; }
  T& at(int x, int y) { return *plane().at(x, y); }
  Plane<T> plane() { return {values_.data() + kPadding, stride_}; }
  Plane<const T> from(int x, int y) const {
    return {values_.data() + kPadding + y * stride_ + x, stride_};
  }

  /// value() for each pixel.
  template <class Value>
  Image& fill(const Value& value) {
    for (int y = 0; y < height_px_; ++y) {
      for (int x = 0; x < width_px_; ++x) at(x, y) = static_cast<T>(value());
    }
    return *this;
  }

 private:
  int width_px_;
  int height_px_;
  std::ptrdiff_t stride_;
  AlignedBuffer<T> values_;
};

class TrackKernelsTest : public test::EveryTargetTest {
 protected:
  int random_int(int lowest, int highest) {
    return lowest + static_cast<int>(random_() % static_cast<unsigned>(highest - lowest + 1));
  }
  float random_float(float largest) {
    return largest * static_cast<float>(random_int(-10000, 10000)) / 10000.0F;
  }
  template <typename Pixel>
  Image<Pixel> random_image(int width_px, int height_px, int full_scale_counts) {
    Image<Pixel> out(width_px, height_px, std::numeric_limits<Pixel>::max());
    out.fill([&] { return random_int(0, full_scale_counts); });
    return out;
  }

  std::mt19937 random_{20260301};
};

// ---------------------------------------------------------------------------------- copy and sum

template <typename Pixel>
void expect_copied_and_summed(const Image<Pixel>& image, int x0, int width_px, int height_px,
                              Pixel full_scale_counts) {
  constexpr Pixel kSentinel = 77;
  Image<Pixel> got(width_px, height_px, kSentinel), want(width_px, height_px, kSentinel);
  const CountSums sums =
      copy_and_sum(image.from(x0, 0), width_px, height_px, full_scale_counts, got.plane());
  const CountSums truth =
      ref::copy_and_sum(image.from(x0, 0), width_px, height_px, full_scale_counts, want.plane());
  EXPECT_EQ(sums.sum_counts, truth.sum_counts) << width_px;
  EXPECT_EQ(sums.sum_squares_counts2, truth.sum_squares_counts2) << width_px;
  EXPECT_EQ(sums.saturated, truth.saturated) << width_px;
  for (int y = 0; y < height_px; ++y) {
    ASSERT_EQ(0, std::memcmp(got.plane().at(-kPadding, y), want.plane().at(-kPadding, y),
                             static_cast<std::size_t>(width_px + 2 * kPadding) * sizeof(Pixel)))
        << width_px << ", row " << y;
  }
}

TEST_P(TrackKernelsTest, CopyAndSumIsExactAtEveryWidthAndLeavesThePaddingAlone) {
  const auto image8 = random_image<std::uint8_t>(150, 5, 255);
  const auto image16 = random_image<std::uint16_t>(150, 5, 65535);
  for (int width = 1; width <= 141; ++width) {
    expect_copied_and_summed<std::uint8_t>(image8, width % 7, width, 5, 255);
    expect_copied_and_summed<std::uint8_t>(image8, width % 7, width, 5, 200);
    expect_copied_and_summed<std::uint16_t>(image16, width % 7, width, 5, 50000);
  }
}

// 32-bit sums must be emptied in time: down a large frame, and within one long row.
TEST_P(TrackKernelsTest, CopyAndSumHoldsFullScale) {
  const auto full8 = [] { return 255; };
  const auto full16 = [] { return 65535; };
  expect_copied_and_summed(Image<std::uint8_t>(2048, 600, 0).fill(full8), 0, 2048, 600,
                           std::uint8_t{255});
  expect_copied_and_summed(Image<std::uint8_t>(600000, 1, 0).fill(full8), 0, 600000, 1,
                           std::uint8_t{255});
  expect_copied_and_summed(Image<std::uint16_t>(2048, 300, 0).fill(full16), 0, 2048, 300,
                           std::uint16_t{65535});
}

// ------------------------------------------------------------------------------------ lag window

template <typename Pixel>
void expect_lag_products(Plane<const Pixel> earlier, Plane<const Pixel> later, int width_px,
                         int height_px, int drop_bits) {
  const LagProducts got = lag_products(earlier, later, width_px, height_px, drop_bits);
  const LagProducts want = ref::lag_products(earlier, later, width_px, height_px, drop_bits);
  for (int k = 0; k < 9; ++k) EXPECT_EQ(got.product[k], want.product[k]) << k << ", " << width_px;
  EXPECT_EQ(got.earlier, want.earlier) << width_px;
  EXPECT_EQ(got.earlier_squares, want.earlier_squares) << width_px;
  EXPECT_EQ(got.later, want.later) << width_px;
  EXPECT_EQ(got.later_squares, want.later_squares) << width_px;
}

TEST_P(TrackKernelsTest, LagProductsOf8BitsAreExactAtEveryWidth) {
  const auto earlier = random_image<std::uint8_t>(150, 12, 255);
  const auto later = random_image<std::uint8_t>(150, 12, 255);
  for (int width = 1; width <= 141; ++width) {
    // The region ends at the last column that has a neighbour: vectors reach into the padding.
    const int later_x = 149 - width;
    const int earlier_x = random_int(0, 150 - width);
    expect_lag_products(earlier.from(earlier_x, 0), later.from(later_x, 1), width, 10, 0);
  }
}

TEST_P(TrackKernelsTest, LagProductsOf16BitsAreExactAtEveryDepth) {
  for (const int bits : {10, 12, 14, 16}) {
    const int drop_bits = std::max(0, bits - 12);
    const auto earlier = random_image<std::uint16_t>(150, 12, (1 << bits) - 1);
    const auto later = random_image<std::uint16_t>(150, 12, (1 << bits) - 1);
    for (const int width : {1, 12, 13, 16, 31, 32, 33, 64, 97, 128, 141}) {
      expect_lag_products(earlier.from(random_int(0, 150 - width), 2), later.from(149 - width, 1),
                          width, 10, drop_bits);
      expect_lag_products(earlier.from(150 - width, 0), later.from(1, 1), width, 10, drop_bits);
    }
  }
}

TEST_P(TrackKernelsTest, LagProductsHoldFullScale) {
  Image<std::uint8_t> full8(1100, 1000, 255);
  expect_lag_products<std::uint8_t>(full8.from(3, 0), full8.from(1, 1), 1097, 998, 0);
  for (const int bits : {12, 16}) {
    Image<std::uint16_t> full16(500, 300, 65535);
    full16.fill([&] { return (1 << bits) - 1; });
    expect_lag_products<std::uint16_t>(full16.from(3, 0), full16.from(1, 1), 497, 298, bits - 12);
  }
}

// ------------------------------------------------------------------------------------ probed rows

template <typename Pixel>
void expect_probed(const Image<Pixel>& earlier, const Image<Pixel>& later, int width_px,
                   const ProbeMap& map) {
  constexpr int kCount = 3, kStep = 3;
  ProbedRow got[kCount], want[kCount];
  probe_rows(earlier.from(2, 2), later.from(1, 1), width_px, kCount, kStep, map, got);
  ref::probe_rows(earlier.from(2, 2), later.from(1, 1), width_px, kCount, kStep, map, want);
  EXPECT_EQ(0, std::memcmp(got, want, sizeof got)) << width_px << ", " << map.bit_depth << " bit";
}

// Steep gains and odd weights, so that every clamp is met.
TEST_P(TrackKernelsTest, ProbedRowsAreExactAtEveryWidthAndDepth) {
  for (const int gain : {700, 2048, 9000}) {
    ProbeMap map{.bit_depth = 8,
                 .weights_x = {300, -3000, 30000, 6000, -532},
                 .weights_y = {-700, 5000, 29000, -800, 268},
                 .gain_2048 = static_cast<std::int16_t>(gain),
                 .earlier_mean = 200,
                 .later_mean = 240};
    const auto earlier8 = random_image<std::uint8_t>(150, 12, 255);
    const auto later8 = random_image<std::uint8_t>(150, 12, 255);
    for (int width = 2; width <= 141; ++width) expect_probed(earlier8, later8, width, map);
    for (const int bits : {9, 12, 16}) {
      map.bit_depth = bits;
      const auto earlier16 = random_image<std::uint16_t>(150, 12, (1 << bits) - 1);
      const auto later16 = random_image<std::uint16_t>(150, 12, (1 << bits) - 1);
      for (const int width : {2, 31, 64, 97, 141}) expect_probed(earlier16, later16, width, map);
    }
  }
}

// ------------------------------------------------------------------------------------- gradients

constexpr double kUlp = 0x1p-24;  // of a sum of 1 in single precision, rounded to the nearest

TEST_P(TrackKernelsTest, DerivativeIsRightToSingleRounding) {
  constexpr std::array<float, kGradientReach_px> kWeights{0.83F, -0.21F, 0.06F, -0.01F};
  for (const int width : {1, 8, 15, 16, 17, 97, 128, 141}) {
    Image<float> image(width, 20, 1e3F);
    image.fill([&] { return random_float(200.0F); });
    for (const std::ptrdiff_t step : {std::ptrdiff_t{1}, image.plane().stride}) {
      Image<float> got(width, 12, 0.0F), want(width, 12, 0.0F);
      derivative(image.from(0, 4), step, width, 12, kWeights, got.plane());
      ref::derivative(image.from(0, 4), step, width, 12, kWeights, want.plane());
      // Eight roundings of terms that are at most 2000 counts times a weight.
      constexpr double kTolerance = 8.0 * kUlp * 2000.0 * (0.83 + 0.21 + 0.06 + 0.01);
      for (int y = 0; y < 12; ++y) {
        for (int x = 0; x < width; ++x)
          ASSERT_NEAR(got.at(x, y), want.at(x, y), kTolerance)
              << x << ", " << y << " step " << step;
      }
    }
  }
}

// ----------------------------------------------------------------------------- Gauss-Newton sums

/// A reference pattern; the pixels outside the frame hold numbers that would spoil every sum.
struct Reference {
  Image<float> value, gx, gy;

  Reference(int width_px, int height_px)
      : value(width_px, height_px, 1e9F),
        gx(width_px, height_px, 1e9F),
        gy(width_px, height_px, 1e9F) {}

  ReferencePlanes planes() const { return {value.from(0, 0), gx.from(0, 0), gy.from(0, 0)}; }

  /// Scattered pixels, a whole row, and a block at a corner.
  template <class Draw>
  void drop_some(const Draw& draw) {
    for (int y = 0; y < value.height_px(); ++y) {
      for (int x = 0; x < value.width_px(); ++x) {
        if (draw() || y == 9 || (x < 12 && y < 6)) value.at(x, y) = kUnused;
      }
    }
  }
};

/// Scratch memory of the size asked for and no more, full of nonsense.
class Scratch {
 public:
  explicit Scratch(int width_px) : floats_(residual_scratch_size(width_px)) {
    std::fill(floats_.span().begin(), floats_.span().end(), std::nanf(""));
  }
  float* data() { return floats_.data(); }

 private:
  AlignedBuffer<float> floats_;
};

/// A region and a whole shift that keep pixels -3..4 inside a later frame of the same size.
struct Place {
  Region region;
  int dx_px, dy_px;
};

std::vector<Place> places(int w, int h) {
  return {
      {{4, 4, w - 8, h - 8}, 0, 0},       // what a frame leaves at no shift
      {{0, 0, w - 7, h - 7}, 3, 3},       // first columns of reference and of later frame
      {{7, 7, w - 7, h - 7}, -4, -4},     // last columns of both
      {{0, 5, w - 20, h - 12}, 16, 3},    // last columns of the later frame
      {{21, 4, w - 21, h - 12}, -18, 4},  // first columns of the later frame
      {{13, 6, 9, 8}, -2, 1},             // narrower than a vector, across two
      {{16, 4, 16, h - 8}, 1, -1},        // whole vectors
      {{w - 8, 4, 1, h - 8}, 0, 0},       // one column
      {{5, 11, w - 9, 1}, 0, -3},         // one row
  };
}

void expect_equal(const ReferenceSums& got, const ReferenceSums& want) {
  EXPECT_EQ(got.n, want.n);
  EXPECT_EQ(got.n_next_row, want.n_next_row);
  EXPECT_EQ(got.v, want.v);
  EXPECT_EQ(got.vv, want.vv);
  EXPECT_EQ(got.x, want.x);
  EXPECT_EQ(got.y, want.y);
  EXPECT_EQ(got.xv, want.xv);
  EXPECT_EQ(got.yv, want.yv);
  EXPECT_EQ(got.xx, want.xx);
  EXPECT_EQ(got.xy, want.xy);
  EXPECT_EQ(got.yy, want.yy);
}

void expect_equal(const ResidualSums& got, const ResidualSums& want) {
  EXPECT_EQ(got.r, want.r);
  EXPECT_EQ(got.rr, want.rr);
  EXPECT_EQ(got.rv, want.rv);
  EXPECT_EQ(got.rx, want.rx);
  EXPECT_EQ(got.ry, want.ry);
  EXPECT_EQ(got.rr_next_row, want.rr_next_row);
  EXPECT_EQ(got.few_rr, want.few_rr);
  EXPECT_EQ(got.few_g, want.few_g);
  EXPECT_EQ(got.few_rrg, want.few_rrg);
  EXPECT_EQ(got.few_n, want.few_n);
}

std::string place_name(const Place& place, int width_px) {
  const Region& r = place.region;
  return std::to_string(r.width_px) + "x" + std::to_string(r.height_px) + " at " +
         std::to_string(r.x_px) + "," + std::to_string(r.y_px) + " of " + std::to_string(width_px) +
         " moved " + std::to_string(place.dx_px) + "," + std::to_string(place.dy_px);
}

// Small whole numbers add up exactly in single precision, in any order: whatever pixel is missing,
// counted twice or paired with the wrong neighbour shows.
TEST_P(TrackKernelsTest, ReferenceSumsOfSmallNumbersAreExact) {
  constexpr int kHeight = 41;
  for (const int width : {40, 64, 97, 141}) {
    Reference reference(width, kHeight);
    reference.value.fill([&] { return random_int(-9, 9); });
    reference.gx.fill([&] { return random_int(-9, 9); });
    reference.gy.fill([&] { return random_int(-9, 9); });
    for (const bool drop : {false, true}) {
      if (drop) reference.drop_some([&] { return random_int(0, 9) == 0; });
      for (const Place& place : places(width, kHeight)) {
        SCOPED_TRACE(place_name(place, width));
        Scratch scratch(place.region.width_px);
        expect_equal(reference_sums(reference.planes(), place.region, scratch.data()),
                     ref::reference_sums(reference.planes(), place.region));
      }
    }
  }
}

// Weights of quarters and pixels of 0 and 1 keep every residual a multiple of 1/16 count below 5,
// so that these sums are exact as well. No two weights can be exchanged unnoticed, nor the axes.
TEST_P(TrackKernelsTest, ResidualSumsOfSmallNumbersAreExact) {
  constexpr int kHeight = 33;
  constexpr FixedWeights kEightX{8192, -8192, 8192, 16384, 8192, -8192, 8192, 0};
  constexpr FixedWeights kEightY{0, 8192, -8192, 8192, 8192, 16384, -8192, 8192};
  constexpr FixedWeights kSixX{0, -8192, 8192, 16384, 8192, 8192, 0, 0};
  constexpr FixedWeights kSixY{0, 0, 8192, 8192, 16384, -8192, 8192, 0};
  for (const int width : {40, 97, 141}) {
    const auto later = random_image<std::uint8_t>(width, kHeight, 1);
    const auto later16 = random_image<std::uint16_t>(width, kHeight, 1);
    Reference reference(width, kHeight);
    reference.value.fill([&] { return random_int(-1, 1); });
    reference.gx.fill([&] { return random_int(-1, 1); });
    reference.gy.fill([&] { return random_int(-1, 1); });
    for (const bool drop : {false, true}) {
      if (drop) reference.drop_some([&] { return random_int(0, 9) == 0; });
      for (const Place& place : places(width, kHeight)) {
        SCOPED_TRACE(place_name(place, width));
        for (const bool six : {false, true}) {
          SCOPED_TRACE(six ? "six taps" : "eight taps");
          Warp warp{.whole_dx_px = place.dx_px,
                    .whole_dy_px = place.dy_px,
                    .bit_depth = 8,
                    .weights_x = six ? kSixX : kEightX,
                    .weights_y = six ? kSixY : kEightY,
                    .six_taps = six,
                    .gain = 2.0F,
                    .offset_counts = 0.25F};
          const ReferencePlanes planes = reference.planes();
          Scratch scratch(place.region.width_px);
          expect_equal(residual_sums(planes, later.from(0, 0), place.region, warp, scratch.data()),
                       ref::residual_sums(planes, later.from(0, 0), place.region, warp));
          warp.bit_depth = 12;
          expect_equal(
              residual_sums(planes, later16.from(0, 0), place.region, warp, scratch.data()),
              ref::residual_sums(planes, later16.from(0, 0), place.region, warp));
        }
      }
    }
  }
}

/// Largest error of a sum of products in single precision, `added` numbers to a lane: every
/// addition and the few operations within a term round once. An error of the residual, itself a
/// difference of large numbers, goes into the term with the residual's partner.
class Tolerance {
 public:
  explicit Tolerance(double added) : added_(added) {}
  /// `with_terms`: the term with the residual replaced by what it is the difference of.
  void add(double term, double with_terms = 0.0) {
    sum_ += kUlp * ((added_ + 8.0) * std::abs(term) + 4.0 * std::abs(with_terms));
  }
  double value() const { return sum_; }

 private:
  double added_;
  double sum_ = 0.0;
};

template <typename Pixel>
void expect_near(const ResidualSums& got, const ReferencePlanes& reference,
                 Plane<const Pixel> later, const Region& region, const Warp& warp) {
  const ResidualSums want = ref::residual_sums(reference, later, region, warp);
  // The sums are emptied every 16 rows, those over few rows at the end only; a lane is at most as
  // long as a row.
  const double rows = std::min(16, region.height_px);
  const double few_rows = (region.height_px + kGradientRowStep - 1) / kGradientRowStep;
  Tolerance r(rows * region.width_px), rr = r, rv = r, rx = r, ry = r, next = r;
  Tolerance few_rr(few_rows * region.width_px), few_g = few_rr, few_rrg = few_rr;
  for (int x = region.x_px; x < region.x_px + region.width_px; ++x) {
    double above = 0.0, above_terms = 0.0;
    for (int row = 0; row < region.height_px; ++row) {
      const int y = region.y_px + row;
      const double d = ref::residual(reference, later, warp, x, y);
      const double v = ref::is_used(reference, x, y) ? *reference.value.at(x, y) : 0.0;
      const double gain_v = std::abs(static_cast<double>(warp.gain) * v);
      const double terms = 2.0 * gain_v + std::abs(d);  // |pixel - offset| and |gain v| at most
      const double gx = *reference.gx.at(x, y), gy = *reference.gy.at(x, y);
      r.add(d, terms);
      rr.add(d * d, 2.0 * d * terms);
      rv.add(d * v, terms * v);
      rx.add(d * gx, terms * gx);
      ry.add(d * gy, terms * gy);
      next.add(d * above, std::abs(d) * above_terms + terms * std::abs(above));
      above = d, above_terms = terms;
      if (row % kGradientRowStep != 0) continue;
      const double g = gx * gx + gy * gy;
      few_rr.add(d * d, 2.0 * d * terms);
      few_g.add(g);
      few_rrg.add(d * d * g, 2.0 * d * terms * g);
    }
  }
  EXPECT_NEAR(got.r, want.r, r.value());
  EXPECT_NEAR(got.rr, want.rr, rr.value());
  EXPECT_NEAR(got.rv, want.rv, rv.value());
  EXPECT_NEAR(got.rx, want.rx, rx.value());
  EXPECT_NEAR(got.ry, want.ry, ry.value());
  EXPECT_NEAR(got.rr_next_row, want.rr_next_row, next.value());
  EXPECT_NEAR(got.few_rr, want.few_rr, few_rr.value());
  EXPECT_NEAR(got.few_g, want.few_g, few_g.value());
  EXPECT_NEAR(got.few_rrg, want.few_rrg, few_rrg.value());
  EXPECT_EQ(got.few_n, want.few_n);
}

FixedWeights fixed(const KernelWeights& weights) {
  FixedWeights out{};
  for (std::size_t j = 0; j < out.size(); ++j)
    out[j] = static_cast<std::int16_t>(std::lround(std::min(weights[j] * 32768.0F, 32767.0F)));
  return out;
}

TEST_P(TrackKernelsTest, ReferenceSumsAreRightToSingleRounding) {
  Reference reference(141, 97);
  reference.value.fill([&] { return random_float(200.0F); });
  reference.gx.fill([&] { return random_float(60.0F); });
  reference.gy.fill([&] { return random_float(60.0F); });
  reference.drop_some([&] { return random_int(0, 9) == 0; });
  const Region region{8, 4, 129, 89};
  Scratch scratch(141);
  const ReferenceSums got = reference_sums(reference.planes(), region, scratch.data());
  const ReferenceSums want = ref::reference_sums(reference.planes(), region);
  Tolerance v(16.0 * region.width_px), vv = v, gx = v, gy = v, xv = v, yv = v, xx = v, xy = v,
                                       yy = v;
  for (int y = region.y_px; y < region.y_px + region.height_px; ++y) {
    for (int x = region.x_px; x < region.x_px + region.width_px; ++x) {
      if (!ref::is_used(reference.planes(), x, y)) continue;
      const double a = reference.value.at(x, y);
      const double b = reference.gx.at(x, y), c = reference.gy.at(x, y);
      v.add(a), vv.add(a * a), gx.add(b), gy.add(c);
      xv.add(b * a), yv.add(c * a), xx.add(b * b), xy.add(b * c), yy.add(c * c);
    }
  }
  EXPECT_EQ(got.n, want.n);
  EXPECT_EQ(got.n_next_row, want.n_next_row);
  EXPECT_NEAR(got.v, want.v, v.value());
  EXPECT_NEAR(got.vv, want.vv, vv.value());
  EXPECT_NEAR(got.x, want.x, gx.value());
  EXPECT_NEAR(got.y, want.y, gy.value());
  EXPECT_NEAR(got.xv, want.xv, xv.value());
  EXPECT_NEAR(got.yv, want.yv, yv.value());
  EXPECT_NEAR(got.xx, want.xx, xx.value());
  EXPECT_NEAR(got.xy, want.xy, xy.value());
  EXPECT_NEAR(got.yy, want.yy, yy.value());
}

TEST_P(TrackKernelsTest, ResidualSumsAreRightToSingleRoundingAtEveryDepth) {
  constexpr int kWidth = 97, kHeight = 41;
  for (const int bits : {8, 10, 12, 14, 16}) {
    const int full_scale = (1 << bits) - 1;
    const auto later8 = random_image<std::uint8_t>(kWidth, kHeight, 255);
    const auto later16 = random_image<std::uint16_t>(kWidth, kHeight, full_scale);
    Reference reference(kWidth, kHeight);
    const auto spread = static_cast<float>(full_scale) / 2.0F;
    reference.value.fill([&] { return random_float(spread); });
    reference.gx.fill([&] { return random_float(spread / 2.0F); });
    reference.gy.fill([&] { return random_float(spread / 2.0F); });
    reference.drop_some([&] { return random_int(0, 9) == 0; });
    for (const double fwhm_px : {1.5, 5.0}) {
      const SpeckleKernel& kernel = speckle_kernel(fwhm_px);
      for (const Place& place : places(kWidth, kHeight)) {
        SCOPED_TRACE(place_name(place, kWidth) + ", bits " + std::to_string(bits));
        const Warp warp{.whole_dx_px = place.dx_px,
                        .whole_dy_px = place.dy_px,
                        .bit_depth = bits,
                        .weights_x = fixed(kernel.weights(0.37)),
                        .weights_y = fixed(kernel.weights(0.0)),
                        .six_taps = kernel.has_six_taps(),
                        .gain = 0.93F,
                        .offset_counts = 0.4F * static_cast<float>(full_scale)};
        Scratch scratch(place.region.width_px);
        if (bits == 8) {
          expect_near(residual_sums(reference.planes(), later8.from(0, 0), place.region, warp,
                                    scratch.data()),
                      reference.planes(), later8.from(0, 0), place.region, warp);
        } else {
          expect_near(residual_sums(reference.planes(), later16.from(0, 0), place.region, warp,
                                    scratch.data()),
                      reference.planes(), later16.from(0, 0), place.region, warp);
        }
      }
    }
  }
}

// A checkerboard that agrees with the signs of the weights drives the last sums past 16 bits, both
// ways.
TEST_P(TrackKernelsTest, InterpolationSaturates) {
  constexpr FixedWeights kWeights{0, 2384, -14000, 28000, 28000, -14000, 2384, 0};
  constexpr int kWidth = 64, kHeight = 32;
  const auto bright = [&](int i) { return kWeights[static_cast<std::size_t>(i & 7)] > 0; };
  Image<std::uint8_t> later(kWidth, kHeight, 255);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) later.at(x, y) = bright(x) == bright(y) ? 255 : 0;
  }
  Reference reference(kWidth, kHeight);
  const auto zero = [] { return 0; };
  reference.value.fill(zero), reference.gx.fill(zero), reference.gy.fill(zero);
  const Warp warp{.bit_depth = 8, .weights_x = kWeights, .weights_y = kWeights, .six_taps = true};
  const Region region{4, 4, kWidth - 8, kHeight - 8};
  std::set<int> values;
  for (int y = region.y_px; y < region.y_px + region.height_px; ++y) {
    for (int x = region.x_px; x < region.x_px + region.width_px; ++x)
      values.insert(ref::interpolated(later.from(0, 0), warp, x, y));
  }
  ASSERT_EQ(*values.rbegin(), 32767);
  Scratch scratch(kWidth);
  expect_near(residual_sums(reference.planes(), later.from(0, 0), region, warp, scratch.data()),
              reference.planes(), later.from(0, 0), region, warp);
}

LSV_INSTANTIATE_FOR_EVERY_TARGET(TrackKernelsTest);

// Vectors of another length add up in another order: the last bits tell that other code ran.
TEST(TrackKernelsDispatch, WideVectorsDifferInTheLastBits) {
  const std::vector<std::int64_t> targets = test::all_targets();
  if (std::find(targets.begin(), targets.end(), HWY_AVX2) == targets.end())
    GTEST_SKIP() << "all instruction sets of this machine may add up in the same order";
  std::mt19937 random(5);
  Reference reference(128, 64);
  for (Image<float>* image : {&reference.value, &reference.gx, &reference.gy})
    image->fill([&] { return static_cast<float>(random() % 20001) / 100.0F - 100.0F; });
  const auto sum_on = [&](std::int64_t target) {
    const test::ForcedTarget forced(target);
    Scratch scratch(128);
    return reference_sums(reference.planes(), {4, 4, 120, 56}, scratch.data()).vv;
  };
  const double avx2 = sum_on(HWY_AVX2);
  for (const std::int64_t target : targets) {
    if (target == HWY_AVX2) continue;
    EXPECT_NE(sum_on(target), avx2) << test::target_name(target);
  }
}

}  // namespace
}  // namespace lsv::kernels
