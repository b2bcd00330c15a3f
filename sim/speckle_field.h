// SPDX-License-Identifier: BSD-3-Clause
// Fully developed speckle as one fixed function of ground position: the lattice of SpeckleGround
// convolved with the point spread of the aperture. The point spread has no content at the
// sampling limit of the lattice (below 1e-6), so that a shift of the pattern by any fraction of a
// pixel is exact: it is a phase ramp on the discrete Fourier transform of a patch of lattice.
// Owns its work buffers, allocates at construction and where the ground does; one thread at a
// time. Throws std::bad_alloc and cv::Exception (memory only): SpeckleCamera is the boundary.
#pragma once

#include <complex>
#include <cstdint>
#include <vector>

#include "sim/speckle_ground.h"

namespace lsv::sim {

/// The sampling grid: sample (c, r) lies at ground position origin + (c, r), in samples.
struct FieldGeometry {
  int columns = 0;
  int rows = 0;
  double s = 0.0;  // aperture scale lambda z / D in samples, see speckle_optics.h
};

/// Side of the lattice patch that `samples` of field need along one axis.
int patch_side(int samples, double s);

class SpeckleField {
 public:
  SpeckleField(const FieldGeometry& geometry, std::uint64_t seed, double field_correlation);

  /// Adds weight * |field|^2 (mean 1) to `sum`, columns * rows values, row-major. The first
  /// sample lies at ground position (x, y), in samples.
  void add_intensity(std::int64_t frame, double x, double y, double weight, double* sum);

  /// The field itself (E|field|^2 = 1), columns * rows values, row-major. The first sample lies on
  /// the lattice site (column, row).
  void read(std::int64_t frame, std::int64_t column, std::int64_t row, std::complex<float>* out);

 private:
  /// Leaves the samples asked for in the top left of field_.
  void transform(std::int64_t frame, double x, double y);
  void load_patch(std::int64_t frame, std::int64_t column, std::int64_t row);
  void fill_transfer();

  FieldGeometry geometry_;
  int margin_ = 0;
  int patch_columns_ = 0;
  int patch_rows_ = 0;
  SpeckleGround ground_;
  std::vector<double> transfer_;                // of the point spread, per patch frequency
  std::vector<std::complex<double>> spectrum_;  // of the lattice patch
  std::vector<std::complex<double>> field_;
  std::vector<std::complex<double>> ramp_x_;
  std::vector<std::complex<double>> ramp_y_;

  bool loaded_ = false;  // spectrum_ holds the patch at:
  std::int64_t loaded_frame_ = 0;
  std::int64_t loaded_column_ = 0;
  std::int64_t loaded_row_ = 0;
};

}  // namespace lsv::sim
