// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/integrate.h"

#include <algorithm>
#include <cmath>

namespace lsv {

void Integrator::add(const Displacement& travel) {
  position_.x_m += travel.x_m;
  position_.y_m += travel.y_m;
  position_.sigma_x_m = grow(doubt_x_, travel.sigma_x_m, travel.model_sigma_x_m);
  position_.sigma_y_m = grow(doubt_y_, travel.sigma_y_m, travel.model_sigma_y_m);
}

double Integrator::grow(Doubt& doubt, double sigma_m, double model_sigma_m) {
  doubt.independent_m2 += std::max(0.0, sigma_m * sigma_m - model_sigma_m * model_sigma_m);
  doubt.model_m += model_sigma_m;
  return std::sqrt(doubt.independent_m2 + doubt.model_m * doubt.model_m);
}

}  // namespace lsv
