// SPDX-License-Identifier: BSD-3-Clause
// What the tracker keeps of a frame: TrackFrame, a padded copy of the pixels with their statistics,
// made for every frame; TrackReference, everything that comparing many later frames with one
// earlier frame needs to know about it, made once per keyframe.
#pragma once

#include <cstdint>

#include "correlation/aligned_buffer.h"
#include "correlation/prepared_frame.h"
#include "correlation/speckle_kernel.h"
#include "correlation/track_kernels.h"
#include "lsv/core/frame.h"

namespace lsv {

/// Pixels of a row with room for vectors on both sides.
int padded_stride_px(int width_px);
/// Of all rows.
std::size_t padded_size(const FrameFormat& format);

/// Owns its memory; allocates at construction only.
class TrackFrame {
 public:
  TrackFrame() = default;
  explicit TrackFrame(const FrameFormat& format);

  /// Copies `frame`, which must have the format given at construction and rows that begin on whole
  /// pixels.
  void load(const FrameView& frame);

  const FrameFormat& format() const { return format_; }
  const FrameStats& stats() const { return stats_; }
  /// Valid while this frame lives and is not loaded again; without stamp and index.
  FrameView view() const;
  bool same_pixels(const TrackFrame& other) const;

  template <typename Pixel>
  kernels::Plane<const Pixel> pixels() const {
    return {reinterpret_cast<const Pixel*>(bytes_.data()) + kernels::kPadding, stride_px_};
  }

 private:
  template <typename Pixel>
  void load_pixels(const FrameView& frame);

  FrameFormat format_;
  FrameStats stats_;
  int stride_px_ = 0;
  AlignedBuffer<std::byte> bytes_;
};

/// Owns its memory; allocates at construction only.
class TrackReference {
 public:
  TrackReference() = default;
  explicit TrackReference(const FrameFormat& format);

  /// Grey values about their mean, gradients, and the pixels far enough from saturated ones.
  /// The speckle size along each axis is needed for the weights: full width at half maximum, px.
  void build(const TrackFrame& frame, double fwhm_x_px, double fwhm_y_px);

  /// Differs between any two builds in one program.
  std::uint64_t serial() const { return serial_; }
  double mean_counts() const { return mean_counts_; }
  const SpeckleKernel& kernel_x() const { return *kernel_x_; }
  const SpeckleKernel& kernel_y() const { return *kernel_y_; }
  /// Clipped pixels cannot be interpolated: around them (3 px) the residual is not noise.
  bool has_clipped_pixels() const { return has_clipped_; }

  /// Gradients are valid in columns and rows 4 .. side - 5. `skip_clipped`: see above.
  kernels::ReferencePlanes planes(bool skip_clipped) const;

 private:
  template <typename Pixel>
  void mark_clipped(const TrackFrame& frame);

  FrameFormat format_;
  int stride_px_ = 0;
  std::uint64_t serial_ = 0;
  double mean_counts_ = 0.0;
  bool has_clipped_ = false;
  const SpeckleKernel* kernel_x_ = nullptr;
  const SpeckleKernel* kernel_y_ = nullptr;
  AlignedBuffer<float> value_;
  AlignedBuffer<float> gx_;
  AlignedBuffer<float> gy_;
  AlignedBuffer<float> value_unclipped_;  // kUnused near clipped pixels
  AlignedBuffer<std::uint8_t> clipped_;   // scratch of mark_clipped()
};

}  // namespace lsv
