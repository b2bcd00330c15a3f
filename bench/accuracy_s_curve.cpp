// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <cstdio>
#include <utility>

#include "bench/accuracy_methods.h"
#include "bench/accuracy_pair.h"
#include "bench/accuracy_run.h"

namespace lsv::bench {
namespace {

constexpr int kSteps = 20;  // per px
constexpr int kSizes[] = {0, 1};

/// Adds one point to each curve.
void measure_point(const Condition& condition, double shift_px, int pairs,
                   std::vector<NamedMethod>& methods, SCurve* curves) {
  sim::SpeckleConfig camera = condition.camera;
  camera.speckle_px = kSpeckleSizes_px[curves->size];
  std::vector<double> sum_px(methods.size());
  std::vector<double> squares_px2(methods.size());
  for (int k = 0; k < pairs; ++k) {
    camera.seed = pair_seed(k);
    const SimulatedPair pair = render(camera, {shift_px, 0.0});
    for (std::size_t m = 0; m < methods.size(); ++m) {
      const Estimate found = methods[m].method->measure(pair.earlier.view(), pair.later.view());
      const double error_px = found.shift.dx_px - shift_px;
      sum_px[m] += error_px;
      squares_px2[m] += error_px * error_px;
    }
  }
  for (std::size_t m = 0; m < methods.size(); ++m) {
    const double mean_px = sum_px[m] / pairs;
    const double variance_px2 = squares_px2[m] / pairs - mean_px * mean_px;
    curves[m].shift_px.push_back(shift_px);
    curves[m].bias_px.push_back(mean_px);
    curves[m].standard_error_px.push_back(std::sqrt(variance_px2 / pairs));
  }
}

}  // namespace

std::vector<SCurve> measure_s_curves(int pairs_per_point) {
  const Condition& condition = condition_named("B");
  std::vector<SCurve> out;
  for (const int size : kSizes) {
    std::vector<NamedMethod> methods = lsv_methods(condition);
    methods.push_back(phase_correlate(condition));
    std::vector<SCurve> curves;
    for (const NamedMethod& method : methods)
      curves.push_back({.size = size, .method = method.name});
    for (int step = 0; step <= kSteps; ++step) {
      const double shift_px = static_cast<double>(step) / kSteps;
      std::fprintf(stderr, "accuracy: bias at %g px, speckle of %g px, %d pairs\n", shift_px,
                   kSpeckleSizes_px[size], pairs_per_point);
      measure_point(condition, shift_px, pairs_per_point, methods, curves.data());
    }
    for (SCurve& curve : curves) out.push_back(std::move(curve));
  }
  return out;
}

}  // namespace lsv::bench
