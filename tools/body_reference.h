// SPDX-License-Identifier: BSD-3-Clause
// A reference trajectory of the body from a file: a CSV table with the columns time_s, x_m, y_m,
// yaw_rad and, where the sigmas differ from pose to pose, sigma_m and sigma_yaw_rad; or, with the
// extension .tum, lines `t x y z qx qy qz qw` with blanks between. Frames: docs/mount.md.
#pragma once

#include <optional>
#include <string>

#include "calibration/drive.h"
#include "lsv/core/result.h"

namespace lsv::cli {

/// For a file that does not tell its sigmas. Above 0.
struct ReferenceSigmas {
  std::optional<double> sigma_m;
  std::optional<double> sigma_yaw_rad;
};

struct ReferenceFile {
  BodyReference poses;
  std::string sha256;
};

/// bad_input, naming file and line, for a table that is malformed, whose times do not increase or
/// whose sigmas are missing, not above 0, or given twice.
Result<ReferenceFile> read_body_reference(const std::string& path, const ReferenceSigmas& sigmas);

}  // namespace lsv::cli
