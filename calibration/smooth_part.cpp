// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/smooth_part.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstddef>

namespace lsv {
namespace {

constexpr int kDegree = 4;
constexpr int kTerms = (kDegree + 1) * (kDegree + 2) / 2;
using Terms = Eigen::Matrix<double, kTerms, 1>;

// Box 7, box 11 and binomial 3, one after the other, along one axis.
constexpr int kReach_px = 9;
constexpr int kTaps = 2 * kReach_px + 1;
using Kernel = std::array<double, kTaps>;

template <std::size_t kWidth>
Kernel convolved(const Kernel& kernel, const std::array<double, kWidth>& with) {
  Kernel out{};
  const int reach = static_cast<int>(kWidth / 2);
  for (int i = 0; i < kTaps; ++i) {
    for (int k = -reach; k <= reach; ++k) {
      if (i + k < 0 || i + k >= kTaps) continue;
      out[static_cast<std::size_t>(i)] +=
          kernel[static_cast<std::size_t>(i + k)] * with[static_cast<std::size_t>(k + reach)];
    }
  }
  return out;
}

template <std::size_t kWidth>
std::array<double, kWidth> box() {
  std::array<double, kWidth> out{};
  out.fill(1.0 / static_cast<double>(kWidth));
  return out;
}

Kernel low_pass_kernel() {
  Kernel one{};
  one[kReach_px] = 1.0;
  return convolved(convolved(convolved(one, box<7>()), box<11>()),
                   std::array<double, 3>{0.25, 0.5, 0.25});
}

/// -1 to 1 over the side.
double coordinate(int at_px, int side_px) {
  return side_px > 1 ? 2.0 * at_px / (side_px - 1) - 1.0 : 0.0;
}

Terms terms_at(double x, double y) {
  Terms out;
  int n = 0;
  double x_power = 1.0;
  for (int i = 0; i <= kDegree; ++i, x_power *= x) {
    double y_power = 1.0;
    for (int j = 0; i + j <= kDegree; ++j, y_power *= y) out(n++) = x_power * y_power;
  }
  return out;
}

/// Calls `each`(index, terms) for every pixel.
template <typename Each>
void for_each_pixel(int width_px, int height_px, Each each) {
  std::size_t i = 0;
  for (int y = 0; y < height_px; ++y) {
    for (int x = 0; x < width_px; ++x)
      each(i++, terms_at(coordinate(x, width_px), coordinate(y, height_px)));
  }
}

std::vector<double> polynomial(const std::vector<double>& values,
                               const std::vector<std::uint8_t>& defect, int width_px,
                               int height_px) {
  Eigen::Matrix<double, kTerms, kTerms> normal = Eigen::Matrix<double, kTerms, kTerms>::Zero();
  Terms right = Terms::Zero();
  for_each_pixel(width_px, height_px, [&](std::size_t i, const Terms& terms) {
    if (defect[i] != 0) return;
    normal.selfadjointView<Eigen::Lower>().rankUpdate(terms);
    right += values[i] * terms;
  });
  const Terms solution = normal.selfadjointView<Eigen::Lower>().ldlt().solve(right);
  std::vector<double> out(values.size());
  for_each_pixel(width_px, height_px,
                 [&](std::size_t i, const Terms& terms) { out[i] = solution.dot(terms); });
  return out;
}

/// One row or column at a time; zero outside.
std::vector<double> filtered(const std::vector<double>& values, const Kernel& kernel, int width_px,
                             int height_px) {
  const auto pass = [&kernel](const std::vector<double>& from, int length, std::ptrdiff_t stride,
                              int lines, std::ptrdiff_t line_stride) {
    std::vector<double> to(from.size());
    for (int line = 0; line < lines; ++line) {
      const std::ptrdiff_t first = line * line_stride;
      for (int at = 0; at < length; ++at) {
        double sum = 0.0;
        for (int k = std::max(0, at - kReach_px); k <= std::min(length - 1, at + kReach_px); ++k)
          sum += kernel[static_cast<std::size_t>(k - at + kReach_px)] *
                 from[static_cast<std::size_t>(first + k * stride)];
        to[static_cast<std::size_t>(first + at * stride)] = sum;
      }
    }
    return to;
  };
  return pass(pass(values, width_px, 1, height_px, width_px), height_px, width_px, width_px, 1);
}

}  // namespace

std::vector<double> smooth_part(const std::vector<double>& values,
                                const std::vector<std::uint8_t>& defect, int width_px,
                                int height_px) {
  std::vector<double> out = polynomial(values, defect, width_px, height_px);
  std::vector<double> rest(values.size());
  std::vector<double> weight(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (defect[i] != 0) continue;
    rest[i] = values[i] - out[i];
    weight[i] = 1.0;
  }
  const Kernel kernel = low_pass_kernel();
  rest = filtered(rest, kernel, width_px, height_px);
  weight = filtered(weight, kernel, width_px, height_px);
  for (std::size_t i = 0; i < out.size(); ++i) {
    if (weight[i] > 0.0) out[i] += rest[i] / weight[i];
  }
  return out;
}

double high_pass_gain() {
  const Kernel kernel = low_pass_kernel();
  double squares = 0.0;
  for (const double tap : kernel) squares += tap * tap;
  return std::sqrt(1.0 - 2.0 * kernel[kReach_px] * kernel[kReach_px] + squares * squares);
}

}  // namespace lsv
