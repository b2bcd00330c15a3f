// SPDX-License-Identifier: BSD-3-Clause
#include "tools/sensor_track.h"

#include <array>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <utility>

#include "calibration/scale.h"
#include "calibration/sha256.h"
#include "lsv/ingest/csv_table.h"
#include "lsv/ingest/timestamps.h"

namespace lsv::cli {
namespace {

enum Column : std::size_t { time_s, dt_s, status, dx_px, dy_px, sigma_dx_px, sigma_dy_px };
constexpr std::array kColumns = {"time_s", "dt_s",        "status",     "dx_px",
                                 "dy_px",  "sigma_dx_px", "sigma_dy_px"};

class TrackReader {
 public:
  TrackReader(const CsvTable& table, const Calibration& calibration)
      : table_(table), scale_(pixel_scale(calibration)) {}

  Result<TrackFile> read() {
    for (std::size_t i = 0; i < kColumns.size(); ++i) {
      const Result<std::size_t> column = table_.column(kColumns[i]);
      if (!column) return column.error();
      columns_[i] = column.value();
    }
    std::optional<std::int64_t> last_ns;
    for (std::size_t row = 0; row < table_.rows(); ++row) {
      const Result<std::int64_t> time_ns = time(row, Column::time_s);
      if (!time_ns) return time_ns.error();
      if (last_ns && time_ns.value() <= *last_ns) return at(row, "time_s does not increase");
      last_ns = time_ns.value();
      if (table_.text(row, columns_[Column::status]) != "ok") {
        ++out_.refused;
        refused_before_ = true;
        continue;
      }
      Result<void> added = add(row, time_ns.value());
      if (!added) return added.error();
    }
    if (out_.steps.empty())
      return Error{ErrorCode::bad_input, table_.name() + ": holds no accepted shift"};
    out_.sha256 = sha256_hex(table_.bytes());
    return std::move(out_);
  }

 private:
  Error at(std::size_t row, const std::string& sentence) const {
    return {ErrorCode::bad_input,
            table_.name() + ":" + std::to_string(table_.line(row)) + ": " + sentence};
  }

  Result<std::int64_t> time(std::size_t row, Column column) const {
    const std::string_view text = table_.text(row, columns_[column]);
    const auto ns = ns_from_decimal_seconds(text);
    if (!ns || std::abs(*ns) > kFarthestStamp_ns)
      return at(row, std::string(kColumns[column]) + " is \"" + std::string(text) +
                         "\", not a time in seconds within 126 years of zero");
    return *ns;
  }

  Result<void> add(std::size_t row, std::int64_t time_ns) {
    const Result<std::int64_t> dt_ns = time(row, Column::dt_s);
    if (!dt_ns) return dt_ns.error();
    if (dt_ns.value() <= 0 || dt_ns.value() > kFarthestStamp_ns / 4)
      return at(row, "dt_s of an accepted shift must be above 0 and less than 31 years");
    TrackStep step{.begin = {time_ns - dt_ns.value()}, .end = {time_ns}};
    if (!out_.steps.empty() && step.begin < out_.steps.back().end)
      return at(row, "dt_s reaches back before the shift accepted before");
    std::array<double, 4> cells{};
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const Result<double> cell = table_.known_number(row, columns_[Column::dx_px + i]);
      if (!cell) return cell.error();
      cells[i] = cell.value();
    }
    const auto [dx, dy, sigma_dx, sigma_dy] = cells;
    if (sigma_dx < 0.0 || sigma_dy < 0.0) return at(row, "a sigma is below 0");
    step.dx_m = scale_.xx * dx + scale_.xy * dy;
    step.dy_m = scale_.yx * dx + scale_.yy * dy;
    const double xx = sigma_dx * sigma_dx;
    const double yy = sigma_dy * sigma_dy;
    step.xx_m2 = scale_.xx * scale_.xx * xx + scale_.xy * scale_.xy * yy;
    step.xy_m2 = scale_.xx * scale_.yx * xx + scale_.xy * scale_.yy * yy;
    step.yy_m2 = scale_.yx * scale_.yx * xx + scale_.yy * scale_.yy * yy;
    // A shift from the last accepted frame bridges what was refused since; another one begins a new
    // segment, and the way to it is not known.
    step.spans_refused =
        refused_before_ && !out_.steps.empty() && step.begin == out_.steps.back().end;
    refused_before_ = false;
    out_.steps.push_back(step);
    return {};
  }

  const CsvTable& table_;
  PixelScale scale_;
  std::array<std::size_t, kColumns.size()> columns_{};
  bool refused_before_ = false;
  TrackFile out_;
};

}  // namespace

Result<TrackFile> read_sensor_track(const std::string& path, const Calibration& calibration) {
  const Result<CsvTable> table = CsvTable::read(path);
  if (!table) return table.error();
  return TrackReader(table.value(), calibration).read();
}

}  // namespace lsv::cli
