// SPDX-License-Identifier: BSD-3-Clause
// The options of `lsv simulate` that say how the pattern moves.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <string>

#include "lsv/core/result.h"
#include "sim/motion_profile.h"

namespace lsv::cli {

struct MotionOptions {
  std::string profile = "drive";
  double speed_px = 3.0;
  double speed_y_px = 0.0;
  double period_frames = 100.0;
};

inline constexpr const char* kMotionHelp =
    "Profiles: parked, constant, drive (speed up, stop, reverse), sinusoid, random, or a CSV file\n"
    "with the columns x_px and y_px, one row per frame (a truth.csv will do).\n";

/// `options` must outlive the command.
void add_motion_options(CLI::App& command, MotionOptions& options);

/// The motion over frames 0 .. frames - 1; invalid_argument for what cannot be.
Result<sim::MotionProfile> motion_profile(const MotionOptions& options, std::int64_t frames,
                                          std::uint64_t seed);

}  // namespace lsv::cli
