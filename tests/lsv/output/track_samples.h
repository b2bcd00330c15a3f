// SPDX-License-Identifier: BSD-3-Clause
// Reports, runs and files for the tests of the outputs.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "lsv/output/output_file.h"
#include "lsv/output/track_sink.h"

namespace lsv::testing_samples {

/// A directory of this test case and process; removed at the end of the test.
class ScratchDirectory {
 public:
  ScratchDirectory() {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    path_ = std::filesystem::path(::testing::TempDir()) /
            ("lsv_" + std::string(test->test_suite_name()) + "_" + test->name() + "_" +
             std::to_string(::getpid()));
    std::filesystem::create_directories(path_);
  }
  ~ScratchDirectory() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  ScratchDirectory(const ScratchDirectory&) = delete;
  ScratchDirectory& operator=(const ScratchDirectory&) = delete;

  std::string file(const std::string& name) const { return (path_ / name).string(); }
  std::vector<std::string> names() const {
    std::vector<std::string> out;
    for (const auto& entry : std::filesystem::directory_iterator(path_))
      out.push_back(entry.path().filename().string());
    return out;
  }

 private:
  std::filesystem::path path_;
};

inline std::string text_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

inline std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> out;
  std::size_t start = 0;
  for (std::size_t end; (end = text.find(separator, start)) != std::string::npos; start = end + 1)
    out.push_back(text.substr(start, end - start));
  if (start < text.size() || separator == ',') out.push_back(text.substr(start));
  return out;
}

inline OutputFile opened(const std::string& path) {
  auto file = OutputFile::open(path);
  EXPECT_TRUE(file.ok()) << (file.ok() ? "" : file.error().message);
  return std::move(file).value();
}

inline RunInfo sample_run() {
  RunInfo info;
  info.version = "0.1.0";
  info.source_description = "PNG sequence";
  info.format = {128, 96, PixelType::mono16, 12};
  info.time_base = "1000 Hz";
  info.max_shift = {32, 24};
  info.config.correlation.peak_fit = PeakFit::gaussian3;
  info.config.gate.min_zncc = 0.25;
  info.config.gate.min_q = 6.0;
  Calibration& calibration = info.config.calibration;
  calibration.sensor_name = "LSV-01";
  calibration.pixel_pitch_x_m = 14e-6;
  calibration.pixel_pitch_y_m = 14e-6;
  calibration.sc_x_ratio = 1.985;
  calibration.sc_y_ratio = 2.0;
  calibration.digest = "00ff";
  return info;
}

inline StepReport first_report(std::int64_t time_ns = 0) {
  StepReport report;
  report.stamp.ns = time_ns;
  return report;
}

/// One step of (1, -2) mm in 10 ms after `before`.
inline StepReport accepted_after(const StepReport& before) {
  StepReport report;
  report.frame = before.frame + 1;
  report.dt_ns = 10'000'000;
  report.stamp.ns = before.stamp.ns + report.dt_ns;
  report.shift = {.dx_px = 1.5,
                  .dy_px = -2.25,
                  .cov = {.xx_px2 = 0.0025, .xy_px2 = 0.0001, .yy_px2 = 0.0036},
                  .quality = {.zncc = 0.875, .q = 9.5, .peak_ratio = 3.0, .peak_to_rms = 12.0},
                  .status = ShiftStatus::ok};
  report.search = Search::predicted;
  report.keyframe = 0;
  report.segment = 2;
  report.motion = MotionState::moving;
  report.velocity = {0.1, -0.2, 0.001, 0.002};
  report.position = {before.position.x_m + 0.001, before.position.y_m - 0.002, 1e-5, 2e-5};
  return report;
}

/// Refused, with the measured quality and with numbers that no output may show.
inline StepReport refused_after(const StepReport& before, ShiftStatus status) {
  StepReport report = accepted_after(before);
  report.shift.status = status;
  report.shift.quality = {.zncc = 0.125, .q = 4.5, .peak_ratio = 1.1, .peak_to_rms = 2.0};
  report.position = before.position;
  return report;
}

/// first, ok, below_q_gate, ok (and a hole of two frames), dark.
inline std::vector<StepReport> sample_reports(std::int64_t start_ns = 0) {
  std::vector<StepReport> out{first_report(start_ns)};
  out.push_back(accepted_after(out.back()));
  out.push_back(refused_after(out.back(), ShiftStatus::below_q_gate));
  out.push_back(accepted_after(out.back()));
  out.back().frame += 2;
  out.push_back(refused_after(out.back(), ShiftStatus::dark));
  out.back().shift.quality = {};
  return out;
}

inline void feed(TrackSink& sink, const std::vector<StepReport>& reports,
                 bool interrupted = false) {
  for (const StepReport& report : reports) ASSERT_TRUE(sink.write(report).ok());
  Result<void> finished = sink.finish({.interrupted = interrupted});
  if (finished) finished = sink.commit();
  ASSERT_TRUE(finished.ok()) << finished.error().message;
}

}  // namespace lsv::testing_samples
