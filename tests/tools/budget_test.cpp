// SPDX-License-Identifier: BSD-3-Clause
// `lsv budget`: the arithmetic of its percentiles and verdict, the frames it plays, and the program
// itself. Nothing here depends on how fast the machine is.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <vector>

#include "lsv/odometer.h"
#include "tests/support/run_program.h"
#include "tools/budget_measure.h"

namespace lsv::cli {
namespace {

using test::ProgramResult;

sim::SpeckleConfig small_camera() {
  sim::SpeckleConfig out;
  out.width_px = 64;
  out.height_px = 48;
  out.seed = 7;
  return out;
}

TEST(DurationSamples, PercentilesAreSamples) {
  std::vector<std::int64_t> durations_us(2000);
  for (std::size_t i = 0; i < durations_us.size(); ++i)
    durations_us[i] = static_cast<std::int64_t>(i) + 1;
  std::shuffle(durations_us.begin(), durations_us.end(), std::mt19937(3));
  DurationSamples samples(durations_us.size());
  for (const std::int64_t us : durations_us) samples.add(1000 * us);
  const DurationSummary summary = samples.summary();
  EXPECT_EQ(summary.samples, 2000U);
  EXPECT_DOUBLE_EQ(summary.mean_us, 1000.5);
  EXPECT_DOUBLE_EQ(summary.p50_us, 1000.0);
  EXPECT_DOUBLE_EQ(summary.p99_us, 1980.0);
  EXPECT_DOUBLE_EQ(summary.p999_us, 1998.0);
  EXPECT_DOUBLE_EQ(summary.max_us, 2000.0);
  EXPECT_EQ(samples.count_above(1'998'000), 2U);
  EXPECT_EQ(samples.count_above(1'997'999), 3U);
}

TEST(DurationSamples, FewSamples) {
  DurationSamples samples(1);
  EXPECT_EQ(samples.summary().samples, 0U);
  EXPECT_TRUE(std::isnan(samples.summary().p999_us));
  samples.add(5000);
  samples.add(9000);  // beyond the capacity
  EXPECT_EQ(samples.summary().samples, 1U);
  EXPECT_DOUBLE_EQ(samples.summary().p50_us, 5.0);
  EXPECT_DOUBLE_EQ(samples.summary().p999_us, 5.0);
}

TEST(PacedTimes, OneLateResultInAThousandIsAllowed) {
  PacedTimes times;
  times.frames_due = 1000;
  EXPECT_TRUE(times.holds());
  times.late = 1;
  EXPECT_TRUE(times.holds());
  times.late = 2;
  EXPECT_FALSE(times.holds());
  times.frames_due = 999;
  times.late = 1;
  EXPECT_FALSE(times.holds());
}

TEST(SimulatedLoop, PlaysThereAndBack) {
  std::vector<std::size_t> played;
  for (std::int64_t k = 0; k < 9; ++k) played.push_back(there_and_back(k, 4));
  EXPECT_EQ(played, (std::vector<std::size_t>{0, 1, 2, 3, 2, 1, 0, 1, 2}));
  EXPECT_EQ(there_and_back(5, 2), 1U);
}

TEST(SimulatedLoop, ShiftsAreThoseOfTheFrames) {
  const sim::SpeckleConfig camera = small_camera();
  const Result<SimulatedLoop> loop = SimulatedLoop::render(camera, 4.0, 4);
  ASSERT_TRUE(loop.ok());
  Result<Odometer> odometer = Odometer::create(loop_config(camera), loop.value().format());
  ASSERT_TRUE(odometer.ok());
  constexpr double kTolerance_px = 0.03;  // the pipeline's own error on 64 x 48 px
  for (std::int64_t k = 0; k < 14; ++k) {
    const Result<StepReport> report = odometer.value().push(loop.value().frame(k));
    ASSERT_TRUE(report.ok()) << report.error().message;
    if (k == 0) continue;
    ASSERT_EQ(report.value().shift.status, ShiftStatus::ok) << k;
    EXPECT_NEAR(report.value().shift.dx_px, loop.value().shift(k).dx_px, kTolerance_px) << k;
    EXPECT_NEAR(report.value().shift.dy_px, loop.value().shift(k).dy_px, kTolerance_px) << k;
  }
}

TEST(Budget, EveryFrameIsMeasuredAndRight) {
  const sim::SpeckleConfig camera = small_camera();
  const Result<SimulatedLoop> loop = SimulatedLoop::render(camera, 4.0, 4);
  ASSERT_TRUE(loop.ok());
  const TrackConfig config = loop_config(camera);
  const Result<UnpacedTimes> unpaced = measure_unpaced(config, loop.value(), 40, 3600.0);
  ASSERT_TRUE(unpaced.ok());
  for (const DurationSummary* stage : {&unpaced.value().prepare, &unpaced.value().correlate,
                                       &unpaced.value().peak_and_quality, &unpaced.value().push}) {
    EXPECT_EQ(stage->samples, 40U);
    EXPECT_GT(stage->p50_us, 0.0);
    EXPECT_LE(stage->p50_us, stage->p99_us);
    EXPECT_LE(stage->p999_us, stage->max_us);
  }
  EXPECT_EQ(unpaced.value().shifts_refused, 0U);
  EXPECT_GT(unpaced.value().largest_error_px, 0.0);
  EXPECT_LT(unpaced.value().largest_error_px, 0.03);

  const Result<PacedTimes> paced = measure_paced(config, loop.value(), 40, 500.0);
  ASSERT_TRUE(paced.ok());
  EXPECT_EQ(paced.value().frames_due, 40U);
  EXPECT_DOUBLE_EQ(paced.value().period_us, 2000.0);
  EXPECT_EQ(paced.value().latency.samples, paced.value().push.samples);
  EXPECT_GE(paced.value().latency.p50_us, paced.value().push.p50_us);
}

ProgramResult run_budget(const std::vector<std::string>& args) {
  std::vector<std::string> command = {LSV_PROGRAM, "budget"};
  command.insert(command.end(), args.begin(), args.end());
  return test::run_program(command);
}

TEST(BudgetProgram, JsonHoldsEveryNumber) {
  const ProgramResult result =
      run_budget({"--rate-hz", "200", "--size", "64x48", "--frames", "16", "--json", "-"});
  ASSERT_TRUE(result.exit_code == 0 || result.exit_code == 4) << result.err;
  EXPECT_EQ(result.err, "");
  const nlohmann::json json = nlohmann::json::parse(result.out);
  EXPECT_EQ(json.at("schema"), "lsv.budget/1");
  EXPECT_EQ(json.at("holds"), result.exit_code == 0);
  EXPECT_EQ(json.at("rate_hz"), 200.0);
  EXPECT_EQ(json.at("width_px"), 64);
  EXPECT_EQ(json.at("height_px"), 48);
  EXPECT_EQ(json.at("engine"), "zncc");
  EXPECT_EQ(json.at("max_dx_px"), 32);
  EXPECT_EQ(json.at("max_dy_px"), 24);
  for (const char* key : {"cpu_model", "simd_target", "fft_backend", "peak_fit"})
    EXPECT_FALSE(json.at(key).get<std::string>().empty()) << key;
  const nlohmann::json& unpaced = json.at("unpaced");
  for (const char* stage : {"prepare_us", "correlate_us", "peak_and_quality_us", "push_us"}) {
    EXPECT_EQ(unpaced.at(stage).at("samples"), 16) << stage;
    for (const char* value : {"mean", "p50", "p99", "p99_9", "max"})
      EXPECT_TRUE(unpaced.at(stage).at(value).is_number()) << stage << ' ' << value;
  }
  EXPECT_TRUE(unpaced.at("max_rate_hz").is_number());
  EXPECT_EQ(unpaced.at("shifts_refused"), 0);
  const nlohmann::json& paced = json.at("paced");
  EXPECT_EQ(paced.at("period_us"), 5000.0);
  EXPECT_EQ(paced.at("frames_due"), 16);
  EXPECT_TRUE(paced.at("late").is_number_unsigned());
  EXPECT_TRUE(paced.contains("headroom_ratio"));
  for (const char* kind : {"wake_up_us", "push_us", "latency_us"})
    EXPECT_TRUE(paced.at(kind).contains("p99_9")) << kind;
}

TEST(BudgetProgram, TableForPeopleAndJsonInAFile) {
  const std::string json_path = test::fresh_directory() + "/budget.json";
  const ProgramResult result =
      run_budget({"--rate-hz", "200", "--size", "32x32", "--frames", "5", "--bit-depth", "12",
                  "--engine", "cross", "--max-shift", "8", "--json", json_path});
  ASSERT_TRUE(result.exit_code == 0 || result.exit_code == 4) << result.err;
  for (const char* text : {"machine", "SIMD", "32 x 32 px, 12 bit", "engine cross", "+-8 x +-8 px",
                           "us ", "p99.9", "prepare", "correlate", "peak and quality", "whole push",
                           "full search", "latency", "headroom", "Hz"})
    EXPECT_NE(result.out.find(text), std::string::npos) << text << " in\n" << result.out;
  EXPECT_NE(result.out.find(result.exit_code == 0 ? " holds" : " does not hold"),
            std::string::npos);
  EXPECT_EQ(nlohmann::json::parse(test::read_text(json_path)).at("bit_depth"), 12);
}

TEST(BudgetProgram, ARateBeyondAnyMachineDoesNotHold) {
  const ProgramResult result = run_budget(
      {"--rate-hz", "1e6", "--size", "64x64", "--frames", "50", "--engine", "zncc", "--json", "-"});
  EXPECT_EQ(result.exit_code, 4) << result.err;
  EXPECT_EQ(nlohmann::json::parse(result.out).at("paced").at("late"), 50);
}

TEST(BudgetProgram, WrongUsageIsRefusedInOneSentence) {
  const std::vector<std::vector<std::string>> wrong = {
      {},
      {"--rate-hz", "0"},
      {"--rate-hz", "nan"},
      {"--rate-hz", "fast"},
      {"--rate-hz", "2e6"},
      {"--rate-hz", "100", "--size", "128"},
      {"--rate-hz", "100", "--size", "128x"},
      {"--rate-hz", "100", "--size", "128x128x2"},
      {"--rate-hz", "100", "--size", "8x8"},
      {"--rate-hz", "100", "--size", "0x0"},
      {"--rate-hz", "100", "--bit-depth", "9"},
      {"--rate-hz", "100", "--engine", "magic"},
      {"--rate-hz", "100", "--peak-fit", "magic"},
      {"--rate-hz", "100", "--max-shift", "1"},
      {"--rate-hz", "100", "--max-shift", "125"},
      {"--rate-hz", "100", "--frames", "0"},
      {"--rate-hz", "100", "--frames", "1000001"},
      {"--rate-hz", "100", "--seconds", "-1"},
      {"--rate-hz", "100", "--seconds", "1e9"},
      {"--rate-hz", "100", "--seconds", "1", "--frames", "10"},
  };
  for (const std::vector<std::string>& args : wrong) {
    std::string shown;
    for (const std::string& arg : args) shown += arg + ' ';
    const ProgramResult result = run_budget(args);
    EXPECT_EQ(result.exit_code, 2) << shown;
    EXPECT_EQ(result.out, "") << shown;
    EXPECT_NE(result.err, "") << shown;
  }
}

TEST(BudgetProgram, OutputThatCannotBeWritten) {
  const ProgramResult result =
      run_budget({"--rate-hz", "200", "--size", "32x32", "--frames", "2", "--json",
                  test::fresh_directory() + "/missing/budget.json"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.err.find("budget.json"), std::string::npos) << result.err;
}

}  // namespace
}  // namespace lsv::cli
