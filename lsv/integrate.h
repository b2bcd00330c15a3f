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

  /// `travel` of one accepted shift. Its model error adds up as if it had the same sign every time
  /// (true of a steady drive, cautious for others), the rest of its error as independent.
  void add(const Displacement& travel);

 private:
  SensorPosition position_;
  struct Doubt {
    double independent_m2 = 0.0;
    double model_m = 0.0;
  };
  static double grow(Doubt& doubt, double sigma_m, double model_sigma_m);

  Doubt doubt_x_;
  Doubt doubt_y_;
};

}  // namespace lsv
