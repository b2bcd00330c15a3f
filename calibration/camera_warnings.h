// SPDX-License-Identifier: BSD-3-Clause
// What a person must know before trusting a characterisation of a camera.
#pragma once

#include <string>
#include <vector>

#include "calibration/camera_characterisation.h"

namespace lsv {

/// A sentence each.
std::vector<std::string> camera_warnings(const CameraCharacterisation& camera);

}  // namespace lsv
