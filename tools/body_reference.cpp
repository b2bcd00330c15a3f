// SPDX-License-Identifier: BSD-3-Clause
#include "tools/body_reference.h"

#include <filesystem>
#include <utility>

#include "calibration/sha256.h"
#include "lsv/ingest/csv_table.h"
#include "lsv/ingest/trajectory_file.h"

namespace lsv::cli {
namespace {

Error at(const std::string& name, std::size_t line, const std::string& sentence) {
  return {ErrorCode::bad_input, name + ":" + std::to_string(line) + ": " + sentence};
}

/// Without sigmas.
ReferencePose reference_pose(const TrajectoryPose& pose) {
  return {
      .stamp = pose.stamp, .x_m = pose.x_m, .y_m = pose.y_m, .yaw_rad = heading_rad(pose.rotation)};
}

/// A sigma from its column or from the option that stands for it.
class SigmaSource {
 public:
  static Result<SigmaSource> find(const CsvTable& table, const char* column, const char* option,
                                  std::optional<double> given) {
    if (table.has(column) && given) {
      return Error{ErrorCode::bad_input,
                   table.name() + ": has a column " + column + "; leave " + option + " out"};
    }
    if (!table.has(column) && !given) {
      return Error{ErrorCode::bad_input,
                   table.name() + ": no column " + column + "; or give " + option};
    }
    SigmaSource out(table);
    out.given_ = given;
    if (!given) out.column_ = table.column(column).value();
    return out;
  }

  Result<double> at_row(std::size_t row) const {
    return given_ ? Result<double>(*given_) : table_->known_number(row, column_);
  }

 private:
  explicit SigmaSource(const CsvTable& table) : table_(&table) {}
  const CsvTable* table_;
  std::optional<double> given_;
  std::size_t column_ = 0;
};

Result<BodyReference> poses_of(const CsvTable& table, const ReferenceSigmas& sigmas) {
  const Result<std::size_t> yaw = table.column("yaw_rad");
  if (!yaw) return yaw.error();
  const Result<TrajectoryFile> file = trajectory_of(table);
  if (!file) return file.error();
  if (file.value().rows_skipped > 0)
    return at(table.name(), file.value().first_skipped_line, "x_m, y_m or yaw_rad is empty");
  const Result<SigmaSource> sigma =
      SigmaSource::find(table, "sigma_m", "--sigma-reference-m", sigmas.sigma_m);
  if (!sigma) return sigma.error();
  const Result<SigmaSource> sigma_yaw =
      SigmaSource::find(table, "sigma_yaw_rad", "--sigma-reference-rad", sigmas.sigma_yaw_rad);
  if (!sigma_yaw) return sigma_yaw.error();

  BodyReference out;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    ReferencePose pose = reference_pose(file.value().trajectory.poses[row]);
    const Result<double> sigma_m = sigma.value().at_row(row);
    if (!sigma_m) return sigma_m.error();
    const Result<double> sigma_yaw_rad = sigma_yaw.value().at_row(row);
    if (!sigma_yaw_rad) return sigma_yaw_rad.error();
    pose.sigma_m = sigma_m.value();
    pose.sigma_yaw_rad = sigma_yaw_rad.value();
    if (!(pose.sigma_m > 0.0 && pose.sigma_yaw_rad > 0.0))
      return at(table.name(), table.line(row), "a sigma must be above 0");
    out.push_back(pose);
  }
  return out;
}

BodyReference poses_of(const TrajectoryFile& file, const ReferenceSigmas& sigmas) {
  BodyReference out;
  for (const TrajectoryPose& from : file.trajectory.poses) {
    ReferencePose pose = reference_pose(from);
    pose.sigma_m = *sigmas.sigma_m;
    pose.sigma_yaw_rad = *sigmas.sigma_yaw_rad;
    out.push_back(pose);
  }
  return out;
}

Result<BodyReference> tum_poses(std::string text, const std::string& path,
                                const ReferenceSigmas& sigmas) {
  if (!sigmas.sigma_m || !sigmas.sigma_yaw_rad) {
    return Error{ErrorCode::bad_input,
                 path +
                     ": a .tum file tells no sigmas; give --sigma-reference-m and "
                     "--sigma-reference-rad"};
  }
  const Result<TrajectoryFile> file =
      parse_trajectory(std::move(text), path, TrajectoryFormat::tum);
  if (!file) return file.error();
  return poses_of(file.value(), sigmas);
}

Result<BodyReference> csv_poses(std::string text, const std::string& path,
                                const ReferenceSigmas& sigmas) {
  const Result<CsvTable> table = CsvTable::parse(std::move(text), path);
  if (!table) return table.error();
  return poses_of(table.value(), sigmas);
}

}  // namespace

Result<ReferenceFile> read_body_reference(const std::string& path, const ReferenceSigmas& sigmas) {
  Result<std::string> text = read_trajectory_text(path);
  if (!text) return text.error();
  std::string sha256 = sha256_hex(text.value());
  const bool is_tum = std::filesystem::path(path).extension() == ".tum";
  Result<BodyReference> poses = is_tum ? tum_poses(std::move(text).value(), path, sigmas)
                                       : csv_poses(std::move(text).value(), path, sigmas);
  if (!poses) return poses.error();
  return ReferenceFile{.poses = std::move(poses).value(), .sha256 = std::move(sha256)};
}

}  // namespace lsv::cli
