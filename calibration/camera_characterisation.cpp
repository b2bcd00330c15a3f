// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/camera_characterisation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <new>
#include <numeric>
#include <utility>

#include "calibration/smooth_part.h"

namespace lsv {
namespace {

constexpr int kLeastSide_px = 32;
constexpr std::int64_t kLeastFrames = 2;
// Of the counts at full scale: EMVA 1288 takes saturation to begin at 0.1 to 0.2 %.
constexpr double kSaturatedShare = 0.001;
// Of the counts that are 0 in the dark; beyond, there is no dark level.
constexpr double kMostUnderflowShare = 0.5;
// The linearity error is taken over this part of the saturation.
constexpr double kLinearityFrom = 0.05;
constexpr double kLinearityTo = 0.95;
// PRNU1288 is defined at this part.
constexpr double kPrnuPart = 0.5;
constexpr double kSignificantSigmas = 3.0;
// Light that falls below this part of its mean says too little about the pixels there.
constexpr double kDarkestCorner = 0.1;

[[gnu::format(printf, 2, 3)]] Error refuse(const std::string& name, const char* format, ...) {
  char why[400];
  va_list args;
  va_start(args, format);
  std::vsnprintf(why, sizeof why, format, args);
  va_end(args);
  return {ErrorCode::bad_input, name + ": " + why};
}

double squared(double value) { return value * value; }

/// Mean square of what is left of a picture without its smooth part, as of an uncorrelated pattern.
Measured pattern_variance(const std::vector<double>& left,
                          const std::vector<std::uint8_t>& defect) {
  double n = 0.0;
  double square = 0.0;
  double fourth = 0.0;
  for (std::size_t i = 0; i < left.size(); ++i) {
    if (defect[i] != 0) continue;
    const double value2 = left[i] * left[i];
    square += value2;
    fourth += value2 * value2;
    n += 1.0;
  }
  const double mean2 = square / n;
  const double gain2 = squared(high_pass_gain());
  return {mean2 / gain2, std::sqrt((fourth / n - mean2 * mean2) / n) / gain2};
}

/// Response of each pixel to a level of light, over the smooth light.
struct Response {
  std::vector<double> ratio;  // 1 where defect
  Measured noise_variance;    // of it: what is left of the temporal noise
  double light_range = 0.0;   // (most - least) / mean
  double least_light = 0.0;   // least / mean
};

/// One characterisation being made.
class Evaluation {
 public:
  Evaluation(const LightSequence& dark, const std::vector<LightSequence>& flats)
      : dark_(dark.statistics), dark_name_(dark.name), flats_(flats), order_(flats.size()) {
    std::iota(order_.begin(), order_.end(), std::size_t{0});
  }

  Result<CameraCharacterisation> run() {
    if (Result<void> done = check_sequences(); !done) return done.error();
    out_.format = dark_.format();
    out_.defects = find_dark_defects(dark_);
    sort_levels();
    if (Result<void> done = check_levels(); !done) return done.error();
    if (Result<void> done = find_saturation(); !done) return done.error();
    add_lit_defects(dark_, flat(out_.gain_level), out_.defects);
    measure_levels();
    if (Result<void> done = fit_k(); !done) return done.error();
    measure_dark();
    if (Result<void> done = measure_response(); !done) return done.error();
    measure_saturation();
    measure_linearity();
    return std::move(out_);
  }

 private:
  const PixelStatistics& flat(std::size_t level) const { return flats_[order_[level]].statistics; }
  double signal_counts(std::size_t level) const {
    return out_.flats[level].point.mean_counts.value - out_.dark.point.mean_counts.value;
  }
  std::vector<double> smooth_of(const std::vector<double>& values) const {
    return smooth_part(values, out_.defects.defect, out_.format.width_px, out_.format.height_px);
  }

  Result<void> check_sequences() const {
    const FrameFormat& format = dark_.format();
    if (format.width_px < kLeastSide_px || format.height_px < kLeastSide_px) {
      return refuse(dark_name_, "frames of %d x %d px tell too little; 32 x 32 px is the least",
                    format.width_px, format.height_px);
    }
    if (Result<void> enough = check_frames(dark_, dark_name_); !enough) return enough;
    for (const LightSequence& sequence : flats_) {
      const FrameFormat& other = sequence.statistics.format();
      if (other != format) {
        return refuse(sequence.name,
                      "is %d x %d px with %d bit, but the dark frames are %d x %d px with %d bit; "
                      "record all sequences with the same settings",
                      other.width_px, other.height_px, other.bit_depth, format.width_px,
                      format.height_px, format.bit_depth);
      }
      if (Result<void> enough = check_frames(sequence.statistics, sequence.name); !enough)
        return enough;
    }
    if (flats_.size() < 2) {
      return refuse(dark_name_,
                    "besides the dark there are %zu levels of light; K needs two or more",
                    flats_.size());
    }
    return {};
  }

  static Result<void> check_frames(const PixelStatistics& sequence, const std::string& name) {
    if (sequence.frames() >= kLeastFrames) return {};
    return refuse(name,
                  "holds one frame only; noise is what differs between frames, so give 16 or more "
                  "of the same light");
  }

  void sort_levels() {
    std::ranges::stable_sort(
        order_, {}, [this](std::size_t i) { return flats_[i].statistics.frame_mean_counts(); });
    out_.given_in_order = std::ranges::is_sorted(order_);
    out_.flats.resize(order_.size());
    measure_levels();
  }

  /// Of the pixels that are not known as defect so far.
  void measure_levels() {
    out_.dark = light_level(dark_, out_.defects.defect, nullptr);
    out_.dark.name = dark_name_;
    for (std::size_t k = 0; k < order_.size(); ++k) {
      const bool saturated = out_.flats[k].saturated;
      out_.flats[k] = light_level(flat(k), out_.defects.defect, &dark_);
      out_.flats[k].name = flats_[order_[k]].name;
      out_.flats[k].exposure_us = flats_[order_[k]].exposure_us;
      out_.flats[k].saturated = saturated;
    }
  }

  Result<void> check_levels() const {
    if (out_.dark.clipped_share > kMostUnderflowShare) {
      return refuse(dark_name_,
                    "%.0f %% of the counts are 0, so the dark level is out of sight; raise the "
                    "black level (offset) of the camera",
                    100.0 * out_.dark.clipped_share);
    }
    const Measured& dark = out_.dark.point.mean_counts;
    for (const LightLevel& level : out_.flats) {
      const Measured& lit = level.point.mean_counts;
      if (lit.value > dark.value + kSignificantSigmas * (lit - dark).sigma) continue;
      return refuse(level.name,
                    "its mean of %.2f counts is not above the dark level of %.2f; are --dark and "
                    "--flat exchanged?",
                    lit.value, dark.value);
    }
    return {};
  }

  /// Whether the noise is less than at the level before, though there is more light.
  bool noise_falls(std::size_t level) const {
    if (level == 0 || signal_counts(level) < (1.0 + kSameLight) * signal_counts(level - 1))
      return false;
    const Measured change =
        out_.flats[level].point.variance_counts2 - out_.flats[level - 1].point.variance_counts2;
    return change.value < -kSignificantSigmas * change.sigma;
  }

  Result<void> find_saturation() {
    std::size_t first = 0;
    while (first < out_.flats.size() && !noise_falls(first) &&
           out_.flats[first].clipped_share <= kSaturatedShare)
      ++first;
    if (first == 0) {
      return refuse(out_.flats[0].name,
                    "even the dimmest light saturates the sensor; expose for less time");
    }
    for (std::size_t k = first; k < out_.flats.size(); ++k) out_.flats[k].saturated = true;
    out_.saturation_reached = first < out_.flats.size();
    out_.gain_level = first - 1;
    out_.saturation_counts = out_.flats[first - 1].point.mean_counts;
    if (!out_.saturation_reached) return {};
    // Anywhere between the two with equal probability.
    const double gap_counts = signal_counts(first) - signal_counts(first - 1);
    out_.saturation_counts.value += 0.5 * gap_counts;
    out_.saturation_counts.sigma = gap_counts / std::sqrt(12.0);
    return {};
  }

  /// The signal at saturation, or as much as the counts can hold.
  double range_counts() const {
    const double most = out_.saturation_reached ? out_.saturation_counts.value
                                                : full_scale_counts(out_.format.bit_depth);
    return most - out_.dark.point.mean_counts.value;
  }

  Result<void> fit_k() {
    std::vector<TransferPoint> points;
    std::size_t dimmest = 0;
    std::size_t brightest = 0;
    for (std::size_t k = 0; k <= out_.gain_level; ++k) {
      if (signal_counts(k) > kLinearPart * range_counts()) break;
      if (points.empty()) dimmest = k;
      brightest = k;
      out_.flats[k].used = true;
      points.push_back(out_.flats[k].point);
    }
    if (points.size() < 2 ||
        signal_counts(brightest) < (1.0 + kSameLight) * signal_counts(dimmest)) {
      return refuse(dark_name_,
                    "K needs two different levels of light between the dark and %.0f %% of "
                    "saturation, which is %.0f counts, but of the sequences %s; add dimmer ones",
                    100.0 * kLinearPart,
                    out_.dark.point.mean_counts.value + kLinearPart * range_counts(),
                    points.empty()       ? "none lies there"
                    : points.size() == 1 ? "only one lies there"
                                         : "those there are of the same light");
    }
    const Result<PhotonTransfer> fit = fit_photon_transfer(out_.dark.point, points);
    if (!fit) return refuse(out_.flats[brightest].name, "%s", fit.error().message.c_str());
    out_.transfer = fit.value();
    return {};
  }

  void measure_dark() {
    const Measured& k = out_.transfer.k_counts_per_e;
    const Measured& variance = out_.dark.point.variance_counts2;
    out_.mu_dark_counts = out_.dark.point.mean_counts;
    out_.sigma_y_dark_counts = root_of(variance);
    out_.dark_noise_counts = root_of(variance - Measured{kQuantisationVariance_counts2, 0.0});
    out_.dark_noise_e = out_.dark_noise_counts / k;

    std::vector<double> left(dark_.pixels());
    for (std::size_t i = 0; i < left.size(); ++i) left[i] = dark_.mean_counts(i);
    const std::vector<double> smooth = smooth_of(left);
    for (std::size_t i = 0; i < left.size(); ++i) left[i] -= smooth[i];
    const auto frames = static_cast<double>(dark_.frames());
    Measured pattern = pattern_variance(left, out_.defects.defect);
    // What is cut off at 0 would have been further from the mean.
    pattern.sigma = std::hypot(pattern.sigma, 2.0 * out_.dark.clipped_share * pattern.value);
    const Measured noise = {
        variance.value / frames,
        std::hypot(variance.sigma / frames, still_rounding_counts2(variance.value))};
    out_.dsnu_counts = root_of(pattern - noise);
    out_.dsnu_e = out_.dsnu_counts / k;
    out_.offset_map_noise_counts = std::sqrt(noise.value);
  }

  Response response_to(std::size_t level) const {
    const PixelStatistics& lit = flat(level);
    std::vector<double> signal(lit.pixels());
    for (std::size_t i = 0; i < signal.size(); ++i)
      signal[i] = lit.mean_counts(i) - dark_.mean_counts(i);
    const std::vector<double> light = smooth_of(signal);

    Response out;
    out.ratio.assign(signal.size(), 1.0);
    const auto lit_frames = static_cast<double>(lit.frames());
    const auto dark_frames = static_cast<double>(dark_.frames());
    double n = 0.0;
    double noise = 0.0;
    double weights = 0.0;
    for (std::size_t i = 0; i < signal.size(); ++i) {
      if (out_.defects.defect[i] != 0) continue;
      out.ratio[i] = signal[i] / light[i];
      const double weight = 1.0 / squared(light[i]);
      noise +=
          weight * (lit.variance_counts2(i) / lit_frames + dark_.variance_counts2(i) / dark_frames);
      weights += weight;
      n += 1.0;
    }
    const double mean =
        std::accumulate(light.begin(), light.end(), 0.0) / static_cast<double>(light.size());
    // What all pixels share makes no pattern: of the light in proportion, of the dark level alike.
    const double shared = n * squared(out_.flats[level].flicker_counts / mean) / lit_frames +
                          weights * squared(out_.dark.flicker_counts) / dark_frames;
    out.noise_variance = {std::max(0.0, noise - shared) / n,
                          std::hypot(out_.flats[level].point.variance_counts2.sigma / lit_frames,
                                     out_.dark.point.variance_counts2.sigma / dark_frames) *
                              weights / n};
    const auto [least, most] = std::ranges::minmax_element(light);
    out.light_range = (*most - *least) / mean;
    out.least_light = *least / mean;
    return out;
  }

  Result<void> measure_response() {
    const Response gain = response_to(out_.gain_level);
    if (!(gain.least_light > kDarkestCorner)) {
      return refuse(out_.flats[out_.gain_level].name,
                    "its light falls to %.0f %% of the mean in places; light the whole sensor",
                    100.0 * gain.least_light);
    }
    out_.light_range_ratio = gain.light_range;
    out_.gain_map_noise_ratio = std::sqrt(gain.noise_variance.value);
    fill_maps(gain.ratio);

    const auto distance = [this](std::size_t k) {
      return std::abs(signal_counts(k) / range_counts() - kPrnuPart);
    };
    for (std::size_t k = 1; k <= out_.gain_level; ++k) {
      if (distance(k) < distance(out_.prnu_level)) out_.prnu_level = k;
    }
    Response half = out_.prnu_level == out_.gain_level ? gain : response_to(out_.prnu_level);
    for (double& value : half.ratio) value -= 1.0;
    out_.prnu_ratio =
        root_of(pattern_variance(half.ratio, out_.defects.defect) - half.noise_variance);
    return {};
  }

  void fill_maps(const std::vector<double>& gain) {
    SensorMaps& maps = out_.maps;
    maps.width_px = out_.format.width_px;
    maps.height_px = out_.format.height_px;
    maps.defect = out_.defects.defect;
    maps.offset_counts.resize(gain.size());
    maps.gain_ratio.resize(gain.size());
    for (std::size_t i = 0; i < gain.size(); ++i) {
      const bool good = maps.defect[i] == 0;
      maps.offset_counts[i] =
          static_cast<float>(good ? dark_.mean_counts(i) : out_.mu_dark_counts.value);
      maps.gain_ratio[i] = static_cast<float>(gain[i]);
    }
  }

  void measure_saturation() {
    const Measured& k = out_.transfer.k_counts_per_e;
    out_.saturation_e = (out_.saturation_counts - out_.mu_dark_counts) / k;
    const Measured& most = out_.saturation_e;
    out_.snr_max_ratio = {std::sqrt(most.value), 0.5 * most.sigma / std::sqrt(most.value)};
    // Signal and noise are equal where mu^2 = (sigma_y.dark / K)^2 + mu.
    const Measured dark = out_.sigma_y_dark_counts / k;
    const double root = std::sqrt(squared(dark.value) + 0.25);
    out_.dynamic_range_ratio = most / Measured{root + 0.5, dark.value / root * dark.sigma};
  }

  /// The line that keeps the relative departures small.
  void measure_linearity() {
    std::vector<std::size_t> levels;
    std::array<double, 5> sums{};  // of 1, x, xx, y and xy, each over y^2
    for (std::size_t k = 0; k <= out_.gain_level; ++k) {
      const double x = out_.flats[k].exposure_us;
      const double y = signal_counts(k);
      const bool inside =
          y >= kLinearityFrom * range_counts() && y <= kLinearityTo * range_counts();
      if (!(x > 0.0) || !inside) continue;
      levels.push_back(k);
      const std::array<double, 5> terms = {1.0, x, x * x, y, x * y};
      for (std::size_t i = 0; i < terms.size(); ++i) sums[i] += terms[i] / (y * y);
    }
    constexpr std::size_t kLeastLevels = 3;
    constexpr double kLeastSpread = 1e-9;
    const double determinant = sums[0] * sums[2] - sums[1] * sums[1];
    if (levels.size() < kLeastLevels || !(determinant > kLeastSpread * sums[0] * sums[2])) return;
    Linearity& out = out_.linearity;
    out.slope_counts_per_us = (sums[0] * sums[4] - sums[1] * sums[3]) / determinant;
    out.offset_counts = (sums[3] - out.slope_counts_per_us * sums[1]) / sums[0];
    double error = 0.0;
    double variance = 0.0;
    for (const std::size_t k : levels) {
      const double line = out.offset_counts + out.slope_counts_per_us * out_.flats[k].exposure_us;
      error += std::abs(signal_counts(k) - line) / line;
      variance += squared(out_.flats[k].point.mean_counts.sigma / line);
    }
    const auto n = static_cast<double>(levels.size());
    out.error_ratio = {error / n, std::sqrt(variance) / n};
  }

  const PixelStatistics& dark_;
  const std::string& dark_name_;
  const std::vector<LightSequence>& flats_;
  std::vector<std::size_t> order_;  // of the flats, from dim to bright
  CameraCharacterisation out_;
};

}  // namespace

Result<CameraCharacterisation> characterise_camera(const LightSequence& dark,
                                                   const std::vector<LightSequence>& flats) {
  try {
    return Evaluation(dark, flats).run();
  } catch (const std::bad_alloc&) {
    return refuse(dark.name, "there is not enough memory for frames of this size");
  }
}

Calibration with_camera(const Calibration& base, const CameraCharacterisation& camera) {
  Calibration out = base;
  out.noise_mean_counts = camera.mu_dark_counts.value;
  out.noise_sd_counts = camera.dark_noise_counts.value;
  out.format = SensorFormat{.width_px = camera.format.width_px,
                            .height_px = camera.format.height_px,
                            .bit_depth = camera.format.bit_depth};
  CameraRecord& record = out.camera.emplace();
  const auto put = [](const Measured& from, double& value, double& sigma) {
    value = from.value;
    sigma = from.sigma;
  };
  put(camera.transfer.k_counts_per_e, record.k_counts_per_e, record.sigma_k_counts_per_e);
  put(camera.dark_noise_e, record.dark_noise_e, record.sigma_dark_noise_e);
  put(camera.dsnu_e, record.dsnu_e, record.sigma_dsnu_e);
  put(camera.prnu_ratio, record.prnu_ratio, record.sigma_prnu_ratio);
  put(camera.saturation_counts, record.saturation_counts, record.sigma_saturation_counts);
  put(camera.saturation_e, record.saturation_e, record.sigma_saturation_e);
  record.saturation_reached = camera.saturation_reached;
  record.dark_frames = static_cast<int>(camera.dark.frames);
  record.flat_levels = static_cast<int>(camera.flats.size());
  for (const LightLevel& level : camera.flats) record.flat_frames += static_cast<int>(level.frames);
  return out;
}

}  // namespace lsv
