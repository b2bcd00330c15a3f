// SPDX-License-Identifier: BSD-3-Clause
// The drawings of the report of `lsv calibrate camera`, each a piece of markup that needs no other
// file.
#pragma once

#include <string>

#include "calibration/camera_characterisation.h"

namespace lsv::cli {

/// Noise over signal with the line that gives K, and how far each level is from it.
std::string photon_transfer_plot(const CameraCharacterisation& camera);

/// Signal over exposure and the departures from the line; empty without exposures.
std::string linearity_plot(const CameraCharacterisation& camera);

/// How many pixels have which dark level, and which response: logarithmic, with a Gaussian of the
/// same spread and the limits beyond which a pixel is defect.
std::string offset_histogram(const CameraCharacterisation& camera);
std::string gain_histogram(const CameraCharacterisation& camera);

/// The three maps as grey pictures.
std::string map_pictures(const CameraCharacterisation& camera);

}  // namespace lsv::cli
