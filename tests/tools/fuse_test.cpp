// SPDX-License-Identifier: BSD-3-Clause
// `lsv simulate rover` and `lsv fuse` as a user meets them. The filter is tested beside its
// functions; here: files in and out, what is said, what is refused.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/support/csv_table.h"
#include "tests/support/run_program.h"
#include "tests/tools/run_lsv.h"

namespace lsv {
namespace {

namespace fs = std::filesystem;

using nlohmann::json;
using test::Args;
using test::CsvTable;
using test::expect_one_line_error;
using test::lsv_run;
using test::ProgramResult;
using test::read_text;
using test::with;
using test::write_text;

ProgramResult rover_run(const Args& args) { return test::run_program(with({ROVER_PROGRAM}, args)); }

// Most tests here and in evaluate_test.cpp start a part of it, which is there faster.
TEST(RoverProgram, IsPartOfTheWhole) {
  const auto options = [](const std::string& help) { return help.substr(help.find("Options:")); };
  for (const Args& command : {Args{"simulate", "rover"}, {"fuse"}, {"evaluate"}}) {
    const Args args = with(command, {"--help"});
    const ProgramResult whole = lsv_run(args);
    EXPECT_EQ(whole.exit_code, 0);
    EXPECT_EQ(options(whole.out), options(rover_run(args).out));
  }
}

class Fuse : public testing::Test {
 protected:
  ProgramResult simulate(const std::string& scenario, const std::string& seed = "1") const {
    return rover_run({"simulate", "rover", scenario, "--seed", seed, "-o", drive_});
  }
  ProgramResult fuse(const Args& inputs, const std::string& rover = "rover.toml") const {
    return rover_run(with({"fuse", "--rover", drive_ + "/" + rover, "-o", out_}, inputs));
  }
  Args lsv(int sensor) const {
    return {"--lsv", drive_ + "/lsv_" + std::to_string(sensor) + ".csv"};
  }
  Args wheels() const { return {"--wheels", drive_ + "/wheels.csv"}; }
  static Args all(const std::vector<Args>& parts) {
    Args out;
    for (const Args& part : parts) out = with(out, part);
    return out;
  }
  /// Of the last poses.
  double error_m() const {
    const CsvTable pose(read_text(out_ + "/pose.csv")), truth(read_text(drive_ + "/truth.csv"));
    const std::size_t p = pose.rows() - 1, t = truth.rows() - 1;
    return std::hypot(pose.number(p, "x_m") - truth.number(t, "x_m"),
                      pose.number(p, "y_m") - truth.number(t, "y_m"));
  }

  const std::string folder_ = test::fresh_directory();
  const std::string drive_ = folder_ + "/drive";
  const std::string out_ = folder_ + "/out";
};

TEST_F(Fuse, FusesWhatTheSimulatorWrote) {
  ASSERT_EQ(simulate("sand_crossing").exit_code, 0);
  const ProgramResult run = fuse(all({lsv(1), lsv(2), wheels()}));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(run.out, "");
  EXPECT_LT(error_m(), 0.04);
  const json summary = json::parse(read_text(out_ + "/summary.json"));
  EXPECT_EQ(summary["schema"], "lsv.fusion/1");
  EXPECT_EQ(summary["poses"], 2401);
  EXPECT_EQ(summary["counters"]["lsv_accepted"], 4802);
  EXPECT_NEAR(summary["slip_time_s"]["left"].get<double>(), 41.5, 2.0);
  EXPECT_EQ(summary["mounting"]["rank"], 3);
  EXPECT_NE(read_text(out_ + "/events.csv").find("slips,left wheel"), std::string::npos);
  EXPECT_NE(read_text(out_ + "/report.html").find("95 % ellipses"), std::string::npos);
  const json first = json::parse(
      read_text(out_ + "/pose.jsonl").substr(0, read_text(out_ + "/pose.jsonl").find('\n')));
  EXPECT_EQ(first["cov"].size(), 6U);
  for (const char* const name : {"pose.csv", "pose.tum", "pose.jsonl", "events.csv"})
    EXPECT_FALSE(fs::exists(out_ + "/" + name + ".part"));
}

TEST_F(Fuse, WorksWithAnyOfTheSensors) {
  ASSERT_EQ(simulate("hard_ground").exit_code, 0);
  EXPECT_EQ(fuse(wheels()).exit_code, 0);
  EXPECT_LT(error_m(), 0.5);
  EXPECT_EQ(fuse(all({lsv(1), lsv(2)})).exit_code, 0);
  EXPECT_LT(error_m(), 0.05);
  const ProgramResult one = fuse(lsv(1));
  EXPECT_EQ(one.exit_code, 0);
  EXPECT_NE(one.err.find("cannot tell turning from side slip"), std::string::npos) << one.err;
}

TEST_F(Fuse, TheSameSeedGivesTheSameBytes) {
  ASSERT_EQ(simulate("outliers", "5").exit_code, 0);
  const std::string first = read_text(drive_ + "/lsv_1.csv");
  ASSERT_EQ(fuse(all({lsv(1), lsv(2), wheels()})).exit_code, 0);
  const std::string pose = read_text(out_ + "/pose.csv");
  ASSERT_EQ(fuse(all({lsv(1), lsv(2), wheels()})).exit_code, 0);
  EXPECT_EQ(read_text(out_ + "/pose.csv"), pose);
  fs::remove_all(drive_);
  ASSERT_EQ(simulate("outliers", "5").exit_code, 0);
  EXPECT_EQ(read_text(drive_ + "/lsv_1.csv"), first);
  fs::remove_all(drive_);
  ASSERT_EQ(simulate("outliers", "6").exit_code, 0);
  EXPECT_NE(read_text(drive_ + "/lsv_1.csv"), first);
}

TEST_F(Fuse, EveryScenarioOfTheProgramRuns) {
  const ProgramResult list = rover_run({"simulate", "rover", "--list"});
  ASSERT_EQ(list.exit_code, 0);
  std::istringstream lines(list.out);
  int scenarios = 0;
  for (std::string line; std::getline(lines, line); ++scenarios) {
    const std::string name = line.substr(0, line.find(' '));
    fs::remove_all(drive_);
    const ProgramResult run = simulate(name);
    EXPECT_EQ(run.exit_code, 0) << name << ": " << run.err;
    EXPECT_TRUE(fs::exists(drive_ + "/rover.html")) << name;
    EXPECT_EQ(read_text(drive_ + "/rover.toml").find("wz_walk_rad_s = 0.3") != std::string::npos,
              name == "square_sand");
    // And is one that can be given as a file.
    EXPECT_EQ(
        rover_run({"simulate", "rover", drive_ + "/scenario.toml", "-o", folder_ + "/" + name})
            .exit_code,
        0);
  }
  EXPECT_EQ(scenarios, 10);
}

TEST_F(Fuse, RefusesScenariosThatAreNone) {
  EXPECT_EQ(simulate("sand").exit_code, 2);
  EXPECT_EQ(rover_run({"simulate", "rover", "-o", drive_}).exit_code, 2);
  EXPECT_EQ(rover_run({"simulate", "rover", "hard_ground"}).exit_code, 2);
  const std::string good =
      "schema = \"lsv.scenario/1\"\n[drive]\nstep_s = 0.1\nsteps = 10\n[wheels]\nradius_m = "
      "0.1\ntrack_m = 0.8\n";
  const std::string command = "[[command]]\nduration_s = 1\nleft_rad_s = 1\nright_rad_s = 1\n";
  const std::pair<std::string, std::string> wrong[] = {
      {"", "schema"},
      {"schema = \"lsv.scenario/2\"\n", "schema"},
      {good, "[[command]] or [random]"},
      {good + command + "[random]\n", "[[command]] or [random]"},
      {good + command + "[soil]\n", "unknown section soil"},
      {good + command + "[[patch]]\nsoil = \"F\"\n", "patch.soil must be A"},
      {good + command + "[[patch]]\nleft = 1\nsoil = \"A\"\n", "unknown key patch.left"},
      {good + command + "[[lsv]]\nx_m = 1\ny_m = nan\nnoise_m_s = 1\n", "lsv.y_m must be a finite"},
      {good + "[[command]]\nduration_s = 1\n", "command.left_rad_s is missing"},
      {good + command + "[motion]\nvx_walk_m_s = 1\n", "motion.wz_walk_rad_s is missing"},
      {good + command + "[motion]\nvx_walk_m_s = 0\nwz_walk_rad_s = 1\n", "motion.vx_walk_m_s"},
      {good + "[random]\n[motion]\nvx_walk_m_s = 1\nwz_walk_rad_s = 1\n", "[random] says"},
      {good + "command = 3\n", "unknown key wheels.command"},
      {good + command + "steps = = 3", "not valid TOML"}};
  for (const auto& [text, sentence] : wrong) {
    const std::string path = folder_ + "/scenario.toml";
    write_text(path, text);
    SCOPED_TRACE(text);
    expect_one_line_error(simulate(path), 3, sentence);
    EXPECT_FALSE(fs::exists(drive_));
  }
}

TEST_F(Fuse, NothingIsOverwrittenBySimulating) {
  ASSERT_EQ(simulate("appendix_d").exit_code, 0);
  EXPECT_EQ(simulate("appendix_d").exit_code, 2);
}

TEST_F(Fuse, RefusesRoversThatAreNone) {
  ASSERT_EQ(simulate("hard_ground").exit_code, 0);
  const std::string good = read_text(drive_ + "/rover.toml");
  const auto without = [&](const std::string& part, const std::string& instead) {
    std::string out = good;
    return out.replace(out.find(part), part.size(), instead);
  };
  const std::pair<std::string, std::string> wrong[] = {
      {without("radius_m = 0.1", "radius_m = 0"), "wheels.radius_m"},
      {without("radius_m = 0.1", "radius_m = -1e308"), "wheels.radius_m"},
      {without("radius_m = 0.1", "radius_m = nan"), "wheels.radius_m must be a finite"},
      {without("radius_m = 0.1", "radius_m = \"0.1\""), "wheels.radius_m must be a finite"},
      {without("radius_m = 0.1", "radius_mm = 100"), "unknown key wheels.radius_mm"},
      {without("radius_m = 0.1\n", ""), "wheels.radius_m is missing"},
      {without("lsv.rover/1", "lsv.rover/9"), "schema"},
      {without("[[lsv]]", "[lsv]"), ""},
      {good + "[motion]\nmodel = \"warp\"\n", "motion.model"},
      {good + "[filter]\ngate_probability = 2\n", "filter.gate_probability"},
      {good + "[filter]\nlate_epochs = 1.5\n", "filter.late_epochs must be a whole"},
      {good + "[[imu]]\n", "imu must be a section"}};
  for (const auto& [text, sentence] : wrong) {
    write_text(drive_ + "/wrong.toml", text);
    const ProgramResult run = fuse(all({lsv(1), lsv(2), wheels()}), "wrong.toml");
    SCOPED_TRACE(text);
    expect_one_line_error(run, 3, sentence);
    EXPECT_NE(run.err.find("wrong.toml"), std::string::npos) << run.err;
    EXPECT_FALSE(fs::exists(out_));
  }
}

TEST_F(Fuse, RefusesTablesThatAreNone) {
  ASSERT_EQ(simulate("hard_ground").exit_code, 0);
  const std::pair<std::string, std::string> wrong[] = {
      {"", ""},
      {"time_s,vx_m_s\n0,1\n", "vy_m_s"},
      {"time_s,vx_m_s,vy_m_s\n0,1,nan\n", "vy_m_s"},
      {"time_s,vx_m_s,vy_m_s\n0,1,1e300\n", ":2: "},
      {"time_s,vx_m_s,vy_m_s\nnow,1,0\n", "time_s is \"now\""},
      {"time_s,vx_m_s,vy_m_s\n1e12,1,0\n", "time_s"},
      {"time_s,vx_m_s,vy_m_s\n1,1,0\n1,1,0\n", ":3: time_s does not increase"},
      {"time_s,vx_m_s,vy_m_s,sigma_vx_m_s\n0,1,0,0\n", "a sigma is not above 0"},
      {"time_s,vx_m_s,vy_m_s,dt_s\n0,1,0,-1\n", "dt_s is below 0"},
      {"time_s,vx_m_s,vy_m_s\n0,,\n", "no sample"}};
  for (const auto& [text, sentence] : wrong) {
    write_text(drive_ + "/wrong.csv", text);
    SCOPED_TRACE(text);
    expect_one_line_error(fuse({"--lsv", drive_ + "/wrong.csv"}), 3, sentence);
    EXPECT_FALSE(fs::exists(out_));
  }
}

TEST_F(Fuse, RefusesWhatDoesNotGoTogether) {
  ASSERT_EQ(simulate("hard_ground").exit_code, 0);
  EXPECT_EQ(fuse({}).exit_code, 2);
  EXPECT_EQ(fuse(all({lsv(1), lsv(2), lsv(1)})).exit_code, 2);
  EXPECT_EQ(fuse(all({wheels(), {"--imu", drive_ + "/wheels.csv"}})).exit_code, 2);
  EXPECT_EQ(fuse({"--wheels", drive_ + "/nothing.csv"}).exit_code, 3);
  EXPECT_EQ(rover_run({"fuse", "--wheels", drive_ + "/wheels.csv", "-o", out_}).exit_code, 2);
  // Outputs that would be inputs.
  fs::copy(drive_ + "/wheels.csv", drive_ + "/pose.csv");
  EXPECT_EQ(rover_run({"fuse", "--wheels", drive_ + "/pose.csv", "--rover", drive_ + "/rover.toml",
                       "-o", drive_})
                .exit_code,
            2);
}

// The CSV of lsv track goes in as it is: dt_s is the interval, refused rows are left out.
TEST_F(Fuse, ReadsATrackOfFrames) {
  ASSERT_EQ(simulate("hard_ground").exit_code, 0);
  write_text(drive_ + "/track.csv",
             "# lsv: 0.1.0\nframe,time_s,dt_s,dx_px,dy_px,status,vx_m_s,vy_m_s\n"
             "1,0.001,0.001,1,0,ok,0.05,0\n2,0.002,0.001,,,dark,,\n3,0.003,0.002,1,0,ok,0.05,0\n");
  const ProgramResult run = fuse({"--lsv", drive_ + "/track.csv"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const CsvTable pose(read_text(out_ + "/pose.csv"));
  EXPECT_EQ(pose.rows(), 2U);
  EXPECT_EQ(pose.text(0, "time_s"), "0.000500000");
  EXPECT_EQ(pose.text(1, "time_s"), "0.002000000");
  EXPECT_EQ(json::parse(read_text(out_ + "/summary.json"))["rows_left_out"], 1);
}

/// One sensor on the axle, said to be hopeless unless its track knows better.
constexpr const char* kCoarseRover =
    "schema = \"lsv.rover/1\"\n[[lsv]]\nx_m = 0.1\ny_m = 0\nnoise_m_s = 1.0\n";

class FuseFrames : public Fuse {
 protected:
  /// Simulated frames through `lsv track` into `lsv fuse`, unedited.
  void drive(const Args& motion) {
    fs::remove_all(drive_);
    fs::remove_all(out_);
    const ProgramResult made =
        lsv_run(with({"simulate", "speckle", "-o", drive_ + "/frames", "--size", "64x64"}, motion));
    ASSERT_EQ(made.exit_code, 0) << made.err;
    const ProgramResult tracked =
        lsv_run({"track", drive_ + "/frames", "--rate-hz", "1000", "--calibration",
                 LSV_SOURCE_DIR "/sample_frames/calibration.toml", "--csv", drive_ + "/track.csv"});
    ASSERT_EQ(tracked.exit_code, 0) << tracked.err;
    write_text(drive_ + "/rover.toml", kCoarseRover);
    const ProgramResult run = lsv_run(
        {"fuse", "--rover", drive_ + "/rover.toml", "--lsv", drive_ + "/track.csv", "-o", out_});
    ASSERT_EQ(run.exit_code, 0) << run.err;
  }
  CsvTable track() const { return CsvTable(read_text(drive_ + "/track.csv")); }
  CsvTable pose() const { return CsvTable(read_text(out_ + "/pose.csv")); }
  json summary() const { return json::parse(read_text(out_ + "/summary.json")); }
};

// The speed wanders far more between two frames than the image is unsure of it, so that what the
// filter believes is what the last image said.
TEST_F(FuseFrames, TheNoiseIsThatOfTheImage) {
  double sigma_m_s[2] = {};
  for (const int noisy : {0, 1}) {
    ASSERT_NO_FATAL_FAILURE(drive({"--frames", "20", "--profile", "constant", "--speed-px", "1",
                                   "--noise-sd", noisy == 1 ? "4" : "0.5"}));
    const CsvTable track = this->track(), pose = this->pose();
    ASSERT_EQ(pose.rows(), track.rows());
    const std::size_t last = track.rows() - 1;
    sigma_m_s[noisy] = track.number(last, "sigma_vx_m_s");
    EXPECT_NEAR(pose.number(last, "sigma_vx_m_s"), sigma_m_s[noisy], 0.02 * sigma_m_s[noisy]);
    EXPECT_NEAR(pose.number(last, "vx_m_s"), track.number(last, "vx_m_s"), sigma_m_s[noisy]);
    EXPECT_EQ(summary()["counters"]["lsv_accepted"], track.rows());
  }
  EXPECT_GT(sigma_m_s[1], 3.0 * sigma_m_s[0]);
}

TEST_F(FuseFrames, ATrackAtRestIsAStandstill) {
  ASSERT_NO_FATAL_FAILURE(drive({"--frames", "60", "--profile", "parked"}));
  const CsvTable track = this->track();
  int at_rest = 0;
  for (std::size_t i = 0; i < track.rows(); ++i) at_rest += track.text(i, "motion") == "at_rest";
  EXPECT_EQ(at_rest, 10);
  EXPECT_EQ(summary()["counters"]["standstills"], at_rest);
  // Which one sensor alone cannot tell.
  EXPECT_LT(pose().number(track.rows() - 1, "sigma_wz_rad_s"), 1.1e-4);
}

// A rover that turns about the place of one sensor.
TEST_F(FuseFrames, OneSensorAtRestIsNoStandstillWhileAnotherMoves) {
  fs::create_directories(drive_);
  write_text(drive_ + "/rover.toml",
             std::string(kCoarseRover) + "[[lsv]]\nx_m = -0.1\ny_m = 0\nnoise_m_s = 0.001\n");
  const auto standstills = [&](const std::string& others_motion) {
    fs::remove_all(out_);
    std::string pivot = "time_s,vx_m_s,vy_m_s,sigma_vx_m_s,sigma_vy_m_s,motion\n", other = pivot;
    for (const char* const time_s : {"0.1", "0.2", "0.3"}) {
      pivot += time_s + std::string(",0,0,0.001,0.001,at_rest\n");
      other += time_s + std::string(",0,0.02,0.001,0.001,") + others_motion + "\n";
    }
    write_text(drive_ + "/1.csv", pivot);
    write_text(drive_ + "/2.csv", other);
    EXPECT_EQ(fuse({"--lsv", drive_ + "/1.csv", "--lsv", drive_ + "/2.csv"}).exit_code, 0);
    return summary()["counters"]["standstills"].get<int>();
  };
  EXPECT_EQ(standstills("moving"), 0);
  EXPECT_EQ(standstills("at_rest"), 3);
  EXPECT_EQ(standstills(""), 3);
}

}  // namespace
}  // namespace lsv
