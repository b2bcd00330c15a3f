// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/pixel_statistics.h"

#include <new>
#include <string>

namespace lsv {

Result<PixelStatistics> PixelStatistics::create(const FrameFormat& format) {
  const std::string size =
      std::to_string(format.width_px) + " x " + std::to_string(format.height_px) + " px";
  if (!is_possible(format))
    return Error{ErrorCode::invalid_argument, "frames of " + size + " are not possible"};
  try {
    return PixelStatistics(format);
  } catch (const std::bad_alloc&) {
    return Error{ErrorCode::invalid_argument, "there is not enough memory for frames of " + size};
  }
}

PixelStatistics::PixelStatistics(const FrameFormat& format)
    : format_(format),
      mean_(static_cast<std::size_t>(format.width_px) * static_cast<std::size_t>(format.height_px)),
      squares_(mean_.size()),
      zeros_(mean_.size()),
      full_(mean_.size()) {}

Result<void> PixelStatistics::add(const FrameView& frame) {
  if (frame.format != format_) {
    return Error{ErrorCode::invalid_argument, "frame " + std::to_string(frame.index) +
                                                  " is of another format than those before"};
  }
  ++frames_;
  const double mean = frame.format.type == PixelType::mono8 ? accumulate<std::uint8_t>(frame)
                                                            : accumulate<std::uint16_t>(frame);
  const double step = mean - frame_mean_;
  frame_mean_ += step / static_cast<double>(frames_);
  frame_squares_ += step * (mean - frame_mean_);
  return {};
}

/// The mean of the frame.
template <typename Pixel>
double PixelStatistics::accumulate(const FrameView& frame) {
  const double share = 1.0 / static_cast<double>(frames_);
  const auto full_scale = static_cast<Pixel>(full_scale_counts(format_.bit_depth));
  const auto width = static_cast<std::size_t>(format_.width_px);
  std::uint64_t sum = 0;
  for (int y = 0; y < format_.height_px; ++y) {
    const auto* const row = reinterpret_cast<const Pixel*>(frame.data + y * frame.stride_bytes);
    const std::size_t first = static_cast<std::size_t>(y) * width;
    for (std::size_t x = 0; x < width; ++x) {
      const Pixel count = row[x];
      const double step = count - mean_[first + x];
      mean_[first + x] += step * share;
      squares_[first + x] += step * (count - mean_[first + x]);
      zeros_[first + x] += count == 0 ? 1U : 0U;
      full_[first + x] += count >= full_scale ? 1U : 0U;
      sum += count;
    }
  }
  return static_cast<double>(sum) / static_cast<double>(mean_.size());
}

}  // namespace lsv
