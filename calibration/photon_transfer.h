// SPDX-License-Identifier: BSD-3-Clause
// The photon transfer of a camera: shot noise grows with the light, and how fast tells how many
// counts an electron makes. EMVA 1288 release 4.0 (linear model), section 2 and 6:
//   sigma_y^2 - sigma_y.dark^2 = K (mu_y - mu_y.dark)
// Pure functions; they allocate.
#pragma once

#include <vector>

#include "calibration/measured.h"
#include "lsv/core/result.h"

namespace lsv {

/// One level of light: mean over pixels and frames, variance over time.
struct TransferPoint {
  Measured mean_counts;       // mu_y
  Measured variance_counts2;  // sigma_y^2
};

struct PhotonTransfer {
  Measured k_counts_per_e;  // K
  double chi2 = kUnknown;
  int dof = 0;
  double sigma_factor = 1.0;  // by which the sigma was raised, the residuals being too large
};

/// K by generalised least squares: the line goes through the dark point, whose error all levels
/// share. bad_input with fewer than two levels, or when the noise does not grow with the light.
Result<PhotonTransfer> fit_photon_transfer(const TransferPoint& dark,
                                           const std::vector<TransferPoint>& levels);

}  // namespace lsv
