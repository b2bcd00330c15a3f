// SPDX-License-Identifier: BSD-3-Clause
// A number with its uncertainty, and how that is passed on to first order.
#pragma once

#include <algorithm>
#include <cmath>

#include "lsv/core/shift.h"

namespace lsv {

/// With one standard deviation.
struct Measured {
  double value = kUnknown;
  double sigma = kUnknown;
};

/// Independent of each other.
inline Measured operator-(const Measured& a, const Measured& b) {
  return {a.value - b.value, std::hypot(a.sigma, b.sigma)};
}
inline Measured operator/(const Measured& a, const Measured& b) {
  const double value = a.value / b.value;
  return {value, std::hypot(a.sigma, value * b.sigma) / std::abs(b.value)};
}

/// The root of a square, 0 where that is below. Two sigma reach to the further of the roots of the
/// square more and less two of its own: far from 0 that is the usual sigma, and near 0 still
/// honest.
inline Measured root_of(const Measured& square) {
  const auto root = [](double value) { return std::sqrt(std::max(value, 0.0)); };
  const double value = root(square.value);
  const double above = root(std::max(square.value, 0.0) + 2.0 * square.sigma) - value;
  const double below = value - root(square.value - 2.0 * square.sigma);
  return {value, 0.5 * std::max(above, below)};
}

}  // namespace lsv
