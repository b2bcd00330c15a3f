// SPDX-License-Identifier: BSD-3-Clause
// What `lsv calibrate camera` says about a camera: a table for the terminal, JSON for programs, and
// a page with drawings that needs no network.
#pragma once

#include <string>
#include <vector>

#include "calibration/camera_characterisation.h"

namespace lsv::cli {

struct CameraReport {
  Calibration calibration;  // the new one
  CameraCharacterisation camera;
  std::vector<std::string> warnings;
};

std::string camera_text(const CameraReport& report);
/// Schema lsv.camera/1; null where unknown.
std::string camera_json(const CameraReport& report);
std::string camera_html(const CameraReport& report);

}  // namespace lsv::cli
