// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/photon_transfer.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <cmath>
#include <string>

namespace lsv {
namespace {

// Residuals this improbable are not chance.
constexpr double kMaxChi2Sigmas = 3.0;
// A slope less certain than this is none.
constexpr double kLeastSigmas = 5.0;

}  // namespace

Result<PhotonTransfer> fit_photon_transfer(const TransferPoint& dark,
                                           const std::vector<TransferPoint>& levels) {
  const auto count = static_cast<Eigen::Index>(levels.size());
  if (count < 2) {
    return Error{ErrorCode::bad_input,
                 "K needs at least two levels of light, there is " + std::to_string(count)};
  }
  Eigen::VectorXd x(count);
  Eigen::VectorXd y(count);
  const double dark_sigma = dark.variance_counts2.sigma;
  Eigen::MatrixXd cov = Eigen::MatrixXd::Constant(count, count, dark_sigma * dark_sigma);
  for (Eigen::Index i = 0; i < count; ++i) {
    const TransferPoint& level = levels[static_cast<std::size_t>(i)];
    x(i) = level.mean_counts.value - dark.mean_counts.value;
    y(i) = level.variance_counts2.value - dark.variance_counts2.value;
    cov(i, i) += level.variance_counts2.sigma * level.variance_counts2.sigma;
  }
  const Eigen::LDLT<Eigen::MatrixXd> inverse(cov);
  const Eigen::VectorXd weighted = inverse.solve(x);
  const double information = weighted.dot(x);
  PhotonTransfer out;
  out.k_counts_per_e.value = weighted.dot(y) / information;
  const Eigen::VectorXd left = y - out.k_counts_per_e.value * x;
  out.chi2 = left.dot(inverse.solve(left));
  out.dof = static_cast<int>(count) - 1;
  const double ratio = out.chi2 / out.dof;
  if (ratio > 1.0 + kMaxChi2Sigmas * std::sqrt(2.0 / out.dof)) out.sigma_factor = std::sqrt(ratio);
  out.k_counts_per_e.sigma = out.sigma_factor / std::sqrt(information);
  if (!(out.k_counts_per_e.value > kLeastSigmas * out.k_counts_per_e.sigma)) {
    return Error{ErrorCode::bad_input,
                 "the noise does not grow with the light, so K cannot be found: give raw frames, "
                 "neither averaged nor compressed nor denoised"};
  }
  return out;
}

}  // namespace lsv
