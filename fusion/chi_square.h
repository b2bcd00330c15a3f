// SPDX-License-Identifier: BSD-3-Clause
// The chi-square distribution with a whole number of degrees of freedom, in closed form.
// Pure functions.
#pragma once

namespace lsv {

/// Probability that chi-square with `dof` >= 1 exceeds `value` >= 0.
double chi_square_tail(double value, int dof);

/// The value that is exceeded with `probability`, in (0, 1), to 1e-9.
double chi_square_limit(double probability, int dof);

}  // namespace lsv
