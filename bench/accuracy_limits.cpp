// SPDX-License-Identifier: BSD-3-Clause
#include "bench/accuracy_limits.h"

#include <cmath>
#include <utility>

#include "bench/accuracy_text.h"
#include "lsv/output/number_text.h"

namespace lsv::bench {
namespace {

struct RmseLimit {
  std::string_view method;
  std::string_view condition;
  double rmse_mpx[kSpeckleSizes];
};

constexpr RmseLimit kMustRmse[] = {
    {"precise", "A", {0.30, 0.45, 0.95}},  {"precise", "B", {0.40, 0.55, 1.0}},
    {"precise", "C32", {0.50, 0.70, 1.2}}, {"precise", "E", {0.6, 0.8, 1.5}},
    {"precise", "F", {3.1, 4.0, 6.0}},     {"precise", "D90", {15.5, 26.0, 58.0}},
    {"fast", "B", {3.0, 3.5, 5.0}},
};
constexpr double kAimFastB_mpx = 2.0;

std::string name_of(const CaseResult& result, std::string_view method) {
  return formatted("%s, condition %s, speckle of %g px", std::string(method).c_str(),
                   std::string(result.condition->name).c_str(), kSpeckleSizes_px[result.size]);
}

void check_rmse(const CaseResult& result, const MethodErrors& entry, double sigmas,
                std::vector<std::string>& broken) {
  const std::optional<double> limit_mpx =
      must_rmse_mpx(entry.method, result.condition->name, result.size);
  if (!limit_mpx) return;
  // The RMSE of n errors is known to 1 / sqrt(2 n), and each pair gives two.
  const double chance = sigmas / std::sqrt(4.0 * entry.errors.pairs());
  const double rmse_mpx = entry.errors.rmse_px() * 1e3;
  if (!(rmse_mpx <= *limit_mpx * (1.0 + chance)))
    broken.push_back(formatted("%s: RMSE %.3g mpx, Must %.3g",
                               name_of(result, entry.method).c_str(), rmse_mpx, *limit_mpx));
}

void check_coverage(const CaseResult& result, const char* what, double value, double nominal,
                    double margin, double sigmas, std::vector<std::string>& broken) {
  const int judged = result.errors_of("precise")->judged();
  const double chance = sigmas * std::sqrt(nominal * (1.0 - nominal) / judged);
  if (!(std::abs(value - nominal) <= margin + chance))
    broken.push_back(formatted("%s: %.1f %% within %s sigma, Must %.0f +- %.0f %%",
                               name_of(result, "precise").c_str(), value * 100.0, what,
                               nominal * 100.0, margin * 100.0));
}

}  // namespace

std::optional<double> must_rmse_mpx(std::string_view method, std::string_view condition, int size) {
  for (const RmseLimit& limit : kMustRmse)
    if (limit.method == method && limit.condition == condition) return limit.rmse_mpx[size];
  return {};
}

std::optional<double> aim_rmse_mpx(const AccuracyResults& results, std::string_view method,
                                   const CaseResult& of) {
  const std::string_view condition = of.condition->name;
  if (method == "fast" && condition == "B") return kAimFastB_mpx;
  if (method != "precise") return {};
  if (condition == "A" || condition == "B") return 1.5 * of.bound_px * 1e3;
  if (condition == "F") return 1.05 * of.bound_px * 1e3;
  if (condition == "E" || condition == "C32") {
    const CaseResult* b = results.find("B", of.size);
    if (b != nullptr) return 1.5 * b->bound_px * 1e3;
  }
  return {};
}

bool must_have_no_outliers(std::string_view condition) { return condition != "D70"; }

std::vector<std::string> broken_limits(const CaseResult& result, Allowance allowance) {
  const double sigmas = allowance == Allowance::three_sigmas ? 3.0 : 0.0;
  std::vector<std::string> broken;
  for (const MethodErrors& entry : result.methods) check_rmse(result, entry, sigmas, broken);
  const Errors* precise = result.errors_of("precise");
  if (precise == nullptr) return broken;
  if (must_have_no_outliers(result.condition->name) && precise->outliers() > 0)
    broken.push_back(formatted("%s: %d of %d pairs are outliers, Must 0",
                               name_of(result, "precise").c_str(), precise->outliers(),
                               precise->pairs()));
  check_coverage(result, "1", precise->within_1_sigma(), kMustWithin1, kMustWithin1Margin, sigmas,
                 broken);
  check_coverage(result, "1.96", precise->within_196_sigma(), kMustWithin196, kMustWithin196Margin,
                 sigmas, broken);
  return broken;
}

std::vector<std::string> broken_limits(const AccuracyResults& results, Allowance allowance) {
  std::vector<std::string> broken;
  for (const CaseResult& result : results.cases)
    for (std::string& line : broken_limits(result, allowance)) broken.push_back(std::move(line));
  for (const DriftResult& drift : results.drifts) {
    if (!(std::abs(drift.precise_error_ratio) <= kMustDriftRatio))
      broken.push_back(formatted(
          "precise, speckle of %g px at %g px per frame: distance wrong by %.4f %%, Must %.2f",
          drift.speckle_px, drift.speed_px_per_frame, drift.precise_error_ratio * 100.0,
          kMustDriftRatio * 100.0));
  }
  const ParkedResult& parked = results.parked;
  if (!(parked.farthest_px <= kMustParked_px))
    broken.push_back(formatted("precise, parked: %.4f px from the start, Must %.3f",
                               parked.farthest_px, kMustParked_px));
  if (parked.frames_moving > 0)
    broken.push_back(formatted("precise, parked: %d of %d frames reported as moving, Must 0",
                               parked.frames_moving, parked.frames));
  return broken;
}

}  // namespace lsv::bench
