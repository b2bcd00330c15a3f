// SPDX-License-Identifier: BSD-3-Clause
#include "bench/accuracy_text.h"

#include <cmath>

#include "lsv/output/number_text.h"

namespace lsv::bench {

std::string three_digits(double value) {
  if (std::isnan(value)) return "-";
  const double size = std::abs(value);
  const int decimals = size >= 100.0 ? 0 : size >= 10.0 ? 1 : size >= 1.0 ? 2 : 3;
  return formatted("%.*f", decimals, value);
}

}  // namespace lsv::bench
