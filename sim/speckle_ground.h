// SPDX-License-Identifier: BSD-3-Clause
// The rough ground: an unbounded square lattice of independent complex circular normal numbers
// with E|g|^2 = 1, drawn from (seed, column, row) so that it never repeats and needs no storage
// before it is seen. Boiling: from frame to frame each site follows the first-order
// autoregression g(k) = c g(k-1) + sqrt(1 - c^2) w(k); n unseen frames are skipped in one step,
// c^n g + sqrt(1 - c^2n) w. Columns and rows are taken modulo 2^32.
// Owns the tiles it has drawn and allocates when new ground is seen; forgets tiles that can be
// drawn again (no boiling) or of which less than 1e-6 of the field is left. One thread at a time.
#pragma once

#include <array>
#include <complex>
#include <cstdint>
#include <map>
#include <utility>

namespace lsv::sim {

class SpeckleGround {
 public:
  /// `field_correlation` c of a site between consecutive frames, [0, 1]; 1 = no boiling.
  SpeckleGround(std::uint64_t seed, double field_correlation);

  /// Writes the sites [column, column + columns) x [row, row + rows) as they are at `frame`,
  /// row-major and without gaps. With boiling, `frame` must not decrease from call to call.
  void read(std::int64_t column, std::int64_t row, int columns, int rows, std::int64_t frame,
            std::complex<double>* out);

  bool boils() const { return field_correlation_ < 1.0; }

 private:
  static constexpr int kTileSide = 32;
  struct Tile {
    std::int64_t frame = 0;  // the frame its values belong to
    std::array<std::complex<double>, kTileSide * kTileSide> sites;
  };
  using TileIndex = std::pair<std::int64_t, std::int64_t>;  // column, row of the tile

  const Tile& tile_at(TileIndex index, std::int64_t frame);
  void draw(TileIndex index, std::int64_t frame, Tile& tile) const;
  void advance(TileIndex index, std::int64_t frame, Tile& tile) const;
  void forget_tiles(std::int64_t frame);

  std::uint64_t seed_;
  double field_correlation_;
  std::map<TileIndex, Tile> tiles_;
};

}  // namespace lsv::sim
