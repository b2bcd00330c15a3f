// SPDX-License-Identifier: BSD-3-Clause
// The drawings of a mount calibration as SVG: the vehicle from above with its sensors, and what the
// fit leaves over time.
#pragma once

#include <string>

#include "tools/mount_report.h"

namespace lsv::cli {

inline constexpr std::string_view kForwardColour = "#2f80ed";
inline constexpr std::string_view kLeftColour = "#d9542b";

/// Forward is up, left is left. Ellipses hold 2 sigma, magnified by a power of ten where they would
/// be too small to see; the caption says so.
std::string vehicle_svg(const MountReport& report);

/// Reference less fit in body axes: poses as dots, means of neighbouring ones as a line, 2 sigma of
/// the reference as a band.
std::string residuals_svg(const MountFit& fit);

}  // namespace lsv::cli
