// SPDX-License-Identifier: BSD-3-Clause
#include "correlation/prepared_frame.h"

#include <cmath>
#include <cstring>

#include "correlation/kernels.h"

namespace lsv {
namespace {

kernels::RowSums sum_row(const FrameView& frame, int y_px) {
  const auto n = static_cast<std::size_t>(frame.width_px());
  const int full_scale = full_scale_counts(frame.format.bit_depth);
  if (frame.format.type == PixelType::mono8)
    return kernels::row_sums(frame.row8(y_px), n, static_cast<std::uint8_t>(full_scale));
  return kernels::row_sums(frame.row16(y_px), n, static_cast<std::uint16_t>(full_scale));
}

void centre_row(const FrameView& frame, int y_px, float mean_counts, float* out) {
  const auto n = static_cast<std::size_t>(frame.width_px());
  if (frame.format.type == PixelType::mono8)
    kernels::centre(frame.row8(y_px), n, mean_counts, out);
  else
    kernels::centre(frame.row16(y_px), n, mean_counts, out);
}

}  // namespace

bool identical_pixels(const PreparedFrame& a, const PreparedFrame& b) {
  if (a.format != b.format || a.stats.mean_counts != b.stats.mean_counts) return false;
  const std::size_t row_bytes = static_cast<std::size_t>(a.format.width_px) * sizeof(float);
  for (int y = 0; y < a.format.height_px; ++y) {
    if (std::memcmp(a.centred_row(y), b.centred_row(y), row_bytes) != 0) return false;
  }
  return true;
}

void centre_frame(const FrameView& frame, PreparedFrame& out, std::span<double> column_sums,
                  std::span<double> column_squares) {
  const int width = frame.width_px();
  const int height = frame.height_px();
  const double n = static_cast<double>(width) * height;
  kernels::RowSums total;
  for (int y = 0; y < height; ++y) {
    const kernels::RowSums row = sum_row(frame, y);
    total.sum_counts += row.sum_counts;
    total.saturated += row.saturated;
  }
  out.format = frame.format;
  out.stats.mean_counts = static_cast<double>(total.sum_counts) / n;
  out.stats.saturated_fraction = static_cast<double>(total.saturated) / n;

  std::fill(column_sums.begin(), column_sums.end(), 0.0);
  std::fill(column_squares.begin(), column_squares.end(), 0.0);
  const auto mean = static_cast<float>(out.stats.mean_counts);
  constexpr int kBlock_rows = 8;  // centred, then summed while they are in the cache
  for (int first = 0; first < height; first += kBlock_rows) {
    const int rows = std::min(kBlock_rows, height - first);
    float* const block = out.centred.data() + static_cast<std::ptrdiff_t>(first) * out.stride_px;
    for (int y = 0; y < rows; ++y)
      centre_row(frame, first + y, mean, block + static_cast<std::ptrdiff_t>(y) * out.stride_px);
    kernels::accumulate_columns(block, out.stride_px, static_cast<std::size_t>(rows),
                                static_cast<std::size_t>(width), 1.0, column_sums.data(),
                                column_squares.data());
  }
  double sum = 0.0;
  double square = 0.0;
  for (std::size_t x = 0; x < static_cast<std::size_t>(width); ++x) {
    sum += column_sums[x];
    square += column_squares[x];
  }
  out.stats.sd_counts = std::sqrt(std::max(0.0, (square - sum * sum / n) / n));
}

OverlapSums::OverlapSums(const FrameFormat& format, const LagRange& lags)
    : format_(format),
      lags_(lags),
      column_sums_(static_cast<std::size_t>(format.width_px)),
      column_squares_(static_cast<std::size_t>(format.width_px)),
      lag_sums_(static_cast<std::size_t>(2 * lags.max_dx_px + 1)),
      lag_squares_(lag_sums_.size()),
      inv_root_cols_(lag_sums_.size()) {
  for (int dx = -lags.max_dx_px; dx <= lags.max_dx_px; ++dx) {
    inv_root_cols_[static_cast<std::size_t>(dx + lags.max_dx_px)] =
        1.0 / std::sqrt(static_cast<double>(format.width_px - std::abs(dx)));
  }
}

OverlapTables OverlapSums::make_tables() const {
  const std::size_t size = lag_sums_.size() * static_cast<std::size_t>(2 * lags_.max_dy_px + 1);
  return {.mean_root = AlignedBuffer<float>(size), .inv_norm = AlignedBuffer<float>(size)};
}

void OverlapSums::fill(std::span<const double> column_sums, std::span<const double> column_squares,
                       PreparedFrame& out) {
  const auto width = static_cast<std::size_t>(format_.width_px);
  full_spread_counts2_ =
      out.stats.sd_counts * out.stats.sd_counts * format_.width_px * format_.height_px;
  for (const int side : {+1, -1}) {
    std::copy_n(column_sums.data(), width, column_sums_.data());
    std::copy_n(column_squares.data(), width, column_squares_.data());
    fill_row(0, out);
    for (int dy = 1; dy <= lags_.max_dy_px; ++dy) {
      const int dropped_row = side > 0 ? dy - 1 : format_.height_px - dy;
      kernels::accumulate_columns(out.centred_row(dropped_row), out.stride_px, 1, width, -1.0,
                                  column_sums_.data(), column_squares_.data());
      fill_row(side * dy, out);
    }
  }
}

void OverlapSums::fill_lags() {
  const auto width = static_cast<std::size_t>(format_.width_px);
  const auto max_dx = static_cast<std::size_t>(lags_.max_dx_px);
  const double sum = kernels::sum(column_sums_.data(), width);
  const double square = kernels::sum(column_squares_.data(), width);
  lag_sums_[max_dx] = sum;
  lag_squares_[max_dx] = square;
  // Of columns [dx, W) and of columns [0, W - dx).
  double right_sum = sum, left_sum = sum, right_square = square, left_square = square;
  for (std::size_t dx = 1; dx <= max_dx; ++dx) {
    lag_sums_[max_dx + dx] = right_sum -= column_sums_[dx - 1];
    lag_sums_[max_dx - dx] = left_sum -= column_sums_[width - dx];
    lag_squares_[max_dx + dx] = right_square -= column_squares_[dx - 1];
    lag_squares_[max_dx - dx] = left_square -= column_squares_[width - dx];
  }
}

void OverlapSums::fill_row(int dy_px, PreparedFrame& out) {
  const int width = format_.width_px;
  fill_lags();
  const int rows_kept = format_.height_px - std::abs(dy_px);
  const std::size_t lag_count = lag_sums_.size();
  const std::size_t at = static_cast<std::size_t>(dy_px + lags_.max_dy_px) * lag_count;
  const double min_spread =
      std::max(kConstantVariance_counts2 * rows_kept * (width - lags_.max_dx_px),
               kMinEnergyFraction * full_spread_counts2_);
  kernels::overlap_terms(lag_sums_.data(), lag_squares_.data(), inv_root_cols_.data(),
                         1.0 / std::sqrt(static_cast<double>(rows_kept)), min_spread, lag_count,
                         out.overlap.mean_root.data() + at, out.overlap.inv_norm.data() + at);
}

}  // namespace lsv
