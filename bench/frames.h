// SPDX-License-Identifier: BSD-3-Clause
// The simulated frames that every method of one run is timed on.
#pragma once

#include <cstdint>

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

/// A steady drive: constant speed along both axes, for as long as the pattern stays in sight of its
/// start, then back.
inline constexpr double kDriveX_px = 1.3;
inline constexpr double kDriveY_px = 0.4;
const cli::SimulatedLoop& drive(int side_px, int bit_depth);

/// Default settings with the calibration of the simulated camera.
TrackConfig track_config(Engine engine = Engine::zncc);

}  // namespace lsv::bench
