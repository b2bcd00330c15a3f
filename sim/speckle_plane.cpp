// SPDX-License-Identifier: BSD-3-Clause
#include "sim/speckle_plane.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace lsv::sim {
namespace {

/// With s = 2.7 the patch behind a tile is 192 samples wide.
constexpr int kPlaneTileSide = 126;
/// Places are rounded to 1/4096 sample.
constexpr int kPhases = 4096;
constexpr int kBefore = 2;  // taps before the sample below the place
constexpr std::size_t kTilesKept = 64;

/// The aperture ends at 1 / (2 s); its soft edge reaches a little further.
double band_edge(double s) { return 0.52 / s; }

std::int64_t tile_of(std::int64_t sample) {
  return sample >= 0 ? sample / kPlaneTileSide : -((-sample - 1) / kPlaneTileSide) - 1;
}

}  // namespace

SpecklePlane::SpecklePlane(double s, std::uint64_t seed)
    : weights_(tap_weights(kPhases + 1, band_edge(s))),
      field_({kPlaneTileSide, kPlaneTileSide, s}, seed, 1.0) {}

void SpecklePlane::intensity(const PlaneGrid& grid, double* out) {
  load(grid);
  const double first_x = grid.first_x - static_cast<double>(window_column_);
  const double first_y = grid.first_y - static_cast<double>(window_row_);
  for (int row = 0; row < grid.rows; ++row) {
    const double row_x = first_x + row * grid.down_x;
    const double row_y = first_y + row * grid.down_y;
    for (int column = 0; column < grid.columns; ++column)
      *out++ = intensity_at(row_x + column * grid.along_row_x, row_y + column * grid.along_row_y);
  }
}

void SpecklePlane::load(const PlaneGrid& grid) {
  const auto bounds = [](double first, double along, double down) {
    const double low = first + std::min(0.0, along) + std::min(0.0, down);
    const double high = first + std::max(0.0, along) + std::max(0.0, down);
    // One sample more on either side for what rounding does to the outermost places.
    return std::pair{static_cast<std::int64_t>(std::floor(low)) - kBefore - 1,
                     static_cast<std::int64_t>(std::floor(high)) + (kTaps - kBefore) + 1};
  };
  const auto [left, right] =
      bounds(grid.first_x, (grid.columns - 1) * grid.along_row_x, (grid.rows - 1) * grid.down_x);
  const auto [top, bottom] =
      bounds(grid.first_y, (grid.columns - 1) * grid.along_row_y, (grid.rows - 1) * grid.down_y);
  window_column_ = left;
  window_row_ = top;
  window_columns_ = right - left;
  window_rows_ = bottom - top;
  window_.resize(static_cast<std::size_t>(window_columns_ * window_rows_));

  ++calls_;
  std::size_t needed = 0;
  for (std::int64_t j = tile_of(top); j <= tile_of(bottom - 1); ++j) {
    for (std::int64_t i = tile_of(left); i <= tile_of(right - 1); ++i, ++needed)
      copy_from(tile_at({i, j}), {i, j});
  }
  if (tiles_.size() > kTilesKept + needed)
    std::erase_if(tiles_, [&](const auto& entry) { return entry.second.used != calls_; });
}

const SpecklePlane::PlaneTile& SpecklePlane::tile_at(PlaneTileIndex index) {
  PlaneTile& tile = tiles_[index];
  if (tile.field.empty()) {
    std::vector<std::complex<float>> field(std::size_t{kPlaneTileSide} * kPlaneTileSide);
    field_.read(calls_, index.first * kPlaneTileSide, index.second * kPlaneTileSide, field.data());
    tile.field = std::move(field);
  }
  tile.used = calls_;
  return tile;
}

void SpecklePlane::copy_from(const PlaneTile& tile, PlaneTileIndex index) {
  const std::int64_t tile_left = index.first * kPlaneTileSide;
  const std::int64_t tile_top = index.second * kPlaneTileSide;
  const std::int64_t left = std::max(window_column_, tile_left);
  const std::int64_t right = std::min(window_column_ + window_columns_, tile_left + kPlaneTileSide);
  const std::int64_t top = std::max(window_row_, tile_top);
  const std::int64_t bottom = std::min(window_row_ + window_rows_, tile_top + kPlaneTileSide);
  for (std::int64_t row = top; row < bottom; ++row) {
    const auto* from = tile.field.data() + (row - tile_top) * kPlaneTileSide + (left - tile_left);
    std::copy(from, from + (right - left),
              window_.data() + (row - window_row_) * window_columns_ + (left - window_column_));
  }
}

double SpecklePlane::intensity_at(double x, double y) const {
  // Places in the window are positive.
  const auto column = static_cast<std::ptrdiff_t>(x);
  const auto row = static_cast<std::ptrdiff_t>(y);
  const auto phase = [](double fraction) {
    const double nearest = fraction * kPhases + 0.5;
    return static_cast<std::size_t>(nearest);
  };
  const TapWeights& across = weights_[phase(x - static_cast<double>(column))];
  const TapWeights& down = weights_[phase(y - static_cast<double>(row))];
  // Real and imaginary parts side by side, four numbers at a time: with all loops of fixed length
  // the sums stay in registers.
  const auto* from = reinterpret_cast<const float*>(
      window_.data() + (row - kBefore) * window_columns_ + (column - kBefore));
  const std::ptrdiff_t stride = 2 * window_columns_;
  std::array<float, 2 * kTaps> sum;
  for (std::size_t block = 0; block < sum.size(); block += 4) {
    std::array<float, 4> part{};
    for (std::size_t j = 0; j < kTaps; ++j) {
      const float* const four = from + static_cast<std::ptrdiff_t>(j) * stride + block;
      for (std::size_t k = 0; k < 4; ++k) part[k] += down[j] * four[k];
    }
    for (std::size_t k = 0; k < 4; ++k) sum[block + k] = part[k];
  }
  float real = 0.0F;
  float imaginary = 0.0F;
  for (std::size_t k = 0; k < kTaps; ++k) {
    real += across[k] * sum[2 * k];
    imaginary += across[k] * sum[2 * k + 1];
  }
  return static_cast<double>(real) * real + static_cast<double>(imaginary) * imaginary;
}

}  // namespace lsv::sim
