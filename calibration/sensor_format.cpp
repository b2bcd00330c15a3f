// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/sensor_format.h"

namespace lsv {
namespace {

std::string text_of(int width_px, int height_px, int bit_depth) {
  return std::to_string(width_px) + " x " + std::to_string(height_px) + " px with " +
         std::to_string(bit_depth) + " bit";
}

/// n >= 2 when both sides of the frames are an n-th of the calibrated ones, else 0.
int binning(const SensorFormat& calibrated, const FrameFormat& frames) {
  const int n = calibrated.width_px / frames.width_px;
  const bool fits = n >= 2 && n * frames.width_px == calibrated.width_px &&
                    n * frames.height_px == calibrated.height_px;
  return fits ? n : 0;
}

}  // namespace

Result<void> check_format(const Calibration& calibration, const std::string& calibration_path,
                          const FrameFormat& whole) {
  if (!calibration.format) return {};
  const SensorFormat& format = *calibration.format;
  if (whole.width_px == format.width_px && whole.height_px == format.height_px &&
      whole.bit_depth == format.bit_depth)
    return {};
  std::string sentence = calibration_path + ": is for frames of " +
                         text_of(format.width_px, format.height_px, format.bit_depth) +
                         " ([format]), but these are " +
                         text_of(whole.width_px, whole.height_px, whole.bit_depth);
  if (const int n = binning(format, whole); n > 0) {
    const std::string times = std::to_string(n);
    sentence += ", which looks binned by " + times + ": the pixel pitch would then be " + times +
                " times as large, so give a calibration of the binned camera";
  } else {
    sentence += "; set the camera as it was, or calibrate it as it is";
  }
  return Error{ErrorCode::bad_input, std::move(sentence)};
}

}  // namespace lsv
