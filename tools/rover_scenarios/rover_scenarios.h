// SPDX-License-Identifier: BSD-3-Clause
// The scenarios as text, embedded by CMake.
#pragma once

#include <string_view>

namespace lsv::cli::scenarios {

extern const std::string_view appendix_d;
extern const std::string_view hard_ground;
extern const std::string_view lsv_lost;
extern const std::string_view noisy_encoders;
extern const std::string_view outliers;
extern const std::string_view random_drive;
extern const std::string_view sand_crossing;
extern const std::string_view side_slip;
extern const std::string_view square_sand;
extern const std::string_view velocity_step;

}  // namespace lsv::cli::scenarios
