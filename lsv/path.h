// SPDX-License-Identifier: BSD-3-Clause
// Dead reckoning from independent shifts: the running sum in px, in double (float32 stops advancing
// at 2^24 steps), and what is not known about it.
#pragma once

#include "lsv/core/shift.h"

namespace lsv {

class Path {
 public:
  /// One accepted shift. Its model error adds up as if it had the same sign every time (true of a
  /// steady drive, cautious for others), the rest of its error as independent.
  void add(const Shift& shift);

  double x_px() const { return x_px_; }
  double y_px() const { return y_px_; }
  ShiftCovariance cov() const;

 private:
  double x_px_ = 0.0;
  double y_px_ = 0.0;
  ShiftCovariance independent_{0.0, 0.0, 0.0};
  double model_x_px_ = 0.0;
  double model_y_px_ = 0.0;
};

}  // namespace lsv
