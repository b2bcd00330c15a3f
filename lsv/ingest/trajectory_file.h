// SPDX-License-Identifier: BSD-3-Clause
// Trajectories from text files (docs/formats.md#trajectories):
//   CSV    columns by name: time_s, x_m, y_m and optionally yaw_rad and the covariance
//          cov_xx_m2, cov_xy_m2, cov_yy_m2 with cov_xyaw_m_rad, cov_yyaw_m_rad, cov_yawyaw_rad2
//   TUM    lines `t x y z qx qy qz qw`
//   KITTI  lines of the upper 3 x 4 of a pose matrix, row by row, without time
// Decimal seconds become int64 ns without passing through a double; stamps increase strictly.
// Positions lie within 1e8 m. Errors: bad_input, naming file, line and field.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "lsv/core/result.h"
#include "lsv/core/trajectory.h"
#include "lsv/ingest/csv_table.h"

namespace lsv {

enum class TrajectoryFormat { csv, tum, kitti };
/// `csv`, `tum`, `kitti`
std::string_view word(TrajectoryFormat format);

struct TrajectoryFile {
  Trajectory trajectory;
  TrajectoryFormat format = TrajectoryFormat::csv;
  std::size_t rows_skipped = 0;        // CSV: the pose is not known
  std::size_t first_skipped_line = 0;  // 0: none
};

/// The bytes of a regular file, up to 1 GiB.
Result<std::string> read_trajectory_text(const std::string& path);

/// By the extension of `name`: .csv, .tum, .kitti; .txt by the columns of the first line, 8 or 12.
Result<TrajectoryFormat> trajectory_format(const std::string& name, std::string_view text);

/// Up to 2^24 poses, at least one.
Result<TrajectoryFile> parse_trajectory(std::string text, const std::string& name,
                                        TrajectoryFormat format);
Result<TrajectoryFile> trajectory_of(const CsvTable& table);

}  // namespace lsv
