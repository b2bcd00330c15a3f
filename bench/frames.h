// SPDX-License-Identifier: BSD-3-Clause
// The simulated frames that every method of one run is timed on, and the check of its answers.
#pragma once

#include <cstdint>
#include <string>

#include "tools/simulated_loop.h"

namespace lsv::bench {

inline constexpr int kSizes_px[] = {64, 128, 256};
inline constexpr double kMaxStep_px = 5.0;
inline constexpr int kFrames = 4;
inline constexpr std::uint64_t kSeed = 20240611;

/// Square frames of the default simulated camera: 4 px speckle, rounded, clipped, camera noise.
sim::SpeckleConfig camera(int side_px, int bit_depth);

/// Rendered at the first call for a size and bit depth. Ends the program when that fails.
const cli::SimulatedLoop& frames(int side_px, int bit_depth);

/// Default settings with the calibration of the simulated camera.
TrackConfig track_config(Engine engine = Engine::zncc);

/// What an answer may be off on these frames: several times the errors measured, far below those
/// of a wrong peak, a wrong sign or swapped axes.
double tolerance_px(Engine engine, PeakFit fit);

struct Answer {
  double dx_px = 0.0;
  double dy_px = 0.0;
};

/// Empty when both axes are within `tolerance_px` of the truth; else a sentence.
std::string wrong(const Answer& answer, const cli::TrueShift& truth, double tolerance_px);

}  // namespace lsv::bench
