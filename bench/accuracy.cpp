// SPDX-License-Identifier: BSD-3-Clause
// How accurate is lsv, beside the methods of OpenCV, on frames whose shift is known?
//   accuracy -o DIR     everything: DIR/accuracy.md and its plots in DIR/accuracy/
//   accuracy --small    lsv only, few pairs: prints a table
// Ends with 1 when a limit that lsv promises is broken, with 2 when something cannot be done.
#include <cstdio>
#include <cstring>
#include <exception>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "bench/accuracy_console.h"
#include "bench/accuracy_limits.h"
#include "bench/accuracy_report.h"
#include "bench/accuracy_run.h"

namespace lsv::bench {
namespace {

AccuracyResults measure_small() {
  AccuracyResults out;
  out.pairs = 40;
  out.cases = measure_cases(out.pairs, Peers::without);
  out.drifts = measure_drifts({{3.0, 0.1}, {4.0, 0.3}}, 2000);
  out.parked = measure_parked(2000);
  return out;
}

AccuracyResults measure_all() {
  AccuracyResults out;
  out.pairs = 500;
  out.cases = measure_cases(out.pairs, Peers::with);
  out.s_curve_pairs = 60;
  out.s_curves = measure_s_curves(out.s_curve_pairs);
  std::vector<Drive> drives;
  for (const double speckle_px : {2.5, 3.0, 4.0})
    for (const double speed_px_per_frame : {0.05, 0.1, 0.3, 0.5})
      drives.push_back({speckle_px, speed_px_per_frame});
  out.drifts = measure_drifts(drives, 10000);
  out.parked = measure_parked(60000);
  return out;
}

int verdict(const AccuracyResults& results, Allowance allowance) {
  const std::vector<std::string> broken = broken_limits(results, allowance);
  std::printf("\n%s\n", broken.empty() ? "every limit holds" : "broken limits:");
  for (const std::string& line : broken) std::printf("  %s\n", line.c_str());
  return broken.empty() ? 0 : 1;
}

int run(const char* folder) {
  cv::setNumThreads(1);
  const bool is_small = folder == nullptr;
  const AccuracyResults results = is_small ? measure_small() : measure_all();
  if (!is_small) write_report(folder, results);
  print_table(stdout, results);
  return verdict(results, is_small ? Allowance::three_sigmas : Allowance::none);
}

}  // namespace
}  // namespace lsv::bench

int main(int argc, char** argv) {
  const bool is_small = argc == 2 && std::strcmp(argv[1], "--small") == 0;
  const bool is_full = argc == 3 && std::strcmp(argv[1], "-o") == 0;
  if (!is_small && !is_full) {
    std::fputs("usage: accuracy -o DIR | accuracy --small\n", stderr);
    return 2;
  }
  try {
    return lsv::bench::run(is_full ? argv[2] : nullptr);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "accuracy: %s\n", error.what());
    return 2;
  }
}
