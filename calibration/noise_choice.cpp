// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/noise_choice.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "lsv/core/config.h"

namespace lsv {
namespace {

constexpr double kEquallyGood_ratio = 1.05;
constexpr double kShortestExposure_s = 1e-6;

/// Round figures, ten a decade, from `low` on, and `high`; empty when low is above high.
std::vector<double> series(double low, double high) {
  static constexpr double kSteps[] = {1.0, 1.25, 1.6, 2.0, 2.5, 3.2, 4.0, 5.0, 6.3, 8.0};
  std::vector<double> out;
  for (double decade = std::pow(10.0, std::floor(std::log10(low))); decade < high; decade *= 10.0) {
    for (const double step : kSteps)
      if (step * decade >= low && step * decade < high) out.push_back(step * decade);
  }
  if (low <= high) out.push_back(high);
  return out;
}

double fastest_hz(const ChoiceQuestion& q, int window_px) {
  if (q.camera_rates.empty()) return q.scale.rate_hz;
  for (const CameraRate& rate : q.camera_rates)
    if (rate.window_px >= window_px) return rate.rate_hz;
  return 0.0;
}

double push_load(const ChoiceQuestion& q, int window_px, double rate_hz) {
  return q.push_s_per_px * window_px * window_px * rate_hz;
}

double pixels_per_s(const Choice& choice) {
  return choice.rate_hz * choice.window_px * choice.window_px;
}

/// The cheapest of the equally good; null when there is none.
const Choice* best_of(const std::vector<Choice>& choices) {
  double least_m_s = std::numeric_limits<double>::infinity();
  for (const Choice& choice : choices) least_m_s = std::min(least_m_s, choice.update_sigma_m_s);
  const auto cost = [](const Choice& choice) {
    return std::pair(pixels_per_s(choice), choice.update_sigma_m_s);
  };
  const Choice* out = nullptr;
  for (const Choice& choice : choices) {
    if (choice.update_sigma_m_s > kEquallyGood_ratio * least_m_s) continue;
    if (out == nullptr || cost(choice) < cost(*out)) out = &choice;
  }
  return out;
}

/// The slowest rate at which the shift stays within the window.
double slowest_hz(const ChoiceQuestion& q, int window_px) {
  const SensorScale once_a_second{q.scale.sc_ratio, q.scale.pixel_pitch_m, 1.0};
  return shift_px_per_frame(once_a_second, q.speed_m_s) / (kLargestShiftFraction * window_px);
}

/// What stands in the way of every rate and exposure of a window.
ChoiceLimit window_limit(const ChoiceQuestion& q, int window_px, double slowest, double fastest) {
  if (fastest_hz(q, window_px) < q.update_hz) return ChoiceLimit::camera;
  if (fastest < q.update_hz) return ChoiceLimit::processor;
  return slowest > fastest ? ChoiceLimit::speed : ChoiceLimit::none;
}

WindowChoice choose(const ChoiceQuestion& q, int window_px) {
  WindowChoice out{.window_px = window_px, .best = {}, .limit = ChoiceLimit::none};
  const double load_per_hz = push_load(q, window_px, 1.0);
  double fastest = fastest_hz(q, window_px);
  if (load_per_hz > 0.0) fastest = std::min(fastest, kLargestPushLoad_ratio / load_per_hz);
  const double slowest = slowest_hz(q, window_px);
  out.limit = window_limit(q, window_px, slowest, fastest);
  if (out.limit != ChoiceLimit::none) return out;
  std::vector<Choice> choices;
  for (const double rate_hz : series(std::max(slowest, q.update_hz), fastest)) {
    for (const double exposure_s : series(kShortestExposure_s, 1.0 / rate_hz)) {
      if (const Attempt attempt = evaluate(q, window_px, rate_hz, exposure_s); attempt.choice)
        choices.push_back(*attempt.choice);
    }
  }
  if (const Choice* const best = best_of(choices))
    out.best = *best;
  else
    out.limit = ChoiceLimit::noise;
  return out;
}

// A rate or exposure at its limit misses it by a rounding error.
constexpr double kRounding = 1.0 + 1e-9;

ChoiceLimit simple_limit(const ChoiceQuestion& q, const NoiseConditions& c, double rate_hz,
                         double exposure_s) {
  if (rate_hz > kRounding * fastest_hz(q, c.width_px)) return ChoiceLimit::camera;
  if (kRounding * rate_hz < q.update_hz) return ChoiceLimit::update;
  if (c.shift_px > kRounding * kLargestShiftFraction * c.width_px) return ChoiceLimit::speed;
  if (exposure_s * rate_hz > kRounding) return ChoiceLimit::exposure;
  if (c.blur_px > kLargestBlur_ratio * c.speckle_px) return ChoiceLimit::blur;
  // Unknown is no limit.
  if (push_load(q, c.width_px, rate_hz) > kRounding * kLargestPushLoad_ratio)
    return ChoiceLimit::processor;
  return ChoiceLimit::none;
}

}  // namespace

std::string_view advice(ChoiceLimit limit) {
  switch (limit) {
    case ChoiceLimit::none:
      return "";
    case ChoiceLimit::camera:
      return "the camera does not read it as often";
    case ChoiceLimit::update:
      return "slower than the update rate";
    case ChoiceLimit::speed:
      return "the pattern moves by more than a quarter of the window per frame";
    case ChoiceLimit::exposure:
      return "longer than the time between frames";
    case ChoiceLimit::blur:
      return "smears the pattern over more than a speckle";
    case ChoiceLimit::processor:
      return "takes more than half of the processor";
    case ChoiceLimit::noise:
      return "cannot be tracked with a margin";
  }
  return "";
}

Attempt evaluate(const ChoiceQuestion& q, int window_px, double rate_hz, double exposure_s) {
  const SensorScale scale{q.scale.sc_ratio, q.scale.pixel_pitch_m, rate_hz};
  NoiseConditions c = q.known;
  c.width_px = c.height_px = window_px;
  c.shift_px = shift_px_per_frame(scale, q.speed_m_s);
  c.blur_px = c.shift_px * rate_hz * exposure_s;
  c.mean_signal_counts *= exposure_s / q.exposure_s;
  c.rho = std::pow(c.rho, q.scale.rate_hz / rate_hz);
  Attempt out;
  out.limit = simple_limit(q, c, rate_hz, exposure_s);
  if (out.limit != ChoiceLimit::none) return out;
  const NoisePrediction pair = predict_noise(c);
  out.range = pair.range;
  if (pair.range != NoiseRange::inside ||
      pair.zncc_sigmas < kZnccSigmasMargin * GateConfig{}.min_zncc_sigmas) {
    out.limit = ChoiceLimit::noise;
    return out;
  }
  const TrackingNoise tracking = predict_tracking_noise(c);

  const double frames = std::max(1.0, rate_hz / q.update_hz);
  const double travel_px2 =
      tracking.step_x_px * tracking.step_x_px + (frames - 1.0) * tracking.drift_x_px2;
  const double frames_per_m = rate_hz / q.speed_m_s;
  out.choice = {
      .window_px = window_px,
      .rate_hz = rate_hz,
      .exposure_s = exposure_s,
      .shift_px = c.shift_px,
      .blur_px = c.blur_px,
      .mean_signal_counts = c.mean_signal_counts,
      .zncc_sigmas = pair.zncc_sigmas,
      .parts = pair.x,
      .frame_sigma_m_s = velocity_sigma_m_s(scale, tracking.step_x_px),
      .update_sigma_m_s = velocity_sigma_m_s(scale, std::sqrt(travel_px2)) / frames,
      .distance_sigma_m = surface_m_per_px(scale) * std::sqrt(frames_per_m * tracking.drift_x_px2),
      .push_load_ratio = push_load(q, window_px, rate_hz)};
  return out;
}

Recommendation recommend(const ChoiceQuestion& question) {
  Recommendation out;
  std::vector<Choice> bests;
  for (const int window_px : question.windows_px) {
    out.windows.push_back(choose(question, window_px));
    if (out.windows.back().best) bests.push_back(*out.windows.back().best);
  }
  if (const Choice* const best = best_of(bests)) out.best = *best;
  return out;
}

}  // namespace lsv
