// SPDX-License-Identifier: BSD-3-Clause
#include "tools/scale_runs.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <utility>

#include "calibration/sha256.h"
#include "lsv/ingest/csv_table.h"
#include "lsv/ingest/timestamps.h"

namespace lsv::cli {
namespace {

// Of a series; more would weigh more than they know, their errors being alike.
constexpr std::size_t kMaxPoints = 200;
// A run with a larger share of refused shifts is worth a word.
constexpr double kManyRefused = 0.01;

/// The pattern along one run.
struct Track {
  std::vector<double> time_s;
  std::vector<double> x_px;  // since the start
  std::vector<double> y_px;
  std::vector<ShiftCovariance> cov;
  std::size_t refused = 0;
};

Result<Track> read_track(const CsvTable& table) {
  std::size_t columns[7] = {};
  const char* const names[] = {"time_s",      "dx_px",  "dy_px", "sigma_dx_px",
                               "sigma_dy_px", "status", "dt_s"};
  for (std::size_t i = 0; i < std::size(names); ++i) {
    const Result<std::size_t> column = table.column(names[i]);
    if (!column) return column.error();
    columns[i] = column.value();
  }
  Track out;
  double x_px = 0.0;
  double y_px = 0.0;
  ShiftCovariance cov{0.0, 0.0, 0.0};
  std::optional<std::int64_t> last_ns;
  const auto at = [&table](std::size_t row, const char* sentence) {
    return Error{ErrorCode::bad_input,
                 table.name() + ":" + std::to_string(table.line(row)) + ": " + sentence};
  };
  for (std::size_t row = 0; row < table.rows(); ++row) {
    if (table.text(row, columns[5]) != "ok") {
      ++out.refused;
      continue;
    }
    double values[5] = {};
    for (std::size_t i = 0; i < std::size(values); ++i) {
      const Result<double> value = table.known_number(row, columns[i]);
      if (!value) return value.error();
      values[i] = value.value();
    }
    x_px += values[1];
    y_px += values[2];
    cov.xx_px2 += values[3] * values[3];
    cov.yy_px2 += values[4] * values[4];
    if (!out.time_s.empty() && values[0] <= out.time_s.back())
      return at(row, "time_s does not increase");
    const auto time_ns = ns_from_decimal_seconds(table.text(row, columns[0]));
    const auto dt_ns = ns_from_decimal_seconds(table.text(row, columns[6]));
    if (!time_ns || !dt_ns || *dt_ns <= 0)
      return at(row, "time_s and dt_s of an accepted shift must be times in seconds");
    // A shift from the last accepted frame bridges what was refused since; before another one the
    // ground was lost.
    if (last_ns && *time_ns - *dt_ns != *last_ns)
      return at(row, "the ground was lost before this shift, and travel with it: repeat the run");
    last_ns = *time_ns;
    out.time_s.push_back(values[0]);
    out.x_px.push_back(x_px);
    out.y_px.push_back(y_px);
    out.cov.push_back(cov);
  }
  if (out.time_s.empty())
    return Error{ErrorCode::bad_input, table.name() + ": holds no accepted shift"};
  return out;
}

ScalePoint point_at(const Track& track, std::size_t i) {
  return {.dx_px = track.x_px[i], .dy_px = track.y_px[i], .cov = track.cov[i]};
}

/// Positions of the reference over time.
struct Truth {
  std::vector<double> time_s, x_m, y_m;
};

Result<Truth> read_truth(const CsvTable& table) {
  Truth out;
  std::vector<double>* const targets[] = {&out.time_s, &out.x_m, &out.y_m};
  const char* const names[] = {"time_s", "x_m", "y_m"};
  for (std::size_t i = 0; i < std::size(names); ++i) {
    const Result<std::size_t> column = table.column(names[i]);
    if (!column) return column.error();
    for (std::size_t row = 0; row < table.rows(); ++row) {
      const Result<double> value = table.known_number(row, column.value());
      if (!value) return value.error();
      targets[i]->push_back(value.value());
    }
  }
  for (std::size_t row = 1; row < out.time_s.size(); ++row) {
    if (out.time_s[row] > out.time_s[row - 1]) continue;
    return Error{ErrorCode::bad_input, table.name() + ":" + std::to_string(table.line(row)) +
                                           ": time_s does not increase"};
  }
  return out;
}

/// Every so many points of the track, with the reference interpolated at their times.
Result<std::vector<ScalePoint>> along(const Track& track, const Truth& truth,
                                      const std::string& truth_name) {
  std::vector<ScalePoint> out;
  const std::size_t step = track.time_s.size() / kMaxPoints + 1;
  for (std::size_t i = 0; i < track.time_s.size(); i += step) {
    const double time_s = track.time_s[i];
    const auto after = std::ranges::lower_bound(truth.time_s, time_s);
    if (after == truth.time_s.end() || (after == truth.time_s.begin() && *after != time_s))
      continue;  // outside the reference
    const auto k = static_cast<std::size_t>(after - truth.time_s.begin());
    ScalePoint point = point_at(track, i);
    if (k == 0) {
      point.x_m = truth.x_m[0];
      point.y_m = truth.y_m[0];
    } else {
      const double share = (time_s - truth.time_s[k - 1]) / (truth.time_s[k] - truth.time_s[k - 1]);
      point.x_m = std::lerp(truth.x_m[k - 1], truth.x_m[k], share);
      point.y_m = std::lerp(truth.y_m[k - 1], truth.y_m[k], share);
    }
    out.push_back(point);
  }
  if (out.size() < 3) {
    return Error{
        ErrorCode::bad_input,
        truth_name + ": covers fewer than three frames of the track: the two need one clock"};
  }
  return out;
}

/// One table of runs being read.
class Reader {
 public:
  Reader(const CsvTable& table, std::optional<double> sigma_ratio)
      : table_(table),
        folder_(std::filesystem::path(table.name()).parent_path()),
        sigma_ratio_(sigma_ratio) {}

  Result<ScaleRuns> read() {
    if (Result<void> found = find_columns(); !found) return found.error();
    ScaleRuns out;
    for (std::size_t row = 0; row < table_.rows(); ++row) {
      Result<ScaleRun> run = read_run(row, out.warnings);
      if (!run) return run.error();
      out.runs.push_back(std::move(run).value());
    }
    out.inputs_sha256 = sha256_hex(digests_);
    return out;
  }

  void add_digest(const std::string& sha256) { digests_ += sha256; }

 private:
  Error at(std::size_t row, const std::string& sentence) const {
    return {ErrorCode::bad_input,
            table_.name() + ":" + std::to_string(table_.line(row)) + ": " + sentence};
  }

  Result<void> find_columns() {
    is_series_ = table_.has("truth");
    std::vector<std::pair<const char*, std::size_t*>> wanted = {{"track", &track_}};
    if (is_series_) {
      wanted.emplace_back("truth", &truth_);
    } else {
      wanted.emplace_back("travel_x_m", &x_);
      wanted.emplace_back("travel_y_m", &y_);
    }
    if (!sigma_ratio_) wanted.emplace_back("sigma_m", &sigma_);
    for (const auto& [name, target] : wanted) {
      const Result<std::size_t> column = table_.column(name);
      if (!column) {
        return Error{
            column.error().code,
            column.error().message +
                (name == std::string("sigma_m") ? "; or give --reference-sigma-percent" : "")};
      }
      *target = column.value();
    }
    return {};
  }

  Result<CsvTable> read_file(std::size_t row, std::size_t column) {
    const std::string name(table_.text(row, column));
    if (name.empty()) return at(row, "the name of a file is empty");
    if (column == track_) {
      // Counted twice, its errors would seem to average out.
      const auto [first, is_new] =
          track_rows_.try_emplace((folder_ / name).lexically_normal(), row);
      if (!is_new)
        return at(row, name + " is the run of line " + std::to_string(table_.line(first->second)));
    }
    Result<CsvTable> out = CsvTable::read((folder_ / name).string());
    if (out) add_digest(sha256_hex(out.value().bytes()));
    return out;
  }

  Result<double> sigma_m(std::size_t row, double travel_m) const {
    Result<double> given =
        sigma_ratio_ ? Result<double>(*sigma_ratio_ * travel_m) : table_.known_number(row, sigma_);
    if (!given) return given;
    if (!(given.value() > 0.0)) return at(row, "sigma_m must be above 0");
    return given;
  }

  Result<ScaleRun> read_run(std::size_t row, std::vector<std::string>& warnings) {
    Result<CsvTable> file = read_file(row, track_);
    if (!file) return file.error();
    const Result<Track> read = read_track(file.value());
    if (!read) return read.error();
    const Track& track = read.value();
    ScaleRun run{.name = std::string(table_.text(row, track_)), .points = {}};
    const double share = static_cast<double>(track.refused) /
                         static_cast<double>(track.refused + track.time_s.size());
    if (share > kManyRefused) {
      warnings.push_back(run.name + ": " + std::to_string(track.refused) +
                         " shifts were refused; if the ground was lost, this run is too short");
    }
    Result<void> filled = is_series_ ? fill_series(row, track, run) : fill_end(row, track, run);
    if (!filled) return filled.error();
    return run;
  }

  Result<void> fill_series(std::size_t row, const Track& track, ScaleRun& run) {
    const Result<CsvTable> file = read_file(row, truth_);
    if (!file) return file.error();
    const Result<Truth> truth = read_truth(file.value());
    if (!truth) return truth.error();
    Result<std::vector<ScalePoint>> points = along(track, truth.value(), file.value().name());
    if (!points) return points.error();
    run.points = std::move(points).value();
    const ScalePoint& first = run.points.front();
    const ScalePoint& last = run.points.back();
    const Result<double> sigma =
        sigma_m(row, std::hypot(last.x_m - first.x_m, last.y_m - first.y_m));
    if (!sigma) return sigma.error();
    for (ScalePoint& point : run.points) point.sigma_m = sigma.value();
    return {};
  }

  Result<void> fill_end(std::size_t row, const Track& track, ScaleRun& run) {
    ScalePoint point = point_at(track, track.time_s.size() - 1);
    for (const auto& [column, target] : {std::pair{x_, &point.x_m}, std::pair{y_, &point.y_m}}) {
      const Result<double> value = table_.known_number(row, column);
      if (!value) return value.error();
      *target = value.value();
    }
    const Result<double> sigma = sigma_m(row, std::hypot(point.x_m, point.y_m));
    if (!sigma) return sigma.error();
    point.sigma_m = sigma.value();
    run.points = {point};
    return {};
  }

  const CsvTable& table_;
  std::filesystem::path folder_;
  std::optional<double> sigma_ratio_;
  bool is_series_ = false;
  std::size_t track_ = 0, truth_ = 0, x_ = 0, y_ = 0, sigma_ = 0;
  std::string digests_;
  std::map<std::filesystem::path, std::size_t> track_rows_;
};

}  // namespace

Result<ScaleRuns> read_scale_runs(const std::string& path, std::optional<double> sigma_ratio) {
  const Result<CsvTable> table = CsvTable::read(path);
  if (!table) return table.error();
  Reader reader(table.value(), sigma_ratio);
  reader.add_digest(sha256_hex(table.value().bytes()));
  return reader.read();
}

}  // namespace lsv::cli
