// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/ingest/trajectory_file.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "lsv/ingest/input_file.h"
#include "lsv/ingest/timestamps.h"

namespace lsv {
namespace {

constexpr std::int64_t kMaxFile_bytes = std::int64_t{1} << 30;
constexpr std::size_t kMaxPoses = std::size_t{1} << 24;
// Positions beyond this are not metres on a ground.
constexpr double kFarthest_m = 1e8;
// Of the length of a quaternion from 1, or of an axis of a matrix: what a few printed digits leave.
constexpr double kRotationRounding = 1e-3;

constexpr std::array kTumFields = {"t", "x", "y", "z", "qx", "qy", "qz", "qw"};
constexpr std::array kKittiFields = {"r11", "r12", "r13", "tx",  "r21", "r22",
                                     "r23", "ty",  "r31", "r32", "r33", "tz"};

Error at(const std::string& name, std::size_t line, const std::string& sentence) {
  return {ErrorCode::bad_input, name + ":" + std::to_string(line) + ": " + sentence};
}

std::string quoted(std::string_view text) {
  constexpr std::size_t kMost = 40;  // of what may be a line of a binary file
  std::string out(1, '"');
  out.append(text.substr(0, kMost));
  return out.append(text.size() > kMost ? "...\"" : "\"");
}

/// The words of a line, blanks between; one more than any format has is as good as many.
class Words {
 public:
  explicit Words(std::string_view line) {
    constexpr std::string_view kBlank = " \t\r";
    while (count_ < words_.size()) {
      const std::size_t begin = line.find_first_not_of(kBlank);
      if (begin == std::string_view::npos) break;
      line.remove_prefix(begin);
      const std::size_t end = std::min(line.find_first_of(kBlank), line.size());
      words_[count_++] = line.substr(0, end);
      line.remove_prefix(end);
    }
  }

  std::size_t count() const { return count_; }
  std::string_view operator[](std::size_t i) const { return words_[i]; }
  bool is_skipped() const { return count_ == 0 || words_[0].front() == '#'; }

 private:
  std::array<std::string_view, kKittiFields.size() + 1> words_;
  std::size_t count_ = 0;
};

/// The lines that are neither empty nor a comment.
class Lines {
 public:
  explicit Lines(std::string_view text) : rest_(text) {
    constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
    if (rest_.starts_with(kByteOrderMark)) rest_.remove_prefix(kByteOrderMark.size());
  }

  /// False at the end.
  bool next() {
    while (!rest_.empty()) {
      const std::size_t end = std::min(rest_.find('\n'), rest_.size());
      words_ = Words(rest_.substr(0, end));
      rest_.remove_prefix(std::min(end + 1, rest_.size()));
      ++number_;
      if (!words_.is_skipped()) return true;
    }
    return false;
  }

  const Words& words() const { return words_; }
  std::size_t number() const { return number_; }

 private:
  std::string_view rest_;
  Words words_{{}};
  std::size_t number_ = 0;
};

/// words[first + i] to out[i].
Result<void> numbers_of(const std::string& name, std::size_t line, const Words& words,
                        std::size_t first, std::span<const char* const> fields,
                        std::span<double> out) {
  for (std::size_t i = 0; i < out.size(); ++i) {
    const std::string_view word = words[first + i];
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), out[i]);
    if (error != std::errc() || end != word.data() + word.size() || !std::isfinite(out[i])) {
      return at(name, line,
                std::string(fields[first + i]) + " is " + quoted(word) + ", not a number");
    }
  }
  return {};
}

Quaternion of_length_1(double x, double y, double z, double w) {
  const double length = std::sqrt(x * x + y * y + z * z + w * w);
  return {.x = x / length, .y = y / length, .z = z / length, .w = w / length};
}

/// Shepperd's method: of the four ways to write it the one that divides by the largest number.
Quaternion quaternion_of(const std::array<double, 12>& m) {
  const auto r = [&m](std::size_t row, std::size_t column) { return m[4 * row + column]; };
  const std::array<double, 3> diagonal = {r(0, 0), r(1, 1), r(2, 2)};
  const double trace = diagonal[0] + diagonal[1] + diagonal[2];
  if (trace > 0.0)
    return of_length_1(r(2, 1) - r(1, 2), r(0, 2) - r(2, 0), r(1, 0) - r(0, 1), 1.0 + trace);
  const auto i = static_cast<std::size_t>(std::ranges::max_element(diagonal) - diagonal.begin());
  const std::size_t j = (i + 1) % 3;
  const std::size_t k = (i + 2) % 3;
  std::array<double, 3> v{};
  v[i] = 1.0 + r(i, i) - r(j, j) - r(k, k);
  v[j] = r(i, j) + r(j, i);
  v[k] = r(i, k) + r(k, i);
  return of_length_1(v[0], v[1], v[2], r(k, j) - r(j, k));
}

bool is_rotation(const std::array<double, 12>& m) {
  const auto r = [&m](std::size_t row, std::size_t column) { return m[4 * row + column]; };
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t b = 0; b < 3; ++b) {
      const double product = r(0, a) * r(0, b) + r(1, a) * r(1, b) + r(2, a) * r(2, b);
      if (!(std::abs(product - (a == b ? 1.0 : 0.0)) < kRotationRounding)) return false;
    }
  }
  const double determinant = r(0, 0) * (r(1, 1) * r(2, 2) - r(1, 2) * r(2, 1)) -
                             r(0, 1) * (r(1, 0) * r(2, 2) - r(1, 2) * r(2, 0)) +
                             r(0, 2) * (r(1, 0) * r(2, 1) - r(1, 1) * r(2, 0));
  return determinant > 0.0;
}

Result<Stamp> stamp_of(const std::string& name, std::size_t line, const char* field,
                       std::string_view text, const Stamp* before) {
  const auto time_ns = ns_from_decimal_seconds(text);
  if (!time_ns)
    return at(name, line, std::string(field) + " is " + quoted(text) + ", not a time in seconds");
  if (std::abs(*time_ns) > kFarthestStamp_ns)
    return at(name, line, std::string(field) + ": the time is beyond 126 years");
  if (before && *time_ns <= before->ns)
    return at(name, line, std::string(field) + ": the time does not increase");
  return Stamp{*time_ns};
}

/// The last check of every pose.
Result<void> add(const std::string& name, std::size_t line, const TrajectoryPose& pose,
                 Trajectory& to) {
  for (const double value_m : {pose.x_m, pose.y_m, pose.z_m}) {
    if (!(std::abs(value_m) <= kFarthest_m)) return at(name, line, "the position is beyond 1e8 m");
  }
  if (to.poses.size() == kMaxPoses)
    return at(name, line, "more than " + std::to_string(kMaxPoses) + " poses");
  to.poses.push_back(pose);
  return {};
}

Result<void> add_tum(const std::string& name, std::size_t line, const Words& words,
                     Trajectory& to) {
  if (words.count() != kTumFields.size()) return at(name, line, "must hold t x y z qx qy qz qw");
  const Stamp* const before = to.poses.empty() ? nullptr : &to.poses.back().stamp;
  const Result<Stamp> stamp = stamp_of(name, line, kTumFields[0], words[0], before);
  if (!stamp) return stamp.error();
  std::array<double, 7> v{};
  if (Result<void> read = numbers_of(name, line, words, 1, kTumFields, v); !read) return read;
  const double length = std::sqrt(v[3] * v[3] + v[4] * v[4] + v[5] * v[5] + v[6] * v[6]);
  if (!(std::abs(length - 1.0) < kRotationRounding))
    return at(name, line, "qx qy qz qw: the quaternion is not of length 1");
  return add(name, line,
             {.stamp = stamp.value(),
              .x_m = v[0],
              .y_m = v[1],
              .z_m = v[2],
              .rotation = of_length_1(v[3], v[4], v[5], v[6])},
             to);
}

Result<void> add_kitti(const std::string& name, std::size_t line, const Words& words,
                       Trajectory& to) {
  if (words.count() != kKittiFields.size())
    return at(name, line, "must hold the 12 numbers r11 r12 r13 tx r21 ... r33 tz");
  std::array<double, 12> m{};
  if (Result<void> read = numbers_of(name, line, words, 0, kKittiFields, m); !read) return read;
  if (!is_rotation(m)) return at(name, line, "r11 to r33 are not a rotation");
  return add(name, line,
             {.stamp = {static_cast<std::int64_t>(to.poses.size())},
              .x_m = m[3],
              .y_m = m[7],
              .z_m = m[11],
              .rotation = quaternion_of(m)},
             to);
}

/// Columns of a table that holds all of them or none.
template <std::size_t n>
Result<std::optional<std::array<std::size_t, n>>> optional_columns(
    const CsvTable& table, const std::array<const char*, n>& names) {
  std::array<std::size_t, n> out{};
  if (std::ranges::none_of(names, [&table](const char* name) { return table.has(name); }))
    return std::optional<std::array<std::size_t, n>>();
  for (std::size_t i = 0; i < n; ++i) {
    const Result<std::size_t> column = table.column(names[i]);
    if (!column) return column.error();
    out[i] = column.value();
  }
  return std::optional(out);
}

class CsvTrajectory {
 public:
  explicit CsvTrajectory(const CsvTable& table) : table_(table) {}

  Result<TrajectoryFile> read() {
    if (Result<void> found = find_columns(); !found) return found.error();
    Trajectory& to = out_.trajectory;
    to.has_time = true;
    to.has_rotation = yaw_.has_value();
    to.is_planar = true;
    Stamp before{};
    for (std::size_t row = 0; row < table_.rows(); ++row) {
      const Result<Stamp> stamp =
          stamp_of(table_.name(), table_.line(row), "time_s", table_.text(row, columns_[0]),
                   row > 0 ? &before : nullptr);
      if (!stamp) return stamp.error();
      before = stamp.value();
      if (Result<void> added = add_row(row, stamp.value()); !added) return added.error();
    }
    return std::move(out_);
  }

 private:
  Result<void> find_columns() {
    constexpr std::array kNames = {"time_s", "x_m", "y_m"};
    for (std::size_t i = 0; i < kNames.size(); ++i) {
      const Result<std::size_t> column = table_.column(kNames[i]);
      if (!column) return column.error();
      columns_[i] = column.value();
    }
    if (table_.has("yaw_rad")) yaw_ = table_.column("yaw_rad").value();
    const auto position = optional_columns<3>(table_, {"cov_xx_m2", "cov_xy_m2", "cov_yy_m2"});
    if (!position) return position.error();
    position_cov_ = position.value();
    const auto yaw =
        optional_columns<3>(table_, {"cov_xyaw_m_rad", "cov_yyaw_m_rad", "cov_yawyaw_rad2"});
    if (!yaw) return yaw.error();
    yaw_cov_ = yaw.value();
    if (yaw_cov_ && !position_cov_) return table_.column("cov_xx_m2").error();
    return {};
  }

  Result<void> add_row(std::size_t row, Stamp stamp) {
    TrajectoryPose pose{.stamp = stamp, .z_m = 0.0};
    double yaw_rad = 0.0;
    const struct {
      std::optional<std::size_t> column;
      double* to;
    } cells[] = {{columns_[1], &pose.x_m}, {columns_[2], &pose.y_m}, {yaw_, &yaw_rad}};
    for (const auto& [column, to] : cells) {
      if (!column) continue;
      const Result<double> cell = table_.number(row, *column);
      if (!cell) return cell.error();
      *to = cell.value();
    }
    if (std::isnan(pose.x_m) || std::isnan(pose.y_m) || std::isnan(yaw_rad)) {
      if (out_.rows_skipped++ == 0) out_.first_skipped_line = table_.line(row);
      return {};
    }
    if (yaw_) {
      pose.rotation = {
          .x = 0.0, .y = 0.0, .z = std::sin(0.5 * yaw_rad), .w = std::cos(0.5 * yaw_rad)};
    }
    if (Result<void> added = add(table_.name(), table_.line(row), pose, out_.trajectory); !added)
      return added;
    return position_cov_ ? add_covariance(row) : Result<void>();
  }

  Result<void> add_covariance(std::size_t row) {
    PlanarCovariance cov;
    const std::array position = {&cov.xx_m2, &cov.xy_m2, &cov.yy_m2};
    const std::array yaw = {&cov.xyaw_m_rad, &cov.yyaw_m_rad, &cov.yawyaw_rad2};
    for (std::size_t i = 0; i < position.size(); ++i) {
      const Result<double> cell = table_.number(row, (*position_cov_)[i]);
      if (!cell) return cell.error();
      *position[i] = cell.value();
      if (!yaw_cov_) continue;
      const Result<double> yaw_cell = table_.number(row, (*yaw_cov_)[i]);
      if (!yaw_cell) return yaw_cell.error();
      *yaw[i] = yaw_cell.value();
    }
    const struct {
      const char* column;
      double variance;
    } variances[] = {
        {"cov_xx_m2", cov.xx_m2}, {"cov_yy_m2", cov.yy_m2}, {"cov_yawyaw_rad2", cov.yawyaw_rad2}};
    for (const auto& [column, variance] : variances) {
      if (variance < 0.0)
        return at(table_.name(), table_.line(row), std::string(column) + " is below 0");
    }
    out_.trajectory.covariances.push_back(cov);
    return {};
  }

  const CsvTable& table_;
  std::array<std::size_t, 3> columns_{};
  std::optional<std::size_t> yaw_;
  std::optional<std::array<std::size_t, 3>> position_cov_;
  std::optional<std::array<std::size_t, 3>> yaw_cov_;
  TrajectoryFile out_;
};

Error no_pose(const std::string& name) { return {ErrorCode::bad_input, name + ": holds no pose"}; }

}  // namespace

std::string_view word(TrajectoryFormat format) {
  switch (format) {
    case TrajectoryFormat::csv:
      return "csv";
    case TrajectoryFormat::tum:
      return "tum";
    case TrajectoryFormat::kitti:
      return "kitti";
  }
  return "csv";
}

Result<std::string> read_trajectory_text(const std::string& path) {
  std::vector<std::uint8_t> bytes;
  if (Result<void> read = read_regular_file(path, kMaxFile_bytes, bytes); !read)
    return read.error();
  return std::string(bytes.begin(), bytes.end());
}

Result<TrajectoryFormat> trajectory_format(const std::string& name, std::string_view text) {
  const std::string extension = std::filesystem::path(name).extension().string();
  if (extension == ".csv") return TrajectoryFormat::csv;
  if (extension == ".tum") return TrajectoryFormat::tum;
  if (extension == ".kitti") return TrajectoryFormat::kitti;
  if (extension != ".txt") {
    return Error{ErrorCode::bad_input,
                 name + ": the extension of a trajectory is .csv, .tum, .kitti or .txt"};
  }
  Lines lines(text);
  if (!lines.next()) return no_pose(name);
  if (lines.words().count() == kTumFields.size()) return TrajectoryFormat::tum;
  if (lines.words().count() == kKittiFields.size()) return TrajectoryFormat::kitti;
  return at(name, lines.number(), "must hold 8 numbers (TUM: t x y z qx qy qz qw) or 12 (KITTI)");
}

Result<TrajectoryFile> trajectory_of(const CsvTable& table) {
  Result<TrajectoryFile> out = CsvTrajectory(table).read();
  if (!out || !out.value().trajectory.poses.empty()) return out;
  Error error = no_pose(table.name());
  if (table.rows() > 0) error.message += ": x_m, y_m or yaw_rad is empty in all its rows";
  return error;
}

Result<TrajectoryFile> parse_trajectory(std::string text, const std::string& name,
                                        TrajectoryFormat format) {
  if (format == TrajectoryFormat::csv) {
    const Result<CsvTable> table = CsvTable::parse(std::move(text), name);
    if (!table) return table.error();
    return trajectory_of(table.value());
  }
  TrajectoryFile out;
  out.format = format;
  Trajectory& to = out.trajectory;
  to.has_time = format == TrajectoryFormat::tum;
  to.has_rotation = true;
  for (Lines lines(text); lines.next();) {
    const Result<void> added = format == TrajectoryFormat::tum
                                   ? add_tum(name, lines.number(), lines.words(), to)
                                   : add_kitti(name, lines.number(), lines.words(), to);
    if (!added) return added.error();
  }
  if (to.poses.empty()) return no_pose(name);
  return out;
}

}  // namespace lsv
