// SPDX-License-Identifier: BSD-3-Clause
// Holds the predictions of calibration/noise_model.h against simulated and tracked frames.
//   noise_check            prints the tables of docs/noise.md
//   noise_check -o DIR     also writes DIR/check.svg
// Ends with 1 when a prediction is off by more than 15 %, with 2 when something cannot be done.
#include <cmath>
#include <cstdio>
#include <cstring>
#include <exception>
#include <functional>
#include <opencv2/core.hpp>
#include <stdexcept>
#include <string>

#include "bench/noise_drive.h"
#include "bench/noise_points.h"
#include "lsv/output/number_text.h"
#include "lsv/output/output_file.h"
#include "tools/line_plot.h"

namespace lsv::bench {
namespace {

constexpr int kPairs = 640;
constexpr int kPlotPairs = 240;
constexpr int kDrives = 8;
constexpr int kDriveFrames = 401;
constexpr double kAllowed_ratio = 0.15;
constexpr double kMilli = 1e3;

/// Rows of a table, and whether every prediction in it holds.
struct Check {
  double worst_ratio = 0.0;
  std::string percent(double predicted, double measured) {
    const double off = predicted / measured - 1.0;
    // Written so that NaN is the worst.
    if (!(std::abs(off) <= worst_ratio)) worst_ratio = std::abs(off);
    return formatted("%+.1f", 100.0 * off);
  }
};

void check_points(Check& check) {
  std::printf(
      "| window px | speckle px | blur px | shift px | mean | noise | bit | full well e | rho | "
      "sigma x, mpx | simulated | %% | sigma y, mpx | simulated | %% | outliers |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (const NoisePoint& p : noise_points()) {
    const NoisePrediction predicted = predict_noise(conditions_of(p));
    const PairErrors simulated = simulate(p, kPairs);
    const double x = simulated.rmse_x_px();
    const double y = simulated.rmse_y_px();
    std::printf(
        "| %d | %g | %g | %g | %g | %g | %d | %s | %g | %.3g | %.3g | %s | %.3g | %.3g | "
        "%s | %d |\n",
        p.side_px, p.speckle_px, p.blur_px, p.shift_px, p.mean_counts, p.noise_sd_counts,
        p.bit_depth,
        p.full_well_electrons > 0.0 ? formatted("%g", p.full_well_electrons).c_str() : "-", p.rho,
        predicted.sigma_x_px * kMilli, x * kMilli, check.percent(predicted.sigma_x_px, x).c_str(),
        predicted.sigma_y_px * kMilli, y * kMilli, check.percent(predicted.sigma_y_px, y).c_str(),
        simulated.outliers);
    std::fflush(stdout);
  }
}

void check_drives(Check& check) {
  std::printf(
      "\n| window px | speckle px | blur px | px per frame | mean | noise | full well e | rho | "
      "step x, mpx | simulated | %% | travel over %d frames, mpx | simulated | %% | frames per "
      "keyframe | simulated |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n",
      kTravelFrames);
  for (const NoisePoint& p : noise_drives()) {
    const TrackingNoise t = predict_tracking_noise(conditions_of(p));
    const DriveErrors simulated = simulate_drive(p, kDrives, kDriveFrames);
    const double step_px2 = 0.5 * (t.step_x_px * t.step_x_px + t.step_y_px * t.step_y_px);
    const double travel_px =
        std::sqrt(step_px2 + (kTravelFrames - 1) * 0.5 * (t.drift_x_px2 + t.drift_y_px2));
    Check travel;
    std::printf(
        "| %d | %g | %g | %g | %g | %g | %s | %g | %.3g | %.3g | %s | %.3g | %.3g | %s | "
        "%d | %.1f |\n",
        p.side_px, p.speckle_px, p.blur_px, p.shift_px, p.mean_counts, p.noise_sd_counts,
        p.full_well_electrons > 0.0 ? formatted("%g", p.full_well_electrons).c_str() : "-", p.rho,
        t.step_x_px * kMilli, simulated.step_x_px * kMilli,
        check.percent(t.step_x_px, simulated.step_x_px).c_str(), travel_px * kMilli,
        simulated.travel_px * kMilli, travel.percent(travel_px, simulated.travel_px).c_str(),
        t.frames_per_keyframe, simulated.frames_per_keyframe);
    std::fflush(stdout);
  }
}

// ---- the picture -------------------------------------------------------------------------------

struct Panel {
  std::string x_name;
  cli::AxisScale scale;
  std::vector<double> ticks;
  std::vector<double> simulated;
  std::function<void(NoisePoint&, double)> change;
};

cli::LinePlot plot_of(const Panel& panel) {
  constexpr int kCurvePoints = 60;
  cli::LinePlot out;
  out.title = "sigma against " + panel.x_name;
  out.x_name = panel.x_name;
  out.y_name = "sigma of one shift, mpx";
  out.x_scale = panel.scale;
  out.x_ticks = panel.ticks;
  out.series = {{.name = "along", .colour = "#2f80ed", .points = {}},
                {.name = "across", .colour = "#2bb3a3", .points = {}},
                {.name = "simulated", .colour = "#2f80ed", .points = {}, .is_marked = true},
                {.name = "simulated", .colour = "#2bb3a3", .points = {}, .is_marked = true}};
  const NoisePoint base{.speckle_px = 4.0, .blur_px = 2.0, .full_well_electrons = 10000.0};
  const double first = panel.ticks.front();
  const double last = panel.ticks.back();
  for (int i = 0; i < kCurvePoints; ++i) {
    const double share = static_cast<double>(i) / (kCurvePoints - 1);
    const double at = panel.scale == cli::AxisScale::logarithmic
                          ? first * std::pow(last / first, share)
                          : first + share * (last - first);
    NoisePoint point = base;
    panel.change(point, at);
    const NoisePrediction predicted = predict_noise(conditions_of(point));
    out.series[0].points.push_back({at, predicted.sigma_x_px * kMilli});
    out.series[1].points.push_back({at, predicted.sigma_y_px * kMilli});
  }
  for (const double at : panel.simulated) {
    NoisePoint point = base;
    panel.change(point, at);
    const PairErrors errors = simulate(point, kPlotPairs);
    out.series[2].points.push_back({at, errors.rmse_x_px() * kMilli});
    out.series[3].points.push_back({at, errors.rmse_y_px() * kMilli});
  }
  return out;
}

std::string picture() {
  using enum cli::AxisScale;
  const Panel panels[] = {
      {"window, px",
       logarithmic,
       {48, 64, 96, 128, 192, 256, 384, 512},
       {48, 80, 128, 224, 400},
       [](NoisePoint& p, double v) { p.side_px = static_cast<int>(std::lround(v)); }},
      {"speckle size, px",
       linear,
       {2.5, 3, 4, 5, 6, 7, 8, 9},
       {2.7, 3.5, 5, 7, 8.5},
       [](NoisePoint& p, double v) { p.speckle_px = v; }},
      {"blur, px",
       linear,
       {0, 1, 2, 3, 4, 5, 6},
       {0, 1, 2.5, 3.7, 5.2},
       [](NoisePoint& p, double v) { p.blur_px = v; }},
      {"mean signal of 252 counts",
       logarithmic,
       {5, 10, 20, 40, 60, 100},
       {6, 14, 30, 70, 95},
       [](NoisePoint& p, double v) { p.mean_counts = v; }},
      {"camera noise, counts",
       logarithmic,
       {0.1, 0.2, 0.5, 1, 2, 5, 10},
       {0.3, 1, 2.5, 6},
       [](NoisePoint& p, double v) { p.noise_sd_counts = v; }},
      {"1 - rho",
       logarithmic,
       {1e-5, 1e-4, 1e-3, 0.01, 0.1, 0.3},
       {5e-5, 1e-3, 0.02, 0.25},
       [](NoisePoint& p, double v) { p.rho = 1.0 - v; }},
  };
  constexpr int kWidth = 460;
  constexpr int kHeight = 300;
  constexpr int kColumns = 2;
  std::string out = formatted(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" height=\"%d\" viewBox=\"0 0 %d %d\" "
      "role=\"img\"><title>Predicted and simulated sigma</title>\n",
      kColumns * kWidth, 3 * kHeight, kColumns * kWidth, 3 * kHeight);
  int index = 0;
  for (const Panel& panel : panels) {
    const int column = index % kColumns;
    const int row = index / kColumns;
    ++index;
    out += formatted("<g transform=\"translate(%d %d)\">\n", column * kWidth, row * kHeight) +
           draw(plot_of(panel), kWidth, kHeight) + "</g>\n";
    std::fprintf(stderr, "plot %d of 6: done\n", index);
  }
  return out + "</svg>\n";
}

int run(const char* folder) {
  cv::setNumThreads(1);
  Check check;
  check_points(check);
  check_drives(check);
  if (folder != nullptr) {
    const Result<void> written = write_file(std::string(folder) + "/check.svg", picture());
    if (!written) throw std::runtime_error(written.error().message);
  }
  const bool holds = check.worst_ratio <= kAllowed_ratio;
  std::printf("\nlargest difference of a sigma %.1f %%, allowed %.0f %%\n",
              100.0 * check.worst_ratio, 100.0 * kAllowed_ratio);
  return holds ? 0 : 1;
}

}  // namespace
}  // namespace lsv::bench

int main(int argc, char** argv) {
  const bool has_folder = argc == 3 && std::strcmp(argv[1], "-o") == 0;
  if (argc != 1 && !has_folder) {
    std::fputs("usage: noise_check [-o DIR]\n", stderr);
    return 2;
  }
  try {
    return lsv::bench::run(has_folder ? argv[2] : nullptr);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "noise_check: %s\n", error.what());
    return 2;
  }
}
