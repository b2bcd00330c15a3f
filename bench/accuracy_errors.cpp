// SPDX-License-Identifier: BSD-3-Clause
#include "bench/accuracy_errors.h"

#include <algorithm>
#include <cmath>

namespace lsv::bench {

void Errors::add(const Estimate& estimate, const cli::TrueShift& truth) {
  ++pairs_;
  const double x_px = estimate.shift.dx_px - truth.dx_px;
  const double y_px = estimate.shift.dy_px - truth.dy_px;
  judge(x_px, estimate.sigma_x_px);
  judge(y_px, estimate.sigma_y_px);
  // NaN is no answer.
  if (!(std::abs(x_px) <= kOutlier_px && std::abs(y_px) <= kOutlier_px)) {
    ++outliers_;
    return;
  }
  sum_x_px_ += x_px;
  sum_y_px_ += y_px;
  squares_px2_ += x_px * x_px + y_px * y_px;
  max_px_ = std::max({max_px_, std::abs(x_px), std::abs(y_px)});
}

void Errors::judge(double error_px, double sigma_px) {
  if (std::isnan(error_px) || std::isnan(sigma_px)) return;
  ++judged_;
  if (std::abs(error_px) <= sigma_px) ++within_1_;
  if (std::abs(error_px) <= 1.96 * sigma_px) ++within_196_;
}

double Errors::rmse_px() const {
  return good() > 0 ? std::sqrt(squares_px2_ / (2.0 * good())) : kUnknown;
}
double Errors::bias_x_px() const { return good() > 0 ? sum_x_px_ / good() : kUnknown; }
double Errors::bias_y_px() const { return good() > 0 ? sum_y_px_ / good() : kUnknown; }
double Errors::max_px() const { return good() > 0 ? max_px_ : kUnknown; }

double Errors::share(int count) const {
  return judged_ > 0 ? static_cast<double>(count) / judged_ : kUnknown;
}

}  // namespace lsv::bench
