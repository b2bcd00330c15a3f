// SPDX-License-Identifier: BSD-3-Clause
// `lsv calibrate scale` as a user meets it. The fit is tested beside its function; here: which runs
// are refused, and what is overwritten.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "tests/support/run_program.h"

namespace lsv {
namespace {

using test::ProgramResult;
using test::read_text;

const std::string kCalibration = LSV_SOURCE_DIR "/sample_frames/calibration.toml";
constexpr const char* kColumns = "time_s,dt_s,dx_px,dy_px,sigma_dx_px,sigma_dy_px,status\n";

/// Four runs of 1000 px along the axes.
class ScaleRunsOnDisk : public ::testing::Test {
 protected:
  ScaleRunsOnDisk() {
    write_runs("+x,7e-3,0,1e-6\n-x,-7e-3,0,1e-6\n+y,0,7e-3,1e-6\n-y,0,-7e-3,1e-6\n");
    write("+x", "0.1,0.1,400,0,0.01,0.01,ok\n0.3,0.2,600,0,0.01,0.01,ok\n");
    write("-x", "0.1,0.1,-1000,0,0.01,0.01,ok\n");
    write("+y", "0.1,0.1,0,1000,0.01,0.01,ok\n");
    write("-y", "0.1,0.1,0,-1000,0.01,0.01,ok\n");
  }

  void write(const std::string& name, const std::string& rows) const {
    std::ofstream(folder_ + "/" + name) << kColumns << rows;
  }
  void write_runs(const std::string& rows) const {
    std::ofstream(folder_ + "/runs.csv") << "track,travel_x_m,travel_y_m,sigma_m\n" << rows;
  }
  std::string out() const { return folder_ + "/out"; }
  ProgramResult calibrate(const std::string& calibration = kCalibration) const {
    return test::run_program({LSV_PROGRAM, "calibrate", "scale", folder_ + "/runs.csv",
                              "--calibration", calibration, "--height-m", "0.1", "--date",
                              "2026-11-24", "-o", out()});
  }
  void expect_refusal(int exit_code, const std::string& says) const {
    const ProgramResult result = calibrate();
    EXPECT_EQ(result.exit_code, exit_code);
    EXPECT_NE(result.err.find(says), std::string::npos) << result.err;
    EXPECT_FALSE(std::filesystem::exists(out()));
  }

  std::string folder_ = test::fresh_directory();
};

TEST_F(ScaleRunsOnDisk, GiveTheScale) {
  const ProgramResult result = calibrate();
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.out.find("Sc along image x   2.000000"), std::string::npos) << result.out;
}

// The shift after frames that were refused spans them; one that begins later leaves travel out.
TEST_F(ScaleRunsOnDisk, AreRefusedWhereTheGroundWasLost) {
  write("+x", "0.1,0.1,400,0,0.01,0.01,ok\n0.2,0.1,,,,,dark\n0.3,0.2,600,0,0.01,0.01,ok\n");
  EXPECT_EQ(calibrate().exit_code, 0);
  std::filesystem::remove_all(out());
  write("+x", "0.1,0.1,400,0,0.01,0.01,ok\n0.2,0.1,,,,,dark\n0.3,0.1,600,0,0.01,0.01,ok\n");
  expect_refusal(3, "+x:4: the ground was lost before this shift");
}

TEST_F(ScaleRunsOnDisk, CountOnce) {
  write_runs("+x,7e-3,0,1e-6\n-x,-7e-3,0,1e-6\n+y,0,7e-3,1e-6\n./+x,7e-3,0,1e-6\n");
  expect_refusal(3, "runs.csv:5: ./+x is the run of line 2");
}

TEST_F(ScaleRunsOnDisk, DoNotOverwriteWhatTheyStartFrom) {
  ASSERT_EQ(calibrate().exit_code, 0);
  const std::string path = out() + "/calibration.toml";
  const std::string before = read_text(path);
  const ProgramResult result = calibrate(path);
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.err.find("is an input of this run"), std::string::npos) << result.err;
  EXPECT_EQ(read_text(path), before);
}

}  // namespace
}  // namespace lsv
