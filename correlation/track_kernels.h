// SPDX-License-Identifier: BSD-3-Clause
// The inner loops of the tracker over whole regions, on the widest SIMD instruction set of the
// machine at hand, chosen at run time. Scalar truth: track_kernels_ref.h.
//
// Pixel is std::uint8_t or std::uint16_t. Rows are `stride` elements apart. Every image keeps
// kPadding readable elements before and after each row: vectors may reach past the region, what
// they find there does not enter the result. Nothing here allocates.
#pragma once

#include <cstddef>
#include <cstdint>

#include "correlation/speckle_kernel.h"

namespace lsv::kernels {

/// Elements: the longest vector of bytes.
inline constexpr int kPadding = 64;

template <typename T>
struct Plane {
  T* data = nullptr;  // of pixel (0, 0)
  std::ptrdiff_t stride = 0;

  T* at(int x_px, int y_px) const { return data + y_px * stride + x_px; }
};

struct CountSums {
  std::uint64_t sum_counts = 0;
  std::uint64_t sum_squares_counts2 = 0;
  std::uint64_t saturated = 0;  // pixels >= full_scale_counts
};

/// Copies width x height pixels and sums them on the way.
template <typename Pixel>
CountSums copy_and_sum(Plane<const Pixel> from, int width_px, int height_px,
                       Pixel full_scale_counts, Plane<Pixel> to);

/// Pixel sums of a region of the earlier frame and of the nine regions of the later one around it.
/// Counts are `pixel >> drop_bits`, which must not exceed 4095. Exact on every instruction set.
struct LagProducts {
  std::int64_t product[9] = {};  // sum of earlier(x, y) later(x + i, y + j); index 3 (j+1) + (i+1)
  std::int64_t earlier = 0;
  std::int64_t earlier_squares = 0;
  std::int64_t later = 0;  // of the middle region, i = j = 0
  std::int64_t later_squares = 0;
};

/// `earlier` and `later` point at the first pixel of their (middle) regions.
template <typename Pixel>
LagProducts lag_products(Plane<const Pixel> earlier, Plane<const Pixel> later, int width_px,
                         int height_px, int drop_bits);

/// Columns of a half that are looked at, at most.
inline constexpr int kMostProbed_px = 480;
/// Grey values are probed in steps of so many bits for the full scale.
inline constexpr int kProbeBits = 10;

/// Sums over one half of a row: p = gain times the earlier frame, interpolated, less its mean;
/// r = the later frame less its mean and p; gx, gy = differences over two px of the later frame and
/// of gain times the earlier one, added up.
struct ProbeHalf {
  std::int32_t rx = 0, ry = 0;          // of r gx, r gy
  std::int32_t xx = 0, xy = 0, yy = 0;  // of gx gx, gx gy, gy gy
  std::int32_t rr = 0, rp = 0, pp = 0;
  std::int32_t r = 0, p = 0;
};
struct ProbedRow {
  ProbeHalf left, right;
};

inline constexpr int kProbeTaps = 5;
inline constexpr int kProbeReach_px = kProbeTaps / 2;

/// From the earlier to the later frame. Means in steps of kProbeBits.
struct ProbeMap {
  int bit_depth = 8;  // of the pixels
  // By which the earlier frame is interpolated, of pixels -2 .. 2; in 1/32768.
  std::array<std::int16_t, kProbeTaps> weights_x{}, weights_y{};
  std::int16_t gain_2048 = 0;     // in 1/2048
  std::int16_t earlier_mean = 0;  // times the gain
  std::int16_t later_mean = 0;
};

/// Columns of a half. The left one begins at the first column of the region, the right one ends at
/// the last.
constexpr int probe_half_px(int width_px) {
  return width_px / 2 < kMostProbed_px ? width_px / 2 : kMostProbed_px;
}

/// Fills `count` rows, every `step_rows`-th of a region from its first on. `earlier` and `later`
/// point at the first pixel of their regions, around which the earlier frame has kProbeReach_px
/// more on every side and the later one has one. Exact on every instruction set.
template <typename Pixel>
void probe_rows(Plane<const Pixel> earlier, Plane<const Pixel> later, int width_px, int count,
                int step_rows, const ProbeMap& map, ProbedRow* rows);

/// out(x, y) = derivative of `image` along x or along y; see SpeckleKernel::derivative_1_px().
/// `step` is 1 for x, the stride for y. Reads 4 pixels beyond the region on either side.
void derivative(Plane<const float> image, std::ptrdiff_t step, int width_px, int height_px,
                const std::array<float, kGradientReach_px>& weights_1_px, Plane<float> out);

/// In the place of the grey value of a reference pixel that is not to be used.
inline constexpr float kUnused = 1e30F;

/// A reference pattern: grey values about their mean, and gradients. Rows are aligned to 64 bytes.
struct ReferencePlanes {
  Plane<const float> value;  // counts, or kUnused
  Plane<const float> gx;     // counts per px
  Plane<const float> gy;
};

struct Region {
  int x_px = 0;
  int y_px = 0;
  int width_px = 0;
  int height_px = 0;
  friend bool operator==(const Region&, const Region&) = default;
};

/// Sums over the used pixels of a region of the reference: value v, gradients x and y.
struct ReferenceSums {
  double n = 0.0;
  double n_next_row = 0.0;  // used pixels above used pixels
  double v = 0.0, vv = 0.0;
  double x = 0.0, y = 0.0;
  double xv = 0.0, yv = 0.0;
  double xx = 0.0, xy = 0.0, yy = 0.0;
};
/// `scratch` as for residual_sums().
ReferenceSums reference_sums(const ReferencePlanes& reference, const Region& region,
                             float* scratch);

/// Interpolation weights in 1/32768; their sum is 32768 or, where one weight would not fit, 32767.
using FixedWeights = std::array<std::int16_t, kKernelTaps>;
inline constexpr double kFixedOne = 32768.0;

/// Pixels are interpolated as 16-bit numbers that use 14 bits, so that twice as many fit a vector:
/// rounding adds 1/64 count of an 8-bit pixel, and a deeper pixel loses what 14 bits do not hold.
inline constexpr int kFixedPixelBits = 14;

/// How the later frame is compared with the reference: moved back by a whole number of pixels,
/// then interpolated.
struct Warp {
  int whole_dx_px = 0;
  int whole_dy_px = 0;
  int bit_depth = 8;  // of the pixels
  FixedWeights weights_x{};
  FixedWeights weights_y{};
  bool six_taps = false;  // the outermost weights are zero on both axes
  float gain = 1.0F;
  float offset_counts = 0.0F;
};

/// Sums over the used pixels of the residual r = later(x + shift) - gain * v - offset.
struct ResidualSums {
  double r = 0.0, rr = 0.0;
  double rv = 0.0, rx = 0.0, ry = 0.0;
  double rr_next_row = 0.0;  // r(x, y) r(x, y + 1), both used
  // Over every kGradientRowStep-th row, with G = gx^2 + gy^2:
  double few_rr = 0.0, few_g = 0.0, few_rrg = 0.0, few_n = 0.0;
};

inline constexpr int kGradientRowStep = 4;

/// Floats of scratch memory for frames of this width; the memory is aligned to 64 bytes.
std::size_t residual_scratch_size(int width_px);

/// `region` is one of the reference; pixels -3..+4 around it, moved by the whole shift, must lie in
/// the later frame.
template <typename Pixel>
ResidualSums residual_sums(const ReferencePlanes& reference, Plane<const Pixel> later,
                           const Region& region, const Warp& warp, float* scratch);

}  // namespace lsv::kernels
