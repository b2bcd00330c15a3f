// SPDX-License-Identifier: BSD-3-Clause
#include "tools/body_reference.h"

#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <string_view>
#include <utility>
#include <vector>

#include "calibration/sha256.h"
#include "lsv/ingest/csv_table.h"
#include "lsv/ingest/input_file.h"
#include "lsv/ingest/timestamps.h"

namespace lsv::cli {
namespace {

constexpr std::int64_t kMaxTum_bytes = std::int64_t{1} << 30;
// Positions beyond this are not metres on a ground.
constexpr double kFarthest_m = 1e8;
// Of the length of a quaternion from 1: what a few printed digits leave.
constexpr double kQuaternionRounding = 1e-3;

Error at(const std::string& name, std::size_t line, const std::string& sentence) {
  return {ErrorCode::bad_input, name + ":" + std::to_string(line) + ": " + sentence};
}

std::string quoted(std::string_view text) {
  std::string out(1, '"');
  return out.append(text).append(1, '"');
}

Result<void> check_pose(const std::string& name, std::size_t line, const ReferencePose& pose,
                        const BodyReference& before) {
  if (std::abs(pose.stamp.ns) > kFarthestStamp_ns)
    return at(name, line, "the time is beyond 126 years");
  if (!before.empty() && pose.stamp <= before.back().stamp)
    return at(name, line, "the time does not increase");
  if (!(std::abs(pose.x_m) <= kFarthest_m && std::abs(pose.y_m) <= kFarthest_m))
    return at(name, line, "the position is beyond 1e8 m");
  if (!(pose.sigma_m > 0.0 && pose.sigma_yaw_rad > 0.0))
    return at(name, line, "a sigma must be above 0");
  return {};
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

Error no_pose(const std::string& name) { return {ErrorCode::bad_input, name + ": holds no pose"}; }

Result<BodyReference> poses_of(const CsvTable& table, const ReferenceSigmas& sigmas) {
  std::array<std::size_t, 4> columns{};
  constexpr std::array kNames = {"time_s", "x_m", "y_m", "yaw_rad"};
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    const Result<std::size_t> column = table.column(kNames[i]);
    if (!column) return column.error();
    columns[i] = column.value();
  }
  const Result<SigmaSource> sigma =
      SigmaSource::find(table, "sigma_m", "--sigma-reference-m", sigmas.sigma_m);
  if (!sigma) return sigma.error();
  const Result<SigmaSource> sigma_yaw =
      SigmaSource::find(table, "sigma_yaw_rad", "--sigma-reference-rad", sigmas.sigma_yaw_rad);
  if (!sigma_yaw) return sigma_yaw.error();

  BodyReference out;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const auto time_ns = ns_from_decimal_seconds(table.text(row, columns[0]));
    if (!time_ns) {
      return at(
          table.name(), table.line(row),
          "time_s is \"" + std::string(table.text(row, columns[0])) + "\", not a time in seconds");
    }
    const std::array cells = {table.known_number(row, columns[1]),
                              table.known_number(row, columns[2]),
                              table.known_number(row, columns[3]), sigma.value().at_row(row),
                              sigma_yaw.value().at_row(row)};
    for (const Result<double>& cell : cells) {
      if (!cell) return cell.error();
    }
    const ReferencePose pose{.stamp = {*time_ns},
                             .x_m = cells[0].value(),
                             .y_m = cells[1].value(),
                             .yaw_rad = cells[2].value(),
                             .sigma_m = cells[3].value(),
                             .sigma_yaw_rad = cells[4].value()};
    if (Result<void> sound = check_pose(table.name(), table.line(row), pose, out); !sound)
      return sound.error();
    out.push_back(pose);
  }
  if (out.empty()) return no_pose(table.name());
  return out;
}

std::vector<std::string_view> words_of(std::string_view line) {
  constexpr std::string_view kBlank = " \t\r";
  std::vector<std::string_view> out;
  for (std::size_t begin = line.find_first_not_of(kBlank); begin != std::string_view::npos;
       begin = line.find_first_not_of(kBlank)) {
    line.remove_prefix(begin);
    const std::size_t end = std::min(line.find_first_of(kBlank), line.size());
    out.push_back(line.substr(0, end));
    line.remove_prefix(end);
  }
  return out;
}

Result<ReferencePose> tum_pose(const std::string& name, std::size_t number,
                               const std::vector<std::string_view>& words) {
  if (words.size() != 8) return at(name, number, "must hold t x y z qx qy qz qw");
  const auto time_ns = ns_from_decimal_seconds(words[0]);
  if (!time_ns) return at(name, number, quoted(words[0]) + " is not a time in seconds");
  std::array<double, 7> v{};
  for (std::size_t i = 0; i < v.size(); ++i) {
    const std::string_view word = words[i + 1];
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), v[i]);
    if (error != std::errc() || end != word.data() + word.size() || !std::isfinite(v[i]))
      return at(name, number, quoted(word) + " is not a number");
  }
  const double qx = v[3], qy = v[4], qz = v[5], qw = v[6];
  const double length = std::sqrt(qx * qx + qy * qy + qz * qz + qw * qw);
  if (!(std::abs(length - 1.0) < kQuaternionRounding))
    return at(name, number, "the quaternion is not of length 1");
  return ReferencePose{
      .stamp = {*time_ns},
      .x_m = v[0],
      .y_m = v[1],
      .yaw_rad = std::atan2(2.0 * (qw * qz + qx * qy), qw * qw + qx * qx - qy * qy - qz * qz)};
}

Result<ReferenceFile> read_tum(const std::string& path, const ReferenceSigmas& sigmas) {
  if (!sigmas.sigma_m || !sigmas.sigma_yaw_rad) {
    return Error{ErrorCode::bad_input,
                 path +
                     ": a .tum file tells no sigmas; give --sigma-reference-m and "
                     "--sigma-reference-rad"};
  }
  std::vector<std::uint8_t> bytes;
  if (Result<void> read = read_regular_file(path, kMaxTum_bytes, bytes); !read) return read.error();
  std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  ReferenceFile out;
  out.sha256 = sha256_hex(text);
  for (std::size_t number = 1; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::vector<std::string_view> words = words_of(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
    if (words.empty() || words[0].front() == '#') continue;
    Result<ReferencePose> pose = tum_pose(path, number, words);
    if (!pose) return pose.error();
    pose.value().sigma_m = *sigmas.sigma_m;
    pose.value().sigma_yaw_rad = *sigmas.sigma_yaw_rad;
    if (Result<void> sound = check_pose(path, number, pose.value(), out.poses); !sound)
      return sound.error();
    out.poses.push_back(pose.value());
  }
  if (out.poses.empty()) return no_pose(path);
  return out;
}

}  // namespace

Result<ReferenceFile> read_body_reference(const std::string& path, const ReferenceSigmas& sigmas) {
  if (std::filesystem::path(path).extension() == ".tum") return read_tum(path, sigmas);
  const Result<CsvTable> table = CsvTable::read(path);
  if (!table) return table.error();
  Result<BodyReference> poses = poses_of(table.value(), sigmas);
  if (!poses) return poses.error();
  return ReferenceFile{.poses = std::move(poses).value(),
                       .sha256 = sha256_hex(table.value().bytes())};
}

}  // namespace lsv::cli
