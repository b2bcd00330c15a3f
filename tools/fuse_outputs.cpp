// SPDX-License-Identifier: BSD-3-Clause
#include "tools/fuse_outputs.h"

#include <cmath>
#include <filesystem>
#include <utility>

#include "lsv/output/number_text.h"
#include "lsv/output/tum_pose.h"

namespace lsv::cli {
namespace {

constexpr int kDecimals = 9;

constexpr const char* kCsvColumns =
    "time_s,x_m,y_m,yaw_rad,vx_m_s,vy_m_s,wz_rad_s,sigma_vx_m_s,sigma_vy_m_s,sigma_wz_rad_s,"
    "cov_xx_m2,cov_xy_m2,cov_xyaw_m_rad,cov_yy_m2,cov_yyaw_m_rad,cov_yawyaw_rad2,"
    "left_efficiency_ratio,right_efficiency_ratio,sigma_left_ratio,sigma_right_ratio,"
    "left_slips,right_slips,slip_known,lsv_nis,lsv_nis_dof,wheels_nis,gyro_nis,lsv_refused,"
    "status\n";

void cell(std::string& out, double value) {
  out += ',';
  append_shortest(out, value);
}

void flag(std::string& out, bool value, bool is_known) {
  out += ',';
  if (is_known) out += value ? '1' : '0';
}

int refused_count(const NavState& state) {
  int out = 0;
  for (const bool refused : state.lsv_refused) out += refused ? 1 : 0;
  return out;
}

double sigma_of(const NavState& state, std::size_t i) { return std::sqrt(state.cov[i][i]); }

void append_csv(std::string& out, const NavState& s) {
  append_seconds(out, s.stamp.ns);
  for (const double value : {s.x_m, s.y_m, s.yaw_rad, s.vx_m_s, s.vy_m_s, s.wz_rad_s}) {
    out += ',';
    append_fixed(out, value, kDecimals);
  }
  for (const std::size_t i : {3U, 4U, 5U}) cell(out, sigma_of(s, i));
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = i; j < 3; ++j) cell(out, s.cov[i][j]);
  }
  for (const double value :
       {s.left.efficiency_ratio, s.right.efficiency_ratio, s.left.sigma_ratio, s.right.sigma_ratio})
    cell(out, value);
  const bool has_wheels = std::isfinite(s.left.efficiency_ratio);
  flag(out, s.left.is_slipping, has_wheels);
  flag(out, s.right.is_slipping, has_wheels);
  flag(out, s.left.is_slip_known, has_wheels);
  cell(out, s.lsv.nis);
  out += ',';
  if (s.lsv.dof > 0) append_integer(out, s.lsv.dof);
  cell(out, s.wheels.nis);
  cell(out, s.gyro.nis);
  out += ',';
  append_integer(out, refused_count(s));
  out += ',';
  out += word(s.status);
  out += '\n';
}

void key(std::string& out, std::string_view name, double value) {
  out += ",\"";
  out += name;
  out += "\":";
  const std::size_t before = out.size();
  append_shortest(out, value);
  if (out.size() == before) out += "null";
}

void append_grip(std::string& out, std::string_view name, const WheelGrip& grip) {
  out += ",\"";
  out += name;
  out += "\":{\"slip_known\":";
  out += grip.is_slip_known ? "true" : "false";
  out += ",\"slips\":";
  out += grip.is_slipping ? "true" : "false";
  key(out, "efficiency_ratio", grip.efficiency_ratio);
  key(out, "sigma_ratio", grip.sigma_ratio);
  out += '}';
}

void append_json(std::string& out, const NavState& s) {
  out += "{\"time_ns\":";
  append_integer(out, s.stamp.ns);
  out += ",\"status\":\"";
  out += word(s.status);
  out += '"';
  key(out, "x_m", s.x_m);
  key(out, "y_m", s.y_m);
  key(out, "yaw_rad", s.yaw_rad);
  key(out, "vx_m_s", s.vx_m_s);
  key(out, "vy_m_s", s.vy_m_s);
  key(out, "wz_rad_s", s.wz_rad_s);
  out += ",\"cov\":[";
  for (std::size_t i = 0; i < 6; ++i) {
    out += i == 0 ? "[" : ",[";
    for (std::size_t j = 0; j < 6; ++j) {
      if (j > 0) out += ',';
      append_shortest(out, s.cov[i][j]);
    }
    out += ']';
  }
  out += ']';
  if (std::isfinite(s.left.efficiency_ratio)) {
    append_grip(out, "left", s.left);
    append_grip(out, "right", s.right);
  }
  key(out, "gyro_bias_rad_s", s.gyro_bias_rad_s);
  key(out, "lsv_nis", s.lsv.nis);
  key(out, "lsv_nis_dof", s.lsv.dof > 0 ? s.lsv.dof : kUnknown);
  key(out, "wheels_nis", s.wheels.nis);
  key(out, "gyro_nis", s.gyro.nis);
  key(out, "lsv_refused", refused_count(s));
  out += "}\n";
}

}  // namespace

FuseOutputs::FuseOutputs(OutputFile csv, OutputFile tum, OutputFile jsonl, OutputFile events,
                         const FusionConfig& config)
    : csv_(std::move(csv)),
      tum_(std::move(tum)),
      jsonl_(std::move(jsonl)),
      events_file_(std::move(events)) {
  for (const LsvConfig& sensor : config.lsv) sensor_names_.push_back(sensor.name);
}

Result<FuseOutputs> FuseOutputs::open(const std::string& folder, const std::string& head,
                                      const FusionConfig& config) {
  const auto path = [&](const char* name) {
    return (std::filesystem::path(folder) / name).string();
  };
  Result<OutputFile> csv = OutputFile::open(path(kFuseFiles[0]));
  if (!csv) return csv.error();
  Result<OutputFile> tum = OutputFile::open(path(kFuseFiles[1]));
  if (!tum) return tum.error();
  Result<OutputFile> jsonl = OutputFile::open(path(kFuseFiles[2]));
  if (!jsonl) return jsonl.error();
  Result<OutputFile> events = OutputFile::open(path(kFuseFiles[3]));
  if (!events) return events.error();
  if (Result<void> done = csv.value().write(head + kCsvColumns); !done) return done.error();
  if (Result<void> done = events.value().write(head + "time_s,event,detail\n"); !done)
    return done.error();
  return FuseOutputs(std::move(csv).value(), std::move(tum).value(), std::move(jsonl).value(),
                     std::move(events).value(), config);
}

Result<void> FuseOutputs::event(Stamp stamp, std::string_view what, std::string_view detail) {
  ++events_;
  std::string line;
  append_seconds(line, stamp.ns);
  line += ',';
  line += what;
  line += ',';
  line += detail;
  line += '\n';
  return events_file_.write(line);
}

Result<void> FuseOutputs::write_events(const NavState& s) {
  if (s.status != last_status_) {
    last_status_ = s.status;
    if (Result<void> done = event(s.stamp, "status", word(s.status)); !done) return done;
  }
  const std::pair<bool*, std::pair<bool, const char*>> wheels[] = {
      {&left_slipped_, {s.left.is_slipping, "left wheel"}},
      {&right_slipped_, {s.right.is_slipping, "right wheel"}}};
  for (const auto& [before, now] : wheels) {
    if (*before == now.first) continue;
    *before = now.first;
    if (Result<void> done = event(s.stamp, now.first ? "slips" : "grips", now.second); !done)
      return done;
  }
  for (std::size_t i = 0; i < sensor_names_.size(); ++i) {
    if (!s.lsv_refused[i]) continue;
    if (Result<void> done = event(s.stamp, "lsv_refused", sensor_names_[i]); !done) return done;
  }
  return {};
}

Result<void> FuseOutputs::write(const FuseRow& row) {
  text_.clear();
  append_csv(text_, row.state);
  if (Result<void> done = csv_.write(text_); !done) return done;
  text_.clear();
  append_tum_pose(text_, row.state.stamp, row.state.x_m, row.state.y_m, row.state.yaw_rad);
  if (Result<void> done = tum_.write(text_); !done) return done;
  text_.clear();
  append_json(text_, row.state);
  if (Result<void> done = jsonl_.write(text_); !done) return done;
  return write_events(row.state);
}

Result<void> FuseOutputs::commit() {
  for (OutputFile* const file : {&csv_, &tum_, &jsonl_, &events_file_}) {
    if (Result<void> done = file->commit(); !done) return done;
  }
  return {};
}

}  // namespace lsv::cli
