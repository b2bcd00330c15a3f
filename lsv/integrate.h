// SPDX-License-Identifier: BSD-3-Clause
// Dead reckoning along fixed sensor axes: position is the running sum of the accepted
// displacements, in double (float32 stops advancing near 1 km at 42 um steps). Nothing is added
// for a refused shift: the position is held, never invented.
#pragma once

#include "calibration/scale.h"
#include "lsv/core/motion.h"

namespace lsv {

class Integrator {
 public:
  const SensorPosition& position() const { return position_; }

  /// `travel` of one accepted shift; its error is taken as independent of the others'.
  void add(const Displacement& travel);

 private:
  SensorPosition position_;
  double variance_x_m2_ = 0.0;
  double variance_y_m2_ = 0.0;
};

}  // namespace lsv
