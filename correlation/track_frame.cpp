// SPDX-License-Identifier: BSD-3-Clause
#include "correlation/track_frame.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>

#include "correlation/kernels.h"

namespace lsv {
namespace {

using kernels::kPadding;
using kernels::Plane;

// Clipping leaves harmonics that the weights do not pass; they reach about this far.
constexpr int kClippedReach_px = 3;

}  // namespace

int padded_stride_px(int width_px) { return (width_px + 2 * kPadding + 63) / 64 * 64; }

std::size_t padded_size(const FrameFormat& format) {
  return static_cast<std::size_t>(padded_stride_px(format.width_px)) *
         static_cast<std::size_t>(format.height_px);
}

TrackFrame::TrackFrame(const FrameFormat& format)
    : format_(format),
      stride_px_(padded_stride_px(format.width_px)),
      bytes_(padded_size(format) * bytes_per_pixel(format.type)) {}

void TrackFrame::load(const FrameView& frame) {
  if (format_.type == PixelType::mono8)
    load_pixels<std::uint8_t>(frame);
  else
    load_pixels<std::uint16_t>(frame);
}

template <typename Pixel>
void TrackFrame::load_pixels(const FrameView& frame) {
  const auto full_scale = static_cast<Pixel>(full_scale_counts(format_.bit_depth));
  const Plane<Pixel> to{reinterpret_cast<Pixel*>(bytes_.data()) + kPadding, stride_px_};
  const Plane<const Pixel> from{reinterpret_cast<const Pixel*>(frame.data),
                                frame.stride_bytes / static_cast<std::ptrdiff_t>(sizeof(Pixel))};
  const kernels::CountSums sums =
      kernels::copy_and_sum<Pixel>(from, format_.width_px, format_.height_px, full_scale, to);
  const double n = static_cast<double>(format_.width_px) * format_.height_px;
  stats_.mean_counts = static_cast<double>(sums.sum_counts) / n;
  const double mean_square = static_cast<double>(sums.sum_squares_counts2) / n;
  stats_.sd_counts =
      std::sqrt(std::max(0.0, mean_square - stats_.mean_counts * stats_.mean_counts));
  stats_.saturated_fraction = static_cast<double>(sums.saturated) / n;
}

FrameView TrackFrame::view() const {
  const auto pixel_bytes = static_cast<std::ptrdiff_t>(bytes_per_pixel(format_.type));
  return {.data = bytes_.data() + kPadding * pixel_bytes,
          .stride_bytes = stride_px_ * pixel_bytes,
          .format = format_};
}

bool TrackFrame::same_pixels(const TrackFrame& other) const {
  // The padding is zero in both.
  return bytes_.size() == other.bytes_.size() &&
         std::memcmp(bytes_.data(), other.bytes_.data(), bytes_.size()) == 0;
}

TrackReference::TrackReference(const FrameFormat& format)
    : format_(format),
      stride_px_(padded_stride_px(format.width_px)),
      value_(padded_size(format)),
      gx_(padded_size(format)),
      gy_(padded_size(format)),
      value_unclipped_(padded_size(format)),
      clipped_(padded_size(format)) {}

void TrackReference::build(const TrackFrame& frame, double fwhm_x_px, double fwhm_y_px) {
  static std::atomic<std::uint64_t> builds{0};
  serial_ = ++builds;
  kernel_x_ = &speckle_kernel(fwhm_x_px);
  kernel_y_ = &speckle_kernel(fwhm_y_px);
  mean_counts_ = frame.stats().mean_counts;
  const auto columns = static_cast<std::size_t>(format_.width_px);
  const auto mean = static_cast<float>(mean_counts_);
  const FrameView view = frame.view();
  const Plane<float> value{value_.data() + kPadding, stride_px_};
  for (int y = 0; y < format_.height_px; ++y) {
    if (format_.type == PixelType::mono8)
      kernels::centre(view.row8(y), columns, mean, value.at(0, y));
    else
      kernels::centre(view.row16(y), columns, mean, value.at(0, y));
  }
  constexpr int kReach = kGradientReach_px;
  const int inner_rows = format_.height_px - 2 * kReach;
  kernels::derivative({value.data, value.stride}, 1, format_.width_px, format_.height_px,
                      kernel_x_->derivative_1_px(), {gx_.data() + kPadding, stride_px_});
  kernels::derivative({value.at(0, kReach), value.stride}, value.stride, format_.width_px,
                      inner_rows, kernel_y_->derivative_1_px(),
                      {gy_.data() + kPadding + kReach * stride_px_, stride_px_});
  has_clipped_ = frame.stats().saturated_fraction > 0.0;
  if (!has_clipped_) return;
  if (format_.type == PixelType::mono8)
    mark_clipped<std::uint8_t>(frame);
  else
    mark_clipped<std::uint16_t>(frame);
}

template <typename Pixel>
void TrackReference::mark_clipped(const TrackFrame& frame) {
  const auto full_scale = static_cast<Pixel>(full_scale_counts(format_.bit_depth));
  const Plane<const Pixel> pixels = frame.pixels<Pixel>();
  const int width = format_.width_px;
  const int height = format_.height_px;
  constexpr int kBlock_px = 256;
  // Along the rows first; the padding of a row holds zeros, never full scale.
  for (int y = 0; y < height; ++y) {
    const Pixel* const row = pixels.at(0, y);
    std::uint8_t* const near = clipped_.data() + kPadding + y * stride_px_;
    for (int x = 0; x < width; ++x) {
      std::uint8_t any = 0;
      for (int k = -kClippedReach_px; k <= kClippedReach_px; ++k)
        any |= row[x + k] >= full_scale ? 255 : 0;
      near[x] = any;
    }
  }
  for (int y = 0; y < height; ++y) {
    std::uint8_t any[kBlock_px];
    for (int x0 = 0; x0 < width; x0 += kBlock_px) {
      const int columns = std::min(kBlock_px, width - x0);
      std::fill_n(any, columns, std::uint8_t{0});
      for (int k = std::max(0, y - kClippedReach_px);
           k <= std::min(height - 1, y + kClippedReach_px); ++k) {
        const std::uint8_t* const near = clipped_.data() + kPadding + k * stride_px_ + x0;
        for (int x = 0; x < columns; ++x) any[x] |= near[x];
      }
      const std::ptrdiff_t at = kPadding + std::ptrdiff_t{y} * stride_px_ + x0;
      for (int x = 0; x < columns; ++x)
        value_unclipped_.data()[at + x] = any[x] != 0 ? kernels::kUnused : value_.data()[at + x];
    }
  }
}

kernels::ReferencePlanes TrackReference::planes(bool skip_clipped) const {
  const AlignedBuffer<float>& value = skip_clipped && has_clipped_ ? value_unclipped_ : value_;
  return {.value = {value.data() + kPadding, stride_px_},
          .gx = {gx_.data() + kPadding, stride_px_},
          .gy = {gy_.data() + kPadding, stride_px_}};
}

}  // namespace lsv
