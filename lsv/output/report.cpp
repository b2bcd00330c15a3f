// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/output/report.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <span>
#include <string_view>

#include "lsv/output/base64.h"
#include "lsv/output/number_text.h"
#include "lsv/output/report_assets/report_assets.h"

namespace lsv {
namespace {

using nlohmann::ordered_json;

constexpr int kMaxPreviewSide_px = 512;
constexpr int kMaxMapCells = 257;  // per side; larger planes are reduced
constexpr int kNearLags_px = 3;    // on either side of the peak

/// Seven significant digits: more cannot be seen and would double the size of the page.
ordered_json brief(double value) {
  if (!std::isfinite(value)) return nullptr;
  std::array<char, 32> text;
  const auto end =
      std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::scientific, 6)
          .ptr;
  double out = 0.0;
  std::from_chars(text.data(), end, out);
  return out;
}

std::string html_escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '<') {
      out += "&lt;";
    } else if (c == '&') {
      out += "&amp;";
    } else {
      out += c;
    }
  }
  return out;
}

/// JSON that no HTML parser can take for the end of its script element. '<' occurs in JSON only
/// within strings, where \u003c means the same.
std::string script_safe(const ordered_json& json) {
  const std::string text = json.dump(-1, ' ', true, ordered_json::error_handler_t::replace);
  std::string out;
  out.reserve(text.size());
  for (const char c : text) {
    if (c == '<') {
      out += "\\u003c";
    } else {
      out += c;
    }
  }
  return out;
}

struct Filling {
  std::string_view name;
  std::string_view text;
};

/// Puts each text in the place of {{name}}. What is filled in is not searched again.
std::string filled(std::string_view page, std::span<const Filling> fillings) {
  std::string out;
  while (true) {
    const std::size_t open = page.find("{{");
    if (open == std::string_view::npos) return out += page;
    const std::size_t close = page.find("}}", open);
    const std::string_view name = page.substr(open + 2, close - open - 2);
    out += page.substr(0, open);
    for (const Filling& filling : fillings)
      if (filling.name == name) out += filling.text;
    page.remove_prefix(close + 2);
  }
}

ordered_json reasons_json(const Summary& summary) {
  const auto shifts = static_cast<double>(summary.shifts_ok + summary.shifts_rejected);
  ordered_json out = ordered_json::array();
  for (const auto& [status, count] : summary.rejected) {
    ordered_json reason;
    reason["status"] = word(status);
    reason["count"] = count;
    reason["share"] = static_cast<double>(count) / shifts;
    reason["advice"] = advice(status);
    out.push_back(std::move(reason));
  }
  return out;
}

/// [point, {reason: how many}] for each point that holds refused shifts.
ordered_json refused_json(const std::vector<ReportPoint>& points) {
  ordered_json out = ordered_json::array();
  for (std::size_t i = 0; i < points.size(); ++i) {
    ordered_json by_reason;
    for (const ShiftStatus status : kAllShiftStatuses) {
      const std::int64_t count = points[i].count_by_status[static_cast<std::size_t>(status)];
      if (count == 0 || status == ShiftStatus::ok || status == ShiftStatus::first_frame) continue;
      by_reason[std::string(word(status))] = count;
    }
    if (!by_reason.is_null()) out.push_back(ordered_json::array({i, std::move(by_reason)}));
  }
  return out;
}

/// One array over all points.
template <typename Value>
ordered_json column(const std::vector<ReportPoint>& points, Value value) {
  ordered_json out = ordered_json::array();
  for (const ReportPoint& point : points) out.push_back(value(point));
  return out;
}

template <typename Member>
ordered_json means(const std::vector<ReportPoint>& points, Member member) {
  return column(points, [member](const ReportPoint& p) { return brief((p.*member).mean()); });
}

void add_extremes(ordered_json& out, const std::vector<ReportPoint>& points,
                  Spread ReportPoint::*member, const std::string& name, const std::string& unit) {
  out[name + "_min" + unit] =
      column(points, [member](const ReportPoint& p) { return brief((p.*member).min()); });
  out[name + "_max" + unit] =
      column(points, [member](const ReportPoint& p) { return brief((p.*member).max()); });
}

ordered_json series_json(const ReportSeries& series) {
  const std::vector<ReportPoint>& points = series.points();
  const std::int64_t first_ns = series.first_ns();
  ordered_json out;
  out["frames_per_point"] = series.frames_per_point();
  out["frame"] = column(points, [](const ReportPoint& p) { return p.first_frame; });
  out["last_frame"] = column(points, [](const ReportPoint& p) { return p.last_frame; });
  out["t_s"] = column(points, [first_ns](const ReportPoint& p) {
    return seconds_between(Stamp{first_ns}, Stamp{p.last_ns});
  });
  out["x_m"] = column(points, [](const ReportPoint& p) { return brief(p.last_position.x_m); });
  out["y_m"] = column(points, [](const ReportPoint& p) { return brief(p.last_position.y_m); });
  out["vx_m_s"] = means(points, &ReportPoint::vx_m_s);
  out["vy_m_s"] = means(points, &ReportPoint::vy_m_s);
  out["sigma_vx_m_s"] = means(points, &ReportPoint::sigma_vx_m_s);
  out["sigma_vy_m_s"] = means(points, &ReportPoint::sigma_vy_m_s);
  out["q"] = means(points, &ReportPoint::q);
  out["zncc"] = means(points, &ReportPoint::zncc);
  // Of several refused shifts the worst is shown.
  out["refused_q"] = column(points, [](const ReportPoint& p) { return brief(p.refused_q.min()); });
  out["refused_zncc"] =
      column(points, [](const ReportPoint& p) { return brief(p.refused_zncc.min()); });
  if (series.frames_per_point() > 1) {
    add_extremes(out, points, &ReportPoint::vx_m_s, "vx", "_m_s");
    add_extremes(out, points, &ReportPoint::vy_m_s, "vy", "_m_s");
    add_extremes(out, points, &ReportPoint::q, "q", "");
    add_extremes(out, points, &ReportPoint::zncc, "zncc", "");
  }
  out["refused"] = refused_json(points);
  return out;
}

/// A rectangle of lags of the plane, cell by cell.
struct LagMap {
  int first_column = 0;
  int first_row = 0;
  int columns = 0;  // cells
  int rows = 0;
  int reduction = 1;  // lags per cell and axis
};

int columns_of(const PlaneSnapshot& plane) { return 2 * plane.max_dx_px + 1; }
int rows_of(const PlaneSnapshot& plane) { return 2 * plane.max_dy_px + 1; }

float value_at(const PlaneSnapshot& plane, int column, int row) {
  return plane.zncc[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_of(plane)) +
                    static_cast<std::size_t>(column)];
}

/// The highest lag of the cell, so that a reduced map cannot lose the peak.
double cell_value(const PlaneSnapshot& plane, const LagMap& map, int cell_column, int cell_row) {
  const int left = map.first_column + cell_column * map.reduction;
  const int top = map.first_row + cell_row * map.reduction;
  Spread values;
  for (int row = top; row < std::min(top + map.reduction, rows_of(plane)); ++row)
    for (int column = left; column < std::min(left + map.reduction, columns_of(plane)); ++column)
      values.add(static_cast<double>(value_at(plane, column, row)));
  return values.max();
}

ordered_json map_json(const PlaneSnapshot& plane, const LagMap& map) {
  ordered_json out;
  out["first_dx_px"] = map.first_column - plane.max_dx_px;
  out["first_dy_px"] = map.first_row - plane.max_dy_px;
  out["columns"] = map.columns;
  out["rows"] = map.rows;
  out["reduction"] = map.reduction;
  ordered_json values = ordered_json::array();
  for (int row = 0; row < map.rows; ++row)
    for (int column = 0; column < map.columns; ++column)
      values.push_back(brief(cell_value(plane, map, column, row)));
  out["values"] = std::move(values);
  return out;
}

int cells(int lags, int reduction) { return (lags + reduction - 1) / reduction; }

LagMap whole_plane(const PlaneSnapshot& plane) {
  LagMap map;
  map.reduction = cells(std::max(columns_of(plane), rows_of(plane)), kMaxMapCells);
  map.columns = cells(columns_of(plane), map.reduction);
  map.rows = cells(rows_of(plane), map.reduction);
  return map;
}

LagMap around_peak(const PlaneSnapshot& plane) {
  int peak_column = plane.max_dx_px;
  int peak_row = plane.max_dy_px;
  for (int row = 0; row < rows_of(plane); ++row) {
    for (int column = 0; column < columns_of(plane); ++column) {
      // Written so that a NaN never stays the peak.
      if (value_at(plane, column, row) <= value_at(plane, peak_column, peak_row)) continue;
      if (std::isnan(value_at(plane, column, row))) continue;
      peak_column = column;
      peak_row = row;
    }
  }
  LagMap map;
  map.first_column = std::max(peak_column - kNearLags_px, 0);
  map.first_row = std::max(peak_row - kNearLags_px, 0);
  map.columns = std::min(peak_column + kNearLags_px + 1, columns_of(plane)) - map.first_column;
  map.rows = std::min(peak_row + kNearLags_px + 1, rows_of(plane)) - map.first_row;
  return map;
}

ordered_json plane_json(const PlaneSnapshot& plane) {
  ordered_json out;
  out["frame"] = plane.frame;
  out["status"] = plane.status;
  out["engine"] = plane.engine;
  out["dx_px"] = brief(plane.dx_px);
  out["dy_px"] = brief(plane.dy_px);
  out["map"] = map_json(plane, whole_plane(plane));
  out["near"] = map_json(plane, around_peak(plane));
  return out;
}

ordered_json image_json(const FramePreview& preview) {
  ordered_json out;
  out["frame"] = preview.frame;
  out["width_px"] = preview.width_px;
  out["height_px"] = preview.height_px;
  out["reduction"] = preview.reduction;
  out["grey"] = base64(preview.grey);
  return out;
}

std::uint8_t mean_grey(const FrameView& frame, int left_px, int top_px, int side_px) {
  std::int64_t sum_counts = 0;
  for (int y = top_px; y < top_px + side_px; ++y)
    for (int x = left_px; x < left_px + side_px; ++x) sum_counts += frame.at(x, y);
  const std::int64_t full_scale =
      std::int64_t{side_px} * side_px * full_scale_counts(frame.format.bit_depth);
  return static_cast<std::uint8_t>(std::min<std::int64_t>(sum_counts * 255 / full_scale, 255));
}

}  // namespace

FramePreview preview_of(const FrameView& frame) {
  FramePreview out;
  out.frame = frame.index;
  out.reduction =
      std::max(cells(std::max(frame.width_px(), frame.height_px()), kMaxPreviewSide_px), 1);
  // A frame thinner than one preview pixel would vanish; it has no use as a picture either.
  out.width_px = frame.width_px() / out.reduction;
  out.height_px = frame.height_px() / out.reduction;
  for (int y = 0; y < out.height_px; ++y)
    for (int x = 0; x < out.width_px; ++x)
      out.grey.push_back(mean_grey(frame, x * out.reduction, y * out.reduction, out.reduction));
  return out;
}

ReportBuilder::ReportBuilder(OutputFile file, RunInfo info)
    : file_(std::move(file)), info_(std::move(info)), summary_(info_) {}

Result<void> ReportBuilder::set_plane(PlaneSnapshot plane) {
  const bool sizes_are_sane = plane.max_dx_px >= 0 && plane.max_dy_px >= 0 &&
                              plane.max_dx_px <= 1 << 15 && plane.max_dy_px <= 1 << 15;
  if (!sizes_are_sane || plane.zncc.size() != static_cast<std::size_t>(columns_of(plane)) *
                                                  static_cast<std::size_t>(rows_of(plane))) {
    return Error{ErrorCode::invalid_argument, "the correlation plane for the report holds " +
                                                  std::to_string(plane.zncc.size()) +
                                                  " values, which does not match its lags of +-" +
                                                  std::to_string(plane.max_dx_px) + " x +-" +
                                                  std::to_string(plane.max_dy_px) + " px"};
  }
  plane_ = std::move(plane);
  return {};
}

Result<void> ReportBuilder::write(const StepReport& report) {
  series_.add(report);
  return summary_.write(report);
}

Result<void> ReportBuilder::finish(const RunEnd& end) {
  if (auto finished = summary_.finish(end); !finished) return finished;
  if (auto written = file_.write(page()); !written) return written;
  return file_.complete();
}

std::string ReportBuilder::page() const {
  const Summary summary = summary_.summary();
  std::string start_s;
  if (summary.frames > 0) append_seconds(start_s, series_.first_ns());

  ordered_json data;
  data["summary"] = ordered_json::parse(summary_json(info_, summary));
  data["dirty_share"] = kDirtyShare;
  data["start_s"] = start_s;
  data["reasons"] = reasons_json(summary);
  data["series"] = series_json(series_);
  data["plane"] = plane_ ? plane_json(*plane_) : ordered_json();
  data["image"] = preview_ ? image_json(*preview_) : ordered_json();

  namespace assets = report_assets;
  const std::string data_text = script_safe(data);
  const std::string licence = html_escaped(assets::kD3Licence);
  const std::array fillings = {Filling{"style", assets::kStyleCss}, Filling{"d3_licence", licence},
                               Filling{"data", data_text}, Filling{"d3", assets::kD3Js},
                               Filling{"script", assets::kScriptJs}};
  return filled(assets::kPageHtml, fillings);
}

}  // namespace lsv
