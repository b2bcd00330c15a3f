// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/camera_warnings.h"

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <utility>

namespace lsv {
namespace {

constexpr std::int64_t kFewFrames = 16;
constexpr std::ptrdiff_t kFewLevels = 5;
// Of the counts that are 0 in the dark; EMVA 1288 allows about as many.
constexpr double kUnderflowShare = 0.005;
// Below, rounding to counts hides the noise (EMVA 1288, section 6).
constexpr double kLeastDarkVariance_counts2 = 0.24;
constexpr double kUnevenLight_ratio = 0.1;
constexpr double kFlicker_ratio = 0.01;
constexpr double kDarkDrift = 0.5;  // of the dark noise
constexpr double kManyDefects = 0.01;
constexpr double kBrightEnough = 0.5;  // of the range

[[gnu::format(printf, 1, 2)]] std::string text(const char* format, ...) {
  char out[400];
  va_list args;
  va_start(args, format);
  std::vsnprintf(out, sizeof out, format, args);
  va_end(args);
  return out;
}

using Warnings = std::vector<std::string>;

double signal_counts(const CameraCharacterisation& camera, std::size_t level) {
  return camera.flats[level].point.mean_counts.value - camera.mu_dark_counts.value;
}

void warn_about_frames(const LightLevel& level, Warnings& out) {
  if (level.frames >= kFewFrames) return;
  out.push_back(level.name + text(": %lld frames are few; with 50 or more the maps are less noisy",
                                  static_cast<long long>(level.frames)));
}

void warn_about_levels(const CameraCharacterisation& camera, Warnings& out) {
  if (!camera.given_in_order)
    out.emplace_back(
        "the sequences of light were not given from dim to bright; they were put in order");
  for (std::size_t k = 1; k < camera.flats.size(); ++k) {
    const bool brighter =
        signal_counts(camera, k) > (1.0 + kSameLight) * signal_counts(camera, k - 1);
    if (camera.flats[k].saturated || brighter) continue;
    out.push_back(camera.flats[k].name + ": is about as bright as " + camera.flats[k - 1].name +
                  ", so it adds little");
  }
  const auto used =
      std::ranges::count_if(camera.flats, [](const LightLevel& level) { return level.used; });
  if (used < kFewLevels) {
    out.push_back(
        text("K rests on %td levels of light; with five or more a bend would show", used));
  }
  if (!camera.saturation_reached) {
    out.emplace_back(
        "no sequence reached saturation: the saturation, the largest signal-to-noise ratio and the "
        "dynamic range are lower bounds; add one that is overexposed");
  }
  const double range = full_scale_counts(camera.format.bit_depth) - camera.mu_dark_counts.value;
  const double part = signal_counts(camera, camera.gain_level) / range;
  if (part < kBrightEnough && !camera.saturation_reached) {
    out.push_back(
        text("no level is near saturation: the brightest is at %.0f %% of the range; PRNU and the "
             "gain map are better at half of it and more",
             100.0 * part));
  }
}

void warn_about_light(const CameraCharacterisation& camera, Warnings& out) {
  if (camera.light_range_ratio > kUnevenLight_ratio) {
    out.push_back(text(
        "the flat light is not flat: it varies by %.0f %% over the sensor; the slow part of it "
        "was taken out, but EMVA 1288 asks for at most 3 %%",
        100.0 * camera.light_range_ratio));
  }
  for (std::size_t k = 0; k < camera.flats.size(); ++k) {
    const double flicker = camera.flats[k].flicker_counts / signal_counts(camera, k);
    if (!(flicker > kFlicker_ratio)) continue;
    out.push_back(
        camera.flats[k].name +
        text(": the light changed by %.1f %% (standard deviation) over the sequence; that "
             "was taken out of the noise, but a steady light is better",
             100.0 * flicker));
  }
}

void warn_about_dark(const CameraCharacterisation& camera, Warnings& out) {
  if (camera.dark.clipped_share > kUnderflowShare) {
    out.push_back(
        text("%.1f %% of the dark counts are 0: mu_dark, sigma_d and DSNU are cut off there; raise "
             "the black level of the camera",
             100.0 * camera.dark.clipped_share));
  }
  if (camera.dark.point.variance_counts2.value < kLeastDarkVariance_counts2) {
    out.push_back(
        text("the dark noise of %.2f counts drowns in the rounding to counts: all that is sure of "
             "sigma_d is that it is under %.3g e-",
             camera.sigma_y_dark_counts.value, 0.4 / camera.transfer.k_counts_per_e.value));
  }
  if (camera.dark.flicker_counts > kDarkDrift * camera.sigma_y_dark_counts.value) {
    out.push_back(camera.dark.name +
                  text(": the dark level changed by %.2f counts (standard deviation) over the "
                       "sequence; let the camera warm up",
                       camera.dark.flicker_counts));
  }
}

}  // namespace

std::vector<std::string> camera_warnings(const CameraCharacterisation& camera) {
  Warnings out;
  warn_about_frames(camera.dark, out);
  for (const LightLevel& level : camera.flats) warn_about_frames(level, out);
  warn_about_levels(camera, out);
  warn_about_light(camera, out);
  warn_about_dark(camera, out);
  if (camera.transfer.sigma_factor > 1.0) {
    out.push_back(text(
        "the noise departs from a straight line by %.1f times what its sigmas allow; the sigma "
        "of K was raised by that",
        camera.transfer.sigma_factor));
  }
  if (camera.gain_map_noise_ratio > camera.prnu_ratio.value) {
    out.push_back(
        text("the gain map holds more noise (%.2f %%) than pattern (%.2f %%): take more "
             "frames of the brightest light",
             100.0 * camera.gain_map_noise_ratio, 100.0 * camera.prnu_ratio.value));
  }
  const auto defects = static_cast<double>(camera.defects.counts.hot + camera.defects.counts.dead);
  if (defects > kManyDefects * static_cast<double>(camera.maps.defect.size())) {
    out.push_back(text("%.0f pixels are defect; is there dirt on the sensor?", defects));
  }
  return out;
}

}  // namespace lsv
