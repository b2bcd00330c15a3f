// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/integrate.h"

#include <cmath>

namespace lsv {

void Integrator::add(const Displacement& travel) {
  position_.x_m += travel.x_m;
  position_.y_m += travel.y_m;
  variance_x_m2_ += travel.sigma_x_m * travel.sigma_x_m;
  variance_y_m2_ += travel.sigma_y_m * travel.sigma_y_m;
  position_.sigma_x_m = std::sqrt(variance_x_m2_);
  position_.sigma_y_m = std::sqrt(variance_y_m2_);
}

}  // namespace lsv
