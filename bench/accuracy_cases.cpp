// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>

#include "bench/accuracy_bound.h"
#include "bench/accuracy_methods.h"
#include "bench/accuracy_run.h"

namespace lsv::bench {
namespace {

std::vector<NamedMethod> methods_for(const Condition& condition, Peers peers) {
  std::vector<NamedMethod> out = lsv_methods(condition);
  if (peers == Peers::with)
    for (NamedMethod& peer : opencv_peers(condition)) out.push_back(std::move(peer));
  return out;
}

CaseResult measure(const Condition& condition, int size, int pairs, Peers peers) {
  CaseResult out{.condition = &condition, .size = size};
  const std::vector<NamedMethod> methods = methods_for(condition, peers);
  for (const NamedMethod& method : methods) out.methods.push_back({method.name, {}});
  sim::SpeckleConfig camera = condition.camera;
  camera.speckle_px = kSpeckleSizes_px[size];
  double bound_px2 = 0.0;
  for (int k = 0; k < pairs; ++k) {
    camera.seed = pair_seed(k);
    const SimulatedPair pair = render(camera, true_shift(condition, k));
    const ShiftBound bound = cramer_rao_bound(camera, pair);
    bound_px2 += 0.5 * (bound.xx_px2 + bound.yy_px2) / pairs;
    for (std::size_t m = 0; m < methods.size(); ++m) {
      const Estimate estimate = methods[m].method->measure(pair.earlier.view(), pair.later.view());
      out.methods[m].errors.add(estimate, pair.truth);
    }
  }
  out.bound_px = std::sqrt(bound_px2);
  return out;
}

}  // namespace

std::vector<CaseResult> measure_cases(int pairs, Peers peers) {
  std::vector<CaseResult> out;
  for (const Condition& condition : conditions()) {
    for (int size = 0; size < kSpeckleSizes; ++size) {
      std::fprintf(stderr, "accuracy: condition %s, %g px, %d pairs\n",
                   std::string(condition.name).c_str(), kSpeckleSizes_px[size], pairs);
      out.push_back(measure(condition, size, pairs, peers));
    }
  }
  return out;
}

}  // namespace lsv::bench
