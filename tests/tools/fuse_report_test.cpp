// SPDX-License-Identifier: BSD-3-Clause
// What `lsv fuse` says of a drive must be so: nothing that is unknown is told as a number, nothing
// that is lost as ok, and what cannot be trusted has a warning. Without starting the program.
#include "tools/fuse_report.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <vector>

#include "tests/support/run_program.h"
#include "tools/fuse_inputs.h"
#include "tools/fuse_outputs.h"
#include "tools/fuse_run.h"

namespace lsv::cli {
namespace {

namespace fs = std::filesystem;

using nlohmann::json;

constexpr double kSpeed_m_s = 0.05;
constexpr double kLsvNoise_m_s = 5e-4;
constexpr double kWheelNoise_rad_s = 0.017;
constexpr double kRadius_m = 0.1;
constexpr std::uint32_t kSeed = 71;

FusionConfig rover(std::size_t sensors, bool has_wheels) {
  FusionConfig out;
  const std::vector<LsvConfig> mounts = {{"front", 0.3, 0.2, 0.0, kLsvNoise_m_s},
                                         {"rear", -0.3, -0.2, 0.0, kLsvNoise_m_s}};
  out.lsv.assign(mounts.begin(), mounts.begin() + static_cast<std::ptrdiff_t>(sensors));
  if (has_wheels) out.wheels = WheelConfig{kRadius_m, 0.8, kWheelNoise_rad_s, {}};
  return out;
}

/// Straight on at 20 Hz, as sensors with noise tell it; of each a part can be changed.
struct StraightDrive {
  double duration_s = 60.0;
  double lost_from_s = 1e9, lost_to_s = 1e9;  // by the LSV sensors
  double factor[2] = {1.0, 1.0};              // of the LSV sensors
  double last_s[2] = {1e9, 1e9};
  double left_factor = 1.0;
  double step_s = 0.05;
};

FuseSamples samples_of(const FusionConfig& config, const StraightDrive& drive) {
  std::mt19937 random(kSeed);
  std::normal_distribution<double> normal;
  FuseSamples out;
  for (int k = 0; k * drive.step_s <= drive.duration_s; ++k) {
    const double time_s = k * drive.step_s;
    const Stamp stamp{std::llround(time_s * 1e9)};
    for (std::size_t i = 0; i < config.lsv.size(); ++i) {
      const double vx_m_s = drive.factor[i] * (kSpeed_m_s + kLsvNoise_m_s * normal(random));
      const double vy_m_s = drive.factor[i] * kLsvNoise_m_s * normal(random);
      if (time_s > drive.last_s[i] || (time_s > drive.lost_from_s && time_s < drive.lost_to_s))
        continue;
      out.samples.push_back(
          {stamp, i, LsvSample{.stamp = stamp, .vx_m_s = vx_m_s, .vy_m_s = vy_m_s}});
    }
    const double left_rad_s = kSpeed_m_s / kRadius_m + kWheelNoise_rad_s * normal(random);
    const double right_rad_s = kSpeed_m_s / kRadius_m + kWheelNoise_rad_s * normal(random);
    if (config.wheels) {
      out.samples.push_back(
          {stamp, 0, WheelSample{stamp, drive.left_factor * left_rad_s, right_rad_s}});
    }
  }
  out.rows_read = out.samples.size();
  return out;
}

struct Fused {
  std::vector<FuseRow> rows;
  FuseReport report;
  json summary() const { return json::parse(report.json({})); }
  std::string warnings() const { return summary()["warnings"].dump(); }
};

Fused fused(const FusionConfig& config, const FuseSamples& samples) {
  Fused out{{}, FuseReport(config)};
  const Result<FusionCounters> counters =
      fuse(config, samples, [&out](const FuseRow& row) -> Result<void> {
        out.rows.push_back(row);
        out.report.add(row);
        return {};
      });
  out.report.finish(counters.value(), samples, 0);
  return out;
}

Fused fused(const FusionConfig& config, const StraightDrive& drive) {
  return fused(config, samples_of(config, drive));
}

double seconds(Stamp stamp) { return static_cast<double>(stamp.ns) * 1e-9; }

TEST(FuseReport, ASoundDriveHasNoWarnings) {
  const Fused out = fused(rover(2, true), StraightDrive{});
  EXPECT_EQ(out.warnings(), "[]");
  EXPECT_EQ(out.rows.size(), 1201U);
  const json summary = out.summary();
  EXPECT_NEAR(summary["time_s"]["ok"].get<double>(), 60.0, 1e-9);
  EXPECT_EQ(summary["time_s"]["no_motion_source"], 0.0);
  EXPECT_EQ(summary["slip_time_s"]["left"], 0.0);
  EXPECT_NEAR(summary["path_length_m"].get<double>(), 3.0, 0.01);
  EXPECT_EQ(summary["sensors"][1]["used"], 1201);
  EXPECT_EQ(summary["sensors"][1]["last_used_s"], 60.0);
}

// Nothing comes for 10 s, so nothing is processed; the status changes all the same.
TEST(FuseReport, LostOpticsAreToldFromTheTimeLine) {
  const StraightDrive drive{.lost_from_s = 20.0, .lost_to_s = 30.0};
  const Fused out = fused(rover(2, false), drive);
  const double begin_s = 20.0 + FusionConfig{}.optical_timeout_s;
  const json summary = out.summary();
  EXPECT_NEAR(summary["time_s"]["no_motion_source"].get<double>(), 30.0 - begin_s, 1e-6);
  EXPECT_NEAR(summary["time_s"]["ok"].get<double>(), 60.0 - (30.0 - begin_s), 1e-6);
  double first_s = 0.0, sigma_before_m = 0.0;
  std::size_t guessed = 0;
  for (const FuseRow& row : out.rows) {
    EXPECT_EQ(row.is_predicted, row.state.status == NavStatus::no_motion_source);
    if (!row.is_predicted) continue;
    if (guessed++ == 0) first_s = seconds(row.state.stamp);
    const double sigma_m = std::sqrt(row.state.cov[0][0]);
    EXPECT_GT(sigma_m, sigma_before_m);
    sigma_before_m = sigma_m;
    EXPECT_TRUE(std::isnan(row.state.lsv.nis));
  }
  EXPECT_NEAR(first_s, begin_s, 2e-9);
  EXPECT_GE(guessed, 45U);
  EXPECT_LE(guessed, 52U);
  EXPECT_NE(out.warnings().find("nothing said how fast the rover is"), std::string::npos);
  EXPECT_NE(out.report.text().find("lost for 9.900 s"), std::string::npos) << out.report.text();
  EXPECT_NE(out.report.html({}).find("no motion source"), std::string::npos);
}

TEST(FuseReport, WithWheelsTheOpticsAreLostAtTheSameInstant) {
  const StraightDrive drive{.lost_from_s = 20.0, .lost_to_s = 30.0};
  const Fused out = fused(rover(2, true), drive);
  std::vector<double> predicted_s;
  for (const FuseRow& row : out.rows) {
    if (row.is_predicted) predicted_s.push_back(seconds(row.state.stamp));
  }
  ASSERT_EQ(predicted_s.size(), 1U);  // after that the wheels tell
  EXPECT_NEAR(predicted_s[0], 20.1, 2e-9);
  EXPECT_NEAR(out.summary()["time_s"]["optical_lost"].get<double>(), 9.9, 1e-6);
}

// Without optics each update moves the position, and no rover drove that.
TEST(FuseReport, ThePathIsThatOfTheSpeed) {
  const Fused out = fused(rover(0, true), StraightDrive{});
  EXPECT_NEAR(out.summary()["path_length_m"].get<double>(), 3.0, 0.03);
}

TEST(FuseReport, UnknownSlipIsNotZero) {
  const Fused wheels = fused(rover(0, true), StraightDrive{});
  EXPECT_EQ(wheels.summary()["slip_time_s"]["left"], nullptr);
  EXPECT_EQ(wheels.summary()["slip_known_time_s"]["right"], 0.0);
  EXPECT_NE(wheels.report.text().find("left wheel not known, right wheel not known"),
            std::string::npos);
  EXPECT_NE(wheels.report.html({}).find("not known, not known"), std::string::npos);
  EXPECT_EQ(fused(rover(2, false), StraightDrive{}).summary()["slip_time_s"]["left"], nullptr);
  // A wheel that stands has no ratio; the other has.
  const json left = fused(rover(2, true), StraightDrive{.left_factor = 0.0}).summary();
  EXPECT_EQ(left["slip_time_s"]["left"], nullptr);
  EXPECT_TRUE(left["slip_time_s"]["right"].is_number());
}

TEST(FuseReport, WhatContradictsHasAWarning) {
  const auto warnings = [](std::size_t sensors, bool has_wheels, const StraightDrive& drive) {
    return fused(rover(sensors, has_wheels), drive).warnings();
  };
  // mm/s
  EXPECT_NE(warnings(2, false, {.factor = {1.0, 1000.0}}).find("rear: none of its readings"),
            std::string::npos);
  const std::string both = warnings(2, true, {.factor = {1000.0, 1000.0}});
  for (const char* const wheel : {"left", "right"}) {
    EXPECT_NE(
        both.find(std::string(wheel) + " wheel: on 100.0 % of its readings the ground passes"),
        std::string::npos)
        << both;
  }
  // A scale that is 10 % off.
  EXPECT_NE(warnings(2, false, {.factor = {1.0, 1.1}}).find("--correct-ratio"), std::string::npos);
  // A wheel that reads nothing: told as what it is, or as contradiction.
  const std::string dead = warnings(2, true, {.left_factor = 0.0});
  EXPECT_TRUE(dead.find("left wheel: on ") != std::string::npos ||
              dead.find("contradicted the optics") != std::string::npos)
      << dead;
  // ms for s
  const std::string slow = warnings(2, false, {.duration_s = 2000.0, .step_s = 50.0});
  EXPECT_NE(slow.find("are the times seconds?"), std::string::npos) << slow;
  const std::string ends = warnings(2, true, {.last_s = {1e9, 40.0}});
  EXPECT_NE(ends.find("rear: no reading was used in the last 20 s"), std::string::npos) << ends;
}

TEST(FuseReport, NisFarFromOneHasAWarning) {
  FusionConfig bold = rover(2, false);
  FuseSamples samples = samples_of(bold, {});
  for (LsvConfig& sensor : bold.lsv) sensor.noise_m_s /= 3.0;
  bold.motion.vx_walk_m_s = bold.motion.wz_walk_rad_s = bold.motion.vy_sigma_m_s = 1e-5;
  EXPECT_NE(fused(bold, samples).warnings().find("the covariance is too small"), std::string::npos);
  FusionConfig shy = rover(0, true);
  samples = samples_of(shy, {});
  shy.wheels->noise_rad_s *= 10.0;
  EXPECT_NE(fused(shy, samples).warnings().find("the covariance is too large"), std::string::npos);
}

/// Lines in the drawing of that title.
std::size_t lines_in(const std::string& html, const std::string& title) {
  const std::size_t at = html.find(">" + title + "</text>");
  const std::size_t end = html.find("</svg>", at);
  std::size_t lines = 0;
  for (std::size_t i = html.find("<polyline", at); i < end; i = html.find("<polyline", i + 1))
    ++lines;
  return lines;
}

// What nothing measured is not drawn as if it were.
TEST(FuseReport, OutagesBreakTheLines) {
  const StraightDrive lost{.lost_from_s = 20.0, .lost_to_s = 30.0};
  const std::string sound = fused(rover(2, true), StraightDrive{}).report.html({});
  const std::string guessed = fused(rover(2, false), lost).report.html({});
  const std::string wheels = fused(rover(2, true), lost).report.html({});
  for (const char* const title : {"yaw rate", "heading", "forward speed"}) {
    EXPECT_EQ(lines_in(sound, title), 1U) << title;
    EXPECT_EQ(lines_in(guessed, title), 2U) << title;
    EXPECT_EQ(lines_in(wheels, title), 1U) << title;
  }
  // Both wheels have a line and two for the band.
  const std::string slip = "slip, 1 - ground speed / rim speed, while optics tell it";
  EXPECT_EQ(lines_in(sound, slip), 6U);
  EXPECT_EQ(lines_in(wheels, slip), 12U);
}

TEST(XyPlot, ThinningKeepsGaps) {
  XyPlot plot{
      .title = "gaps", .x_name = {}, .y_name = {}, .series = {{"", "#000", {}}}, .patches = {}};
  for (int i = 0; i < 5000; ++i)
    plot.series[0].points.push_back({1.0 * i, i == 2501 || i == 3502 ? kUnknown : 1.0});
  EXPECT_EQ(lines_in(draw(plot, 600, 300), "gaps"), 3U);
}

// A gap stays one however often a curve is thinned.
TEST(FuseReport, ThinCurvesKeepTheirBreaks) {
  ThinCurve curve;
  for (int i = 0; i < 50000; ++i) {
    if (i == 20000) curve.end_line();
    if (i == 30001) curve.end_line();
    if (i < 20000 || i >= 30001) curve.add(i, 1.0);
  }
  std::size_t breaks = 0;
  double gap = 0.0, before = 0.0;
  for (const Point& point : curve.points()) {
    if (std::isnan(point.x)) {
      ++breaks;
      continue;
    }
    EXPECT_GT(point.x + 0.5, before);
    gap = std::max(gap, point.x - before);
    before = point.x;
  }
  EXPECT_EQ(breaks, 1U);
  EXPECT_GE(gap, 10000.0);
  EXPECT_LE(curve.points().size(), 3000U);
}

class FuseFiles : public testing::Test {
 protected:
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ + "/" + name) << text;
    return folder_ + "/" + name;
  }
  static std::string refusal(const FuseInputs& inputs, const FusionConfig& config) {
    const Result<FuseSamples> samples = read_samples(inputs, config);
    return samples ? "" : samples.error().message;
  }
  const std::string folder_ = test::fresh_directory();
};

TEST_F(FuseFiles, ClocksThatDoNotOverlapAreRefused) {
  const std::string lsv =
      write("lsv.csv", "time_s,vx_m_s,vy_m_s\n1700000000,0.05,0\n1700000010,0.05,0\n");
  const std::string wheels = write("wheels.csv", "time_s,left_rad_s,right_rad_s\n0,1,1\n10,1,1\n");
  const std::string refused = refusal({.lsv = {lsv}, .wheels = wheels, .imu = {}}, rover(1, true));
  EXPECT_NE(refused.find("the times do not overlap: "), std::string::npos) << refused;
  EXPECT_NE(refused.find("wheels.csv is from 0 to 10 s, "), std::string::npos) << refused;
  EXPECT_NE(refused.find("lsv.csv is from 1700000000 to 1700000010 s"), std::string::npos);
  // One that dies and one that comes later are held together by a third.
  const std::string early = write("early.csv", "time_s,vx_m_s,vy_m_s\n0,0.05,0\n3,0.05,0\n");
  const std::string late = write("late.csv", "time_s,vx_m_s,vy_m_s\n5,0.05,0\n9,0.05,0\n");
  EXPECT_NE(refusal({.lsv = {early, late}, .wheels = {}, .imu = {}}, rover(2, false)), "");
  EXPECT_EQ(refusal({.lsv = {early, late}, .wheels = wheels, .imu = {}}, rover(2, true)), "");
}

TEST_F(FuseFiles, StatusWordsThatAreNoneAreRefused) {
  const std::string good = "time_s,vx_m_s,vy_m_s,status\n0,0.05,0,ok\n1,0.05,0,below_q_gate\n";
  const FusionConfig config = rover(1, false);
  const Result<FuseSamples> samples =
      read_samples({.lsv = {write("good.csv", good)}, .wheels = {}, .imu = {}}, config);
  ASSERT_TRUE(samples.ok());
  EXPECT_EQ(samples.value().rows_read, 2U);
  EXPECT_EQ(samples.value().rows_left_out, 1U);
  EXPECT_NE(fused(config, samples.value()).report.text().find("rows     1 of 2 left out"),
            std::string::npos);
  const std::string refused =
      refusal({.lsv = {write("bad.csv", good + "2,0.05,0,OK\n")}, .wheels = {}, .imu = {}}, config);
  EXPECT_NE(refused.find("bad.csv:4: status is \"OK\", which is no status"), std::string::npos)
      << refused;
}

// All files get their names together: a full disk leaves none that looks whole.
TEST_F(FuseFiles, AFullDiskLeavesNothing) {
  const FusionConfig config = rover(2, true);
  const FuseSamples samples = samples_of(config, {.duration_s = 3.0});
  const auto write_all = [&] {
    Result<FuseOutputs> outputs = FuseOutputs::open(folder_, "# head\n", config);
    if (!outputs) return outputs.error().message;
    const Result<FusionCounters> done =
        fuse(config, samples, [&](const FuseRow& row) { return outputs.value().write(row); });
    if (!done) return done.error().message;
    const Result<void> finished = outputs.value().finish("{}\n", "<p>\n");
    return finished ? std::string() : finished.error().message;
  };
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  // Between the size of pose.csv and that of pose.jsonl.
  const rlimit small{40'000, before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  const std::string refused = write_all();
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  EXPECT_NE(refused.find("pose.jsonl"), std::string::npos) << refused;
  EXPECT_TRUE(fs::is_empty(folder_));
  EXPECT_EQ(write_all(), "");
  EXPECT_LT(fs::file_size(folder_ + "/pose.csv"), 40'000U);
  for (const char* const name : kFuseFiles) EXPECT_TRUE(fs::exists(folder_ + "/" + name)) << name;
}

}  // namespace
}  // namespace lsv::cli
