// SPDX-License-Identifier: BSD-3-Clause
#include "bench/accuracy_console.h"

#include <string>

#include "bench/accuracy_limits.h"

namespace lsv::bench {
namespace {

void print_case(std::FILE* out, const CaseResult& result) {
  const Errors* e = result.errors_of("precise");
  if (e == nullptr) return;
  const std::optional<double> must_mpx =
      must_rmse_mpx("precise", result.condition->name, result.size);
  std::fprintf(out, "%-5s %4g %9.3f %9.3f %7.2f %9.3f %5d %8.1f %8.1f   ",
               std::string(result.condition->name).c_str(), kSpeckleSizes_px[result.size],
               e->rmse_px() * 1e3, result.bound_px * 1e3, e->rmse_px() / result.bound_px,
               e->max_px() * 1e3, e->outliers(), e->within_1_sigma() * 100.0,
               e->within_196_sigma() * 100.0);
  if (must_mpx)
    std::fprintf(out, "%g\n", *must_mpx);
  else
    std::fputs("-\n", out);
}

}  // namespace

void print_table(std::FILE* out, const AccuracyResults& results) {
  std::fprintf(out, "precise, %d pairs per row, mpx per axis\n", results.pairs);
  std::fprintf(out, "%-5s %4s %9s %9s %7s %9s %5s %8s %8s   %s\n", "cond", "px", "rmse", "bound",
               "ratio", "max", "out", "in 1 s", "in 1.96", "must rmse");
  for (const CaseResult& result : results.cases) print_case(out, result);
  std::fprintf(out, "\n%-8s %12s %8s %12s %8s %12s %8s\n", "drift px", "px/frame", "frames",
               "precise %", "refused", "classic %", "refused");
  for (const DriftResult& drift : results.drifts)
    std::fprintf(out, "%-8g %12g %8d %12.5f %8d %12.5f %8d\n", drift.speckle_px,
                 drift.speed_px_per_frame, drift.frames, drift.precise_error_ratio * 100.0,
                 drift.precise_refused, drift.classic_error_ratio * 100.0, drift.classic_refused);
  const ParkedResult& parked = results.parked;
  std::fprintf(out, "\nparked: %d frames, at most %.5f px from the start, %d moving, %d refused\n",
               parked.frames, parked.farthest_px, parked.frames_moving, parked.refused);
}

}  // namespace lsv::bench
