// SPDX-License-Identifier: BSD-3-Clause
// How the pattern turned and grew between two frames, besides shifting.
#pragma once

#include "lsv/core/shift.h"

namespace lsv {

/// NaN unless measured.
struct Deformation {
  /// In the image plane, rad; positive from +x (columns) towards +y (rows).
  double rotation_rad = kUnknown;
  double sigma_rotation_rad = kUnknown;
  /// Relative growth of lengths: the ground came nearer, or the optics make it look so.
  double expansion_ratio = kUnknown;
  double sigma_expansion_ratio = kUnknown;
};

}  // namespace lsv
