// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/path.h"

#include <algorithm>

namespace lsv {

void Path::add(const Shift& shift) {
  x_px_ += shift.dx_px;
  y_px_ += shift.dy_px;
  const double model_x = shift.model_sigma_x_px;
  const double model_y = shift.model_sigma_y_px;
  independent_.xx_px2 += std::max(0.0, shift.cov.xx_px2 - model_x * model_x);
  independent_.xy_px2 += shift.cov.xy_px2;
  independent_.yy_px2 += std::max(0.0, shift.cov.yy_px2 - model_y * model_y);
  model_x_px_ += model_x;
  model_y_px_ += model_y;
}

ShiftCovariance Path::cov() const {
  return {independent_.xx_px2 + model_x_px_ * model_x_px_, independent_.xy_px2,
          independent_.yy_px2 + model_y_px_ * model_y_px_};
}

}  // namespace lsv
