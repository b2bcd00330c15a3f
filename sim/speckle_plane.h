// SPDX-License-Identifier: BSD-3-Clause
// The speckle field at any places of an unbounded plane, fast: tiles of SpeckleField on its lattice
// of one sample, made where they are needed, and interpolated in between (tap_weights.h).
// The value at a place does not depend on what was asked before.
// Allocates where new ground is seen; forgets tiles, which can be made again. One thread at a time.
// Throws std::bad_alloc and cv::Exception (memory only).
#pragma once

#include <complex>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "sim/speckle_field.h"
#include "sim/tap_weights.h"

namespace lsv::sim {

/// A straight-line grid of places: first + column * along_row + row * down, in samples.
struct PlaneGrid {
  int columns = 0;
  int rows = 0;
  double first_x = 0.0, first_y = 0.0;
  double along_row_x = 0.0, along_row_y = 0.0;
  double down_x = 0.0, down_y = 0.0;
};

class SpecklePlane {
 public:
  /// Aperture scale `s` in samples (speckle_optics.h), at least 2.7.
  SpecklePlane(double s, std::uint64_t seed);

  /// Writes |field|^2 (mean 1) at the places of `grid`, row-major.
  void intensity(const PlaneGrid& grid, double* out);

 private:
  struct PlaneTile {
    std::int64_t used = 0;  // number of the last call that needed it
    std::vector<std::complex<float>> field;
  };
  using PlaneTileIndex = std::pair<std::int64_t, std::int64_t>;  // column, row of the tile

  void load(const PlaneGrid& grid);
  const PlaneTile& tile_at(PlaneTileIndex index);
  void copy_from(const PlaneTile& tile, PlaneTileIndex index);
  double intensity_at(double x, double y) const;

  std::vector<TapWeights> weights_;
  SpeckleField field_;
  std::map<PlaneTileIndex, PlaneTile> tiles_;
  std::int64_t calls_ = 0;

  // The samples around the grid, contiguous.
  std::int64_t window_column_ = 0;
  std::int64_t window_row_ = 0;
  std::int64_t window_columns_ = 0;
  std::int64_t window_rows_ = 0;
  std::vector<std::complex<float>> window_;
};

}  // namespace lsv::sim
