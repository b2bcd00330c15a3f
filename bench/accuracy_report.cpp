// SPDX-License-Identifier: BSD-3-Clause
#include "bench/accuracy_report.h"

#include <filesystem>
#include <fstream>
#include <opencv2/core/version.hpp>
#include <stdexcept>

#include "bench/accuracy_limits.h"
#include "bench/accuracy_plots.h"
#include "bench/accuracy_tables.h"
#include "bench/accuracy_text.h"
#include "bench/frames.h"
#include "lsv/output/number_text.h"

namespace lsv::bench {
namespace {

void write_file(const std::filesystem::path& path, const std::string& content) {
  std::ofstream file(path, std::ios::binary);
  file << content;
  file.close();
  if (!file) throw std::runtime_error("cannot write " + path.string());
}

std::string bullets(const std::vector<std::string>& lines, const char* none) {
  if (lines.empty()) return std::string(none) + "\n";
  std::string out;
  for (const std::string& line : lines) out.append("- ").append(line).append("\n");
  return out;
}

std::vector<std::string> missed_aims(const AccuracyResults& results) {
  std::vector<std::string> out;
  for (const CaseResult& result : results.cases) {
    for (const MethodErrors& entry : result.methods) {
      const std::optional<double> aim_mpx = aim_rmse_mpx(results, entry.method, result);
      const double rmse_mpx = entry.errors.rmse_px() * 1e3;
      if (!aim_mpx || rmse_mpx <= *aim_mpx) continue;
      out.push_back(formatted("%s, condition %s, speckle of %g px: RMSE %s mpx, Aim %s",
                              std::string(entry.method).c_str(),
                              std::string(result.condition->name).c_str(),
                              kSpeckleSizes_px[result.size], three_digits(rmse_mpx).c_str(),
                              three_digits(*aim_mpx).c_str()));
    }
  }
  return out;
}

std::string head(const AccuracyResults& results) {
  return formatted(
      "# Accuracy\n\n"
      "What the presets of lsv and the methods of OpenCV %s make of simulated frames whose shift "
      "is known.\nMeasured and written by\n\n"
      "    build/dev/bin/accuracy -o docs\n\n"
      "(`cmake --build --preset dev --target accuracy`); `accuracy --small` is the short version "
      "that `ctest -L accuracy`\nruns. Frames of 128 x 128 px, 8 bit; %d pairs for each condition "
      "and size of the speckle; seed %llu. Lengths\nare in mpx = 0.001 px unless said otherwise. "
      "Accuracy only: what a shift costs is in\n[performance.md](performance.md).\n\n",
      CV_VERSION, results.pairs, static_cast<unsigned long long>(kSeed));
}

std::string limits_section(const AccuracyResults& results) {
  return "## Limits\n\n"
         "Must broken:\n\n" +
         bullets(broken_limits(results, Allowance::none), "None.") + "\nAim missed:\n\n" +
         bullets(missed_aims(results), "None.") + "\n" +
         formatted(
             "**Must** (`precise` unless said otherwise): the RMSE in the tables below; no outlier "
             "but in D70; %.0f +- %.0f %% of\nthe errors within 1 sigma and %.0f +- %.0f %% within "
             "1.96 sigma in every condition; distance after a long drive\nwithin %g %%; parked, "
             "never farther than %g px from the start and never `moving`.\n"
             "**Aim**: RMSE in A and B 1.5 times the bound, in C32 and E 1.5 times the bound of B, "
             "in F 1.05 times the bound;\n`fast` in B 2 mpx.\n\n",
             kMustWithin1 * 100.0, kMustWithin1Margin * 100.0, kMustWithin196 * 100.0,
             kMustWithin196Margin * 100.0, kMustDriftRatio * 100.0, kMustParked_px);
}

std::string conditions_section() {
  return "## Conditions\n\n"
         "Speckle of 3, 4 and 6 px (full width at half maximum of the intensity autocovariance "
         "before pixel integration),\nmean signal 60 counts, camera noise of mean 3.0 and standard "
         "deviation 0.5 counts unless said otherwise. The\nsame pair number shows the same ground "
         "in every condition.\n\n" +
         conditions_table() + "\n";
}

std::string methods_section() {
  return "## Methods\n\n"
         "Each gets two frames and knows nothing else of the shift.\n\n"
         "| method | what |\n|---|---|\n"
         "| precise, fast, classic | `ShiftMeter::search` with the preset, and the noise of the "
         "simulated camera as its calibration |\n"
         "| phaseCorrelate | `cv::phaseCorrelate`, float32, Hann window |\n"
         "| matchTemplate | `cv::matchTemplate`, TM_CCOEFF_NORMED, the central 96 px (64 px in C16 "
         "and C32), a 3-point Gaussian along each axis |\n"
         "| ECC | `cv::findTransformECC`, translation, 5 px blur, at most 50 iterations, from the "
         "whole-pixel answer of matchTemplate |\n\n";
}

std::string cases_section(const AccuracyResults& results) {
  std::string out = "## RMSE\n\n![RMSE per condition and method](accuracy/rmse.svg)\n\n";
  for (int size = 0; size < kSpeckleSizes; ++size)
    out += formatted("Speckle of %g px, RMSE per axis, mpx:\n\n", kSpeckleSizes_px[size]) +
           rmse_table(results, size) + "\n";
  return out;
}

std::string sigmas_section() {
  return "## Sigmas\n\n"
         "Share of the errors within the sigma stated with each shift; grey is what `precise` "
         "promises.\n\n![Coverage](accuracy/coverage.svg)\n\n";
}

std::string s_curve_section(const AccuracyResults& results) {
  return formatted(
             "## Bias over the fraction of a pixel\n\n"
             "Condition B, moved along x by 0 to 1 px in steps of 0.05 px, %d pairs a point (the "
             "same ground at each). Bars:\nstandard error. Mind the scales.\n\n"
             "![Bias against shift](accuracy/s_curve.svg)\n\n",
             results.s_curve_pairs) +
         s_curve_table(results) + "\n";
}

std::string drift_section(const AccuracyResults& results) {
  const int frames = results.drifts.empty() ? 0 : results.drifts.front().frames;
  const ParkedResult& parked = results.parked;
  return formatted(
             "## Drift\n\n"
             "Distance after %d frames along x at constant speed, noise as in B, the same frames "
             "pushed through two odometers:\n`precise`, and `classic` with the peak fit "
             "gaussian3.\n\n![Drift](accuracy/drift.svg)\n\n",
             frames) +
         drift_table(results) +
         formatted(
             "\nParked for %d frames (speckle of 4 px, noise as in B) `precise` was never farther "
             "than %.5f px from the start;\n%d frames were reported as `moving`, %d were "
             "refused.\n\n",
             parked.frames, parked.farthest_px, parked.frames_moving, parked.refused);
}

std::string details_section(const AccuracyResults& results) {
  std::string out =
      "## Every method in full\n\nmpx unless the head of the column says otherwise.\n\n";
  if (results.cases.empty()) return out;
  for (const MethodErrors& entry : results.cases.front().methods)
    out += "### " + std::string(entry.method) + "\n\n" + method_table(results, entry.method) + "\n";
  return out;
}

std::string definitions_section() {
  return "## Definitions\n\n"
         "- **Error**: shift measured less true shift, along x and y. **Outlier**: an error above "
         "1 "
         "px along an axis, or no\n  answer. **RMSE**, **bias** and **max** are over the rest; "
         "RMSE "
         "is the root of the mean over both axes.\n"
         "- **Within 1 or 1.96 sigma**: share of the errors of all answers, both axes, within the "
         "sigma stated with the\n  answer, or 1.96 times it. Normal errors with a true sigma give "
         "68.3 and 95.0 %.\n"
         "- **Bound**: Cramer-Rao bound for pixel noise alone, root of the mean over pairs and "
         "axes. Covariance\n  (v1 + v2) (sum of g g^T)^-1, g the gradient of the noise-free light "
         "over the pixels that both frames see and\n  that are not clipped, v = sd^2 + 1/12 the "
         "variance of a pixel of one frame, in S with the shot noise of the\n  mean signal. "
         "Boiling "
         "(G, D) and the light that clipping hides are not in it.\n"
         "- **Simulated**: fully developed speckle that moves exactly; blur along the path; "
         "mean over the pixel; shot noise;\n  camera noise; rounding; clipping. Not simulated: "
         "rotation, change of scale, uneven light, fixed pattern.\n";
}

}  // namespace

void write_report(const std::string& folder, const AccuracyResults& results) {
  const std::filesystem::path base(folder);
  const std::filesystem::path plots = base / "accuracy";
  std::filesystem::create_directories(plots);
  write_file(plots / "rmse.svg", plot_rmse(results));
  write_file(plots / "coverage.svg", plot_coverage(results));
  write_file(plots / "s_curve.svg", plot_s_curves(results));
  write_file(plots / "drift.svg", plot_drift(results));
  write_file(base / "accuracy.md",
             head(results) + limits_section(results) + conditions_section() + methods_section() +
                 cases_section(results) + sigmas_section() + s_curve_section(results) +
                 drift_section(results) + definitions_section() + "\n" + details_section(results));
}

}  // namespace lsv::bench
