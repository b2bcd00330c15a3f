// SPDX-License-Identifier: BSD-3-Clause
#include "sim/speckle_ground.h"

#include <algorithm>
#include <cmath>

#include "sim/philox.h"

namespace lsv::sim {
namespace {

constexpr double kForgottenCorrelation = 1e-6;

std::int64_t floor_divide(std::int64_t a, std::int64_t b) { return a / b - (a % b < 0 ? 1 : 0); }

}  // namespace

SpeckleGround::SpeckleGround(std::uint64_t seed, double field_correlation)
    : seed_(seed), field_correlation_(field_correlation) {}

void SpeckleGround::read(std::int64_t column, std::int64_t row, int columns, int rows,
                         std::int64_t frame, std::complex<double>* out) {
  const std::int64_t column_end = column + columns;
  const std::int64_t row_end = row + rows;
  const std::int64_t tile_column_end = floor_divide(column_end - 1, kTileSide) + 1;
  const std::int64_t tile_row_end = floor_divide(row_end - 1, kTileSide) + 1;
  std::size_t tiles_seen = 0;
  for (std::int64_t tj = floor_divide(row, kTileSide); tj < tile_row_end; ++tj) {
    for (std::int64_t ti = floor_divide(column, kTileSide); ti < tile_column_end; ++ti) {
      const Tile& tile = tile_at({ti, tj}, frame);
      const std::int64_t left = std::max(column, ti * kTileSide);
      const std::int64_t right = std::min(column_end, (ti + 1) * kTileSide);
      const std::int64_t top = std::max(row, tj * kTileSide);
      const std::int64_t bottom = std::min(row_end, (tj + 1) * kTileSide);
      for (std::int64_t j = top; j < bottom; ++j) {
        const auto* source = tile.sites.data() + (j - tj * kTileSide) * kTileSide;
        std::copy(source + (left - ti * kTileSide), source + (right - ti * kTileSide),
                  out + (j - row) * columns + (left - column));
      }
      ++tiles_seen;
    }
  }
  if (tiles_.size() > 4 * tiles_seen) forget_tiles(frame);
}

const SpeckleGround::Tile& SpeckleGround::tile_at(TileIndex index, std::int64_t frame) {
  const auto [entry, is_new] = tiles_.try_emplace(index);
  Tile& tile = entry->second;
  if (is_new) {
    draw(index, frame, tile);
  } else if (boils() && frame != tile.frame) {
    advance(index, frame, tile);
  }
  tile.frame = frame;
  return tile;
}

void SpeckleGround::draw(TileIndex index, std::int64_t frame, Tile& tile) const {
  // Ground that has boiled away and is seen again is new ground, so its draw depends on the frame.
  const std::int64_t draw_number = boils() ? frame : 0;
  const auto [ti, tj] = index;
  auto* site = tile.sites.data();
  for (int j = 0; j < kTileSide; ++j) {
    for (int i = 0; i < kTileSide; ++i) {
      *site++ = complex_normal(seed_, Stream::ground, ti * kTileSide + i, tj * kTileSide + j,
                               draw_number);
    }
  }
}

void SpeckleGround::advance(TileIndex index, std::int64_t frame, Tile& tile) const {
  const double kept = std::pow(field_correlation_, static_cast<double>(frame - tile.frame));
  const double fresh = std::sqrt(1.0 - kept * kept);
  const auto [ti, tj] = index;
  auto* site = tile.sites.data();
  for (int j = 0; j < kTileSide; ++j) {
    for (int i = 0; i < kTileSide; ++i, ++site) {
      *site = kept * *site + fresh * complex_normal(seed_, Stream::boiling, ti * kTileSide + i,
                                                    tj * kTileSide + j, frame);
    }
  }
}

void SpeckleGround::forget_tiles(std::int64_t frame) {
  std::erase_if(tiles_, [&](const auto& entry) {
    const auto age = static_cast<double>(frame - entry.second.frame);
    if (!boils()) return age != 0.0;
    return std::pow(field_correlation_, age) < kForgottenCorrelation;
  });
}

}  // namespace lsv::sim
