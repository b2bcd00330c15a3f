// SPDX-License-Identifier: BSD-3-Clause
#include "tools/track_settings.h"

#include <optional>
#include <sstream>

namespace lsv::cli {
namespace {

/// Defaults are shown from the structs that hold them, never restated.
template <typename T>
std::string shown(const T& value) {
  std::ostringstream out;
  out << value;
  return out.str();
}

template <typename Value>
Settings::Parse one_of(Value& target, std::optional<Value> (*from)(std::string_view),
                       const char* words) {
  return {"WORD", [&target, from, words](const std::string& text) -> Result<std::string> {
            const std::optional<Value> value = from(text);
            if (!value)
              return Error{ErrorCode::invalid_argument, "'" + text + "' is not one of " + words};
            target = *value;
            return toml_text(text);
          }};
}

}  // namespace

void add_source_settings(CLI::App& command, Settings& settings, SourceOptions& source) {
  settings.add(command, "rate_hz", "--rate-hz", "Frame rate, Hz; there is no default rate", "",
               number(source.rate_hz));
  settings.add(command, "timestamps", "--timestamps", "File with one time stamp per frame", "",
               text(source.timestamps_path));
  settings.exclude("rate_hz", "timestamps");
  settings.add(command, "raw", "--raw", "Headerless pixels: WxH:mono8|10|12|14|16[:header_bytes]",
               "", parsed_by(source.raw, "FORMAT", parse_raw_format));
  settings.add(command, "bit_depth", "--bit-depth",
               "Significant bits of 16-bit pixels, where the file does not say", "",
               whole(source.bit_depth));
  settings.add(command, "roi", "--roi", "Region of the frames to use, px: x,y,w,h", "",
               parsed_by(source.roi, "X,Y,W,H", parse_roi));
  settings.add(command, "start", "--start", "First frame index used", shown(source.start),
               whole(source.start));
  settings.add(command, "stop", "--stop", "First frame index not used", "", whole(source.stop));
  settings.add(command, "step", "--step", "Use every step-th frame", shown(source.step),
               whole(source.step));
  settings.add_switch(command, "ignore_numbers", "--ignore-numbers",
                      "Gaps in numbered names are not missing frames", source.ignore_numbers);
}

namespace {

void add_correlation(CLI::App& command, Settings& settings, CorrelationConfig& correlation) {
  settings.add(command, "engine", "--engine", "Of the full search: zncc, cross, phase or direct",
               std::string(word(correlation.engine)),
               one_of(correlation.engine, engine_from, "zncc, cross, phase, direct"));
  settings.add(
      command, "peak_fit", "--peak-fit",
      "Of the full search: sinc, gaussian2d, gaussian3 or parabola3",
      std::string(word(correlation.peak_fit)),
      one_of(correlation.peak_fit, peak_fit_from, "sinc, gaussian2d, gaussian3, parabola3"));
  settings.add(command, "max_shift_px", "--max-shift",
               "Largest shift searched along each axis, px; unset: 32 or half the frame", "",
               whole(correlation.max_shift_px));
}

void add_gate(CLI::App& command, Settings& settings, GateConfig& gate) {
  const auto add = [&](const char* key, const char* flag, const char* help, double& target) {
    settings.add(command, key, flag, help, shown(target), number(target));
  };
  add("min_zncc", "--min-zncc", "Refuse shifts with a lower peak ZNCC, -1 to 1", gate.min_zncc);
  add("min_zncc_sigmas", "--min-zncc-sigmas",
      "Refuse shifts whose ZNCC is fewer standard deviations of chance", gate.min_zncc_sigmas);
  add("min_q", "--min-q", "Refuse shifts with a lower Q (peak / mean level)", gate.min_q);
  add("min_peak_ratio", "--min-peak-ratio", "Refuse shifts whose second peak is closer than this",
      gate.min_peak_ratio);
  add("min_signal_fraction", "--min-signal",
      "Frames with less mean signal, as a fraction of full scale, are dark",
      gate.min_signal_fraction);
  add("max_saturated_fraction", "--max-saturated",
      "Frames with a larger fraction of pixels at full scale are saturated",
      gate.max_saturated_fraction);
  add("min_contrast_to_noise", "--min-contrast",
      "Frames whose pixel spread over camera noise is lower have low contrast",
      gate.min_contrast_to_noise);
  settings.add_switch(command, "refuse_frozen", "--refuse-frozen,!--allow-frozen",
                      "Whether bit-identical frames of a noisy camera are refused [true]",
                      gate.refuse_frozen);
  settings.add_switch(
      command, "refuse_inconsistent", "--refuse-inconsistent,!--allow-inconsistent",
      "Whether frames with rows that do not show the motion of the others are refused [true]",
      gate.refuse_inconsistent);
}

}  // namespace

void add_track_settings(CLI::App& command, Settings& settings, TrackSettings& target) {
  add_source_settings(command, settings, target.source);
  add_measuring_settings(command, settings, target);
}

void add_measuring_settings(CLI::App& command, Settings& settings, TrackSettings& target) {
  settings.add(command, "calibration", "--calibration", "Calibration file (TOML)", "",
               text(target.calibration_path));
  settings.add(command, "preset", "--preset",
               "precise (keyframes and IC-GN), fast (keyframes) or classic (frame to frame by FFT)",
               std::string(word(target.config.preset)),
               one_of(target.config.preset, preset_from, "precise, fast, classic"));
  settings.add_switch(command, "deformation", "--deformation,!--no-deformation",
                      "Measure rotation and expansion too (JSON Lines) [false]",
                      target.config.measure_deformation);
  settings.add_switch(command, "learn_fixed_pattern",
                      "--learn-fixed-pattern,!--no-learn-fixed-pattern",
                      "Learn dirt and uneven light while driving and take them out [true]",
                      target.config.learn_fixed_pattern);
  add_correlation(command, settings, target.config.correlation);
  add_gate(command, settings, target.config.gate);
  settings.add(command, "max_rejected_share", "--max-rejected",
               "Exit with 4 when a larger share of the shifts is refused, 0 to 1",
               shown(target.max_rejected_share), number(target.max_rejected_share));
}

}  // namespace lsv::cli
