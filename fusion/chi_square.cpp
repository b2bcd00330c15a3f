// SPDX-License-Identifier: BSD-3-Clause
#include "fusion/chi_square.h"

#include <cmath>
#include <numbers>

namespace lsv {

double chi_square_tail(double value, int dof) {
  const double half = value / 2.0;
  if (dof % 2 == 0) {  // a Poisson sum
    double tail = 0.0, term = std::exp(-half);
    for (int k = 0; 2 * k < dof; ++k) {
      tail += term;
      term *= half / (k + 1);
    }
    return tail;
  }
  // The same in half steps, beginning with the tail of one normal number.
  double tail = std::erfc(std::sqrt(half));
  double term = 2.0 * std::exp(-half) * std::sqrt(half / std::numbers::pi);
  for (int k = 1; 2 * k < dof; ++k) {
    tail += term;
    term *= half / (k + 0.5);
  }
  return tail;
}

double chi_square_limit(double probability, int dof) {
  double low = 0.0, high = 1.0;
  while (chi_square_tail(high, dof) > probability) high *= 2.0;
  while (high - low > 1e-10 * high) {
    const double middle = (low + high) / 2.0;
    (chi_square_tail(middle, dof) > probability ? low : high) = middle;
  }
  return (low + high) / 2.0;
}

}  // namespace lsv
