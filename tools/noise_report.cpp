// SPDX-License-Identifier: BSD-3-Clause
#include "tools/noise_report.h"

#include <algorithm>
#include <cmath>

#include "lsv/core/config.h"
#include "lsv/core/frame.h"
#include "lsv/output/number_text.h"

namespace lsv::cli {
namespace {

constexpr double kMm = 1e3;
constexpr double kDefaultSearch_px = 32.0;  // CorrelationConfig::max_shift_px when unset
constexpr int kCurvePoints = 80;

// ---- sweeps ------------------------------------------------------------------------------------

using Change = void (*)(NoiseConditions&, double value);

struct SweepPlan {
  std::string_view key;
  std::string_view name;
  bool is_logarithmic;
  std::vector<double> table;  // rising; the curve goes from the first to the last
  double given;
  Change change;
};

/// Signal at full scale.
double saturated_counts(const NoiseConditions& c) {
  return full_scale_counts(c.bit_depth) - c.dark_counts;
}

/// Four a decade.
std::vector<double> round_figures(double low, double high) {
  std::vector<double> out;
  for (double decade = std::pow(10.0, std::floor(std::log10(low))); decade <= high;
       decade *= 10.0) {
    for (const double step : {1.0, 2.0, 3.0, 5.0})
      if (step * decade >= low && step * decade <= high) out.push_back(step * decade);
  }
  return out;
}

std::vector<SweepPlan> sweep_plans(const NoiseConditions& c) {
  const std::vector<double> light =
      round_figures(0.01 * saturated_counts(c), 0.4 * saturated_counts(c));
  return {
      {"window_px",
       "window, px",
       true,
       {48, 64, 96, 128, 192, 256, 384, 512},
       std::sqrt(static_cast<double>(c.width_px) * c.height_px),
       [](NoiseConditions& to, double v) {
         to.width_px = to.height_px = static_cast<int>(std::lround(v));
       }},
      {"speckle_px",
       "speckle size, px",
       false,
       {2.5, 3, 4, 5, 6, 7, 8, 9},
       c.speckle_px,
       [](NoiseConditions& to, double v) { to.speckle_px = v; }},
      {"blur_px",
       "blur, px",
       false,
       {0, 0.5, 1, 1.5, 2, 3, 4, 6},
       c.blur_px,
       [](NoiseConditions& to, double v) { to.blur_px = v; }},
      {"mean_signal_counts", "mean signal, counts", true, light, c.mean_signal_counts,
       [](NoiseConditions& to, double v) { to.mean_signal_counts = v; }},
      {"noise_sd_counts",
       "camera noise, counts",
       true,
       {0.1, 0.2, 0.3, 0.5, 1, 2, 4, 8},
       c.noise_sd_counts,
       [](NoiseConditions& to, double v) { to.noise_sd_counts = v; }},
      {"one_less_rho",
       "1 - rho",
       true,
       {1e-5, 1e-4, 1e-3, 3e-3, 0.01, 0.03, 0.1, 0.3},
       1.0 - c.rho,
       [](NoiseConditions& to, double v) { to.rho = 1.0 - v; }},
  };
}

NoiseSweep sweep(const NoiseConditions& given, const SweepPlan& plan) {
  const auto at = [&](double value) {
    NoiseConditions changed = given;
    plan.change(changed, value);
    const NoisePrediction prediction = predict_noise(changed);
    return NoiseSweep::At{value, prediction.sigma_x_px, prediction.sigma_y_px};
  };
  NoiseSweep out{.key = plan.key,
                 .name = plan.name,
                 .is_logarithmic = plan.is_logarithmic,
                 .given = plan.given,
                 .table = {},
                 .curve = {}};
  for (const double value : plan.table) out.table.push_back(at(value));
  const double first = plan.table.front();
  const double last = plan.table.back();
  for (int i = 0; i < kCurvePoints; ++i) {
    const double share = static_cast<double>(i) / (kCurvePoints - 1);
    out.curve.push_back(at(plan.is_logarithmic ? first * std::pow(last / first, share)
                                               : first + share * (last - first)));
  }
  return out;
}

// ---- the choice
// ----------------------------------------------------------------------------------

ChoiceQuestion question_of(const NoiseReport& r) {
  const NoiseInput& in = r.input;
  ChoiceQuestion out;
  out.known = in.conditions;
  out.scale = r.scale_x;
  out.exposure_s = in.exposure_s;
  out.speed_m_s = in.speed_m_s;
  out.update_hz = in.update_hz;
  if (!in.windows_px.empty()) out.windows_px = in.windows_px;
  out.camera_rates = in.camera_rates;
  out.push_s_per_px = in.push_s / in.conditions.width_px / in.conditions.height_px;
  return out;
}

std::string why_limited(const Attempt& attempt) {
  return std::string(attempt.limit == ChoiceLimit::noise && attempt.range != NoiseRange::inside
                         ? advice(attempt.range)
                         : advice(attempt.limit));
}

std::string what_if(const std::string& change, const std::optional<Choice>& choice,
                    const std::string& limit) {
  return change + ": " + (choice ? formatted("%.3g mm/s", choice->update_sigma_m_s * kMm) : limit);
}

std::string what_if(const char* change, const Attempt& attempt) {
  return what_if(std::string(change), attempt.choice, why_limited(attempt));
}

/// What the windows beside the best one would give.
void add_neighbours(const Recommendation& r, std::vector<std::string>& out) {
  for (std::size_t i = 0; i < r.windows.size(); ++i) {
    const WindowChoice& window = r.windows[i];
    const bool is_smaller =
        i + 1 < r.windows.size() && r.windows[i + 1].window_px == r.best->window_px;
    const bool is_larger = i > 0 && r.windows[i - 1].window_px == r.best->window_px;
    if (is_smaller || is_larger)
      out.push_back(what_if(formatted("a window of %d px", window.window_px), window.best,
                            std::string(advice(window.limit))));
  }
}

std::string largest_part(const NoiseParts& p) {
  struct Part {
    double px;
    const char* cure;
  };
  const Part parts[] = {
      {p.noise_px, "noise of the pixels; more light or more pixels lower it"},
      {p.boiling_px,
       "change of the pattern from frame to frame; more pixels or smaller speckle lower it"},
      {p.clipping_px, "clipped pixels; less light lowers it"},
      {p.interpolation_px, "interpolation; no setting lowers it"}};
  const Part* largest = &parts[0];
  for (const Part& part : parts)
    if (part.px > largest->px) largest = &part;
  const double share = largest->px / p.sigma_px();
  return formatted("%.0f %% of its variance is ", 100.0 * share * share) + largest->cure;
}

std::vector<std::string> reasons_for(const ChoiceQuestion& q, const Recommendation& r) {
  const Choice& best = *r.best;
  const auto tried = [&](double rate_factor, double exposure_s) {
    return evaluate(q, best.window_px, rate_factor * best.rate_hz, exposure_s);
  };
  std::vector<std::string> out = {largest_part(best.parts)};
  add_neighbours(r, out);
  out.push_back(what_if("half the rate", tried(0.5, best.exposure_s)));
  // The same light has no room where frames follow each other twice as fast.
  out.push_back(
      what_if("twice the rate", tried(2.0, std::min(best.exposure_s, 0.5 / best.rate_hz))));
  out.push_back(what_if("half the exposure", tried(1.0, 0.5 * best.exposure_s)));
  out.push_back(what_if("twice the exposure", tried(1.0, 2.0 * best.exposure_s)));
  if (best.shift_px > kDefaultSearch_px) {
    out.push_back(formatted("to start at full speed it needs lsv track --max-shift %.0f",
                            std::ceil(best.shift_px) + 4.0));
  }
  return out;
}

void add_warnings(NoiseReport& r) {
  const NoiseConditions& c = r.input.conditions;
  if (r.pair.range != NoiseRange::inside)
    r.warnings.push_back("no prediction: " + std::string(advice(r.pair.range)));
  if (std::abs(c.shift_px) > kLargestShiftFraction * c.width_px) {
    r.warnings.push_back(formatted(
        "%.4g mm/s is out of range: it moves the pattern by %.4g px per frame, more than a quarter "
        "of %d px; %.4g mm/s is the limit at this window and rate",
        r.input.speed_m_s * kMm, c.shift_px, c.width_px,
        largest_speed_m_s(r.scale_x, c.width_px) * kMm));
  }
  const double gate = GateConfig{}.min_zncc_sigmas;
  if (r.pair.zncc_sigmas < kZnccSigmasMargin * gate) {
    r.warnings.push_back(formatted(
        "the correlation peak stands %.3g sigmas over chance, with the gate at %g: some shifts "
        "will be refused",
        r.pair.zncc_sigmas, gate));
  }
  if (!r.recommendation.best)
    r.warnings.push_back("no window, rate and exposure tried can follow this speed");
}

}  // namespace

NoiseReport noise_report(const NoiseInput& input) {
  NoiseReport r;
  r.input = input;
  r.scale_x = {.sc_ratio = input.calibration.sc_x_ratio,
               .pixel_pitch_m = input.calibration.pixel_pitch_x_m,
               .rate_hz = input.rate_hz};
  r.scale_y = {.sc_ratio = input.calibration.sc_y_ratio,
               .pixel_pitch_m = input.calibration.pixel_pitch_y_m,
               .rate_hz = input.rate_hz};
  NoiseConditions& c = r.input.conditions;
  c.shift_px = shift_px_per_frame(r.scale_x, input.speed_m_s);
  c.blur_px = c.shift_px * input.rate_hz * input.exposure_s;
  r.pair = predict_noise(c);
  r.tracking = predict_tracking_noise(c);
  for (const SweepPlan& plan : sweep_plans(c)) r.sweeps.push_back(sweep(c, plan));
  r.question = question_of(r);
  r.recommendation = recommend(r.question);
  if (r.recommendation.best) r.reasons = reasons_for(r.question, r.recommendation);
  add_warnings(r);
  return r;
}

}  // namespace lsv::cli
