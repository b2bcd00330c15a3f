// SPDX-License-Identifier: BSD-3-Clause
// A camera characterised from dark frames and frames of even light at several levels, after EMVA
// 1288 release 4.0, linear model; the symbols are those of the standard. docs/camera.md tells what
// is computed and where it departs from the standard.
//
// Every figure has one standard deviation: of the estimate, and for DSNU1288 and PRNU1288 also of
// the finite number of pixels, as for a sensor of the same make. What light and temperature did to
// the frames is not in it.
// Pure functions; they allocate, about 50 bytes a pixel beside the statistics.
#pragma once

#include <string>
#include <vector>

#include "calibration/defect_pixels.h"
#include "calibration/light_level.h"
#include "calibration/measured.h"
#include "calibration/photon_transfer.h"
#include "calibration/pixel_statistics.h"
#include "lsv/core/calibration.h"
#include "lsv/core/sensor_maps.h"

namespace lsv {

/// Frames of constant light.
struct LightSequence {
  std::string name;  // for messages
  PixelStatistics statistics;
  double exposure_us = kUnknown;  // or anything in proportion to the light
};

/// Signals nearer than this to each other are of the same light.
inline constexpr double kSameLight = 0.05;
/// K is fitted up to this part of the saturation.
inline constexpr double kLinearPart = 0.7;

/// A straight line over the exposure, and how far the levels are from it.
struct Linearity {
  Measured error_ratio{};  // LE: mean of the relative departures; unknown without exposures
  double offset_counts = kUnknown;  // signal = offset + slope * exposure
  double slope_counts_per_us = kUnknown;
};

struct CameraCharacterisation {
  FrameFormat format{};
  LightLevel dark{};
  std::vector<LightLevel> flats{};  // from dim to bright
  bool given_in_order = true;

  PhotonTransfer transfer{};  // K
  Measured mu_dark_counts{};
  Measured sigma_y_dark_counts{};  // temporal noise in the dark as it is in the frames
  Measured dark_noise_counts{};    // K sigma_d: the same without quantisation noise
  Measured dark_noise_e{};         // sigma_d
  Measured dsnu_counts{};
  Measured dsnu_e{};                // DSNU1288
  Measured prnu_ratio{};            // PRNU1288
  bool saturation_reached = false;  // else the next four are lower bounds
  Measured saturation_counts{};     // mu_y.sat
  Measured saturation_e{};          // mu_e.sat
  Measured snr_max_ratio{};         // sqrt(mu_e.sat)
  Measured dynamic_range_ratio{};   // mu_e.sat / mu_e.min
  Linearity linearity{};

  DefectPixels defects{};
  SensorMaps maps{};
  std::size_t gain_level = 0;            // the one of `flats` that the gain map is from
  std::size_t prnu_level = 0;            // and PRNU1288
  double light_range_ratio = 0.0;        // of the smooth light: (most - least) / mean
  double offset_map_noise_counts = 0.0;  // what is left of the temporal noise in the maps
  double gain_map_noise_ratio = 0.0;
};

/// bad_input, naming the sequence, when the sequences do not fit together or do not tell K.
Result<CameraCharacterisation> characterise_camera(const LightSequence& dark,
                                                   const std::vector<LightSequence>& flats);

/// `base` with the camera that was measured: [camera], [format] and the figures of [emva1288].
/// Date, method, inputs and the maps file are for the caller to fill in.
Calibration with_camera(const Calibration& base, const CameraCharacterisation& camera);

}  // namespace lsv
