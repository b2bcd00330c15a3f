// SPDX-License-Identifier: BSD-3-Clause
// `lsv evaluate` as a user meets it. The metrics are tested beside their functions; here: files in
// and out, what is said, what is refused.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/fusion/trajectories.h"
#include "tests/support/run_program.h"
#include "tests/tools/run_lsv.h"

namespace lsv {
namespace {

namespace fs = std::filesystem;

using nlohmann::json;
using test::Args;
using test::expect_one_line_error;
using test::ProgramResult;
using test::read_text;
using test::with;
using test::write_text;

ProgramResult evaluate(const Args& args) {
  return test::run_program(with({ROVER_PROGRAM, "evaluate"}, args));
}

json evaluated(const Args& args) {
  const ProgramResult result = evaluate(with(args, {"--json", "-"}));
  EXPECT_EQ(result.exit_code, 0) << result.err;
  return json::parse(result.out);
}

/// 0.1 s apart.
std::vector<TrajectoryPose> poses() { return test::winding(200).poses; }
double seconds(const TrajectoryPose& pose) { return 1e-9 * static_cast<double>(pose.stamp.ns); }

template <typename... Numbers>
std::string line(const char* format, Numbers... numbers) {
  char out[400];
  std::snprintf(out, sizeof out, format, numbers...);
  return out;
}

/// The truth as CSV, TUM and KITTI, and an estimate that is 10 mm to the left all along (in y) with
/// a covariance of (5 mm)^2.
void write_files(const std::string& folder) {
  std::string truth = "# unit: m\ntime_s,x_m,y_m,yaw_rad\n";
  std::string estimate =
      "time_s,x_m,y_m,yaw_rad,cov_xx_m2,cov_xy_m2,cov_yy_m2,cov_xyaw_m_rad,cov_yyaw_m_rad,"
      "cov_yawyaw_rad2\n";
  std::string tum = "# t x y z qx qy qz qw\n", kitti;
  for (const TrajectoryPose& pose : poses()) {
    const double yaw_rad = heading_rad(pose.rotation);
    const double c = std::cos(yaw_rad), s = std::sin(yaw_rad), time_s = seconds(pose);
    truth += line("%.9f,%.12f,%.12f,%.12f\n", time_s, pose.x_m, pose.y_m, yaw_rad);
    estimate += line("%.9f,%.12f,%.12f,%.12f,25e-6,0,25e-6,0,0,1e-6\n", time_s, pose.x_m,
                     pose.y_m + 0.01, yaw_rad);
    tum += line("%.9f %.12f %.12f 0 0 0 %.12f %.12f\n", time_s, pose.x_m, pose.y_m, pose.rotation.z,
                pose.rotation.w);
    kitti +=
        line("%.12f %.12f 0 %.12f %.12f %.12f 0 %.12f 0 0 1 0\n", c, -s, pose.x_m, s, c, pose.y_m);
  }
  write_text(folder + "/truth.csv", truth);
  write_text(folder + "/estimate.csv", estimate);
  write_text(folder + "/truth.tum", tum);
  write_text(folder + "/truth.kitti", kitti);
  write_text(folder + "/tum.txt", tum);
  write_text(folder + "/kitti.txt", kitti);
}

class Evaluate : public testing::Test {
 protected:
  void SetUp() override { write_files(folder_); }
  std::string path(const std::string& name) const { return folder_ + "/" + name; }
  const std::string folder_ = test::fresh_directory();
};

TEST_F(Evaluate, SaysWhatIsAskedFor) {
  const json out = evaluated({path("estimate.csv"), path("truth.csv")});
  EXPECT_EQ(out.at("schema"), "lsv.evaluation/1");
  EXPECT_EQ(out.at("est"), path("estimate.csv"));
  EXPECT_EQ(out.at("truth_format"), "csv");
  EXPECT_EQ(out.at("pairs"), 200);
  EXPECT_EQ(out.at("align"), "none");
  for (const char* const key : {"ate_rmse_m", "ate_mean_m", "ate_median_m", "ate_max_m"})
    EXPECT_NEAR(out.at(key), 0.01, 1e-10) << key;
  EXPECT_NEAR(out.at("ate_sd_m"), 0.0, 1e-10);
  EXPECT_NEAR(out.at("ate_rotation_rmse_deg"), 0.0, 1e-9);
  EXPECT_NEAR(out.at("heading_rmse_deg"), 0.0, 1e-9);
  EXPECT_NEAR(out.at("rpe_per_m_rmse_m"), 0.0, 1e-9);
  EXPECT_NEAR(out.at("rpe_per_s_rmse_m"), 0.0, 1e-9);
  EXPECT_GT(out.at("rpe_per_m_pairs"), 150);
  EXPECT_NEAR(out.at("drift_percent"), 0.0, 1e-7);
  EXPECT_NEAR(out.at("end_error_m"), 0.01, 1e-10);
  EXPECT_NEAR(out.at("nees_position_mean"), 4.0, 1e-6);  // (10 mm / 5 mm)^2
  EXPECT_EQ(out.at("nees_position_share_inside_95"), 1.0);
  EXPECT_NEAR(out.at("nees_pose_mean"), 4.0, 1e-6);
  EXPECT_NEAR(out.at("duration_s"), 19.9, 1e-9);
  EXPECT_EQ(out.at("warnings"), json::array());
}

TEST_F(Evaluate, TheAlignmentIsStated) {
  const json fit = evaluated({path("estimate.csv"), path("truth.csv"), "--align", "se2"});
  EXPECT_EQ(fit.at("align"), "se2");
  EXPECT_NEAR(fit.at("ate_rmse_m"), 0.0, 1e-9);
  EXPECT_NEAR(fit.at("alignment").at("translation_m")[1], -0.01, 1e-9);
  EXPECT_NEAR(fit.at("alignment").at("rotation")[0][0], 1.0, 1e-9);
  EXPECT_EQ(fit.at("alignment").at("scale"), 1.0);
  EXPECT_NEAR(fit.at("ate_rmse_by_align_m").at("none"), 0.01, 1e-9);
  EXPECT_NE(fit.at("warnings").dump().find("NEES after a fit"), std::string::npos);
  const ProgramResult text = evaluate({path("estimate.csv"), path("truth.csv"), "--align", "se2"});
  EXPECT_NE(text.out.find("alignment  se2: turn about z"), std::string::npos) << text.out;
  EXPECT_EQ(text.err, "");
}

TEST_F(Evaluate, AFileAgainstItselfIsZero) {
  for (const char* const name : {"truth.csv", "truth.tum", "truth.kitti"}) {
    for (const char* const kind : {"none", "sim3"}) {
      SCOPED_TRACE(std::string(name) + " " + kind);
      const json out = evaluated({path(name), path(name), "--align", kind});
      for (const char* const key :
           {"ate_rmse_m", "ate_max_m", "ate_sd_m", "ate_rotation_max_deg", "heading_max_deg",
            "rpe_per_m_max_m", "rpe_per_m_rotation_max_deg", "drift_percent", "end_error_m"})
        EXPECT_EQ(out.at(key), 0.0) << key;
      EXPECT_EQ(out.at("alignment").at("scale"), 1.0);
    }
  }
}

TEST_F(Evaluate, EveryFormatIsTheSameTrajectory) {
  for (const char* const name : {"truth.tum", "truth.kitti", "tum.txt", "kitti.txt"}) {
    const json out = evaluated({path(name), path("truth.csv")});
    EXPECT_EQ(out.at("pairs"), 200) << name;
    EXPECT_LT(out.at("ate_max_m"), 1e-9) << name;
    EXPECT_LT(out.at("heading_max_deg"), 1e-8) << name;
  }
  EXPECT_EQ(evaluated({path("kitti.txt"), path("truth.csv")}).at("association"), "order");
  fs::copy(path("truth.tum"), path("truth.log"));
  EXPECT_EQ(evaluate({path("truth.log"), path("truth.csv")}).exit_code, 3);
  EXPECT_EQ(
      evaluated({path("truth.log"), path("truth.csv"), "--format-est", "tum"}).at("est_format"),
      "tum");
  const json kitti = evaluated({path("truth.kitti"), path("truth.kitti")});
  EXPECT_EQ(kitti.at("duration_s"), nullptr);
  EXPECT_EQ(kitti.at("rpe_per_s_rmse_m"), nullptr);
  EXPECT_EQ(kitti.at("nees_position_mean"), nullptr);
}

TEST_F(Evaluate, ATrackWithoutYaw) {
  std::string track = "frame,time_s,x_m,y_m,status\n";
  int i = 0;
  for (const TrajectoryPose& pose : poses()) {
    track += i == 7 ? line("%d,%.9f,,,dark\n", i, seconds(pose))
                    : line("%d,%.9f,%.12f,%.12f,ok\n", i, seconds(pose), pose.x_m + 1.0, pose.y_m);
    ++i;
  }
  write_text(path("track.csv"), track);
  const json out = evaluated({path("track.csv"), path("truth.csv")});
  EXPECT_EQ(out.at("pairs"), 199);
  EXPECT_EQ(out.at("est_rows_skipped"), 1);
  EXPECT_NEAR(out.at("ate_rmse_m"), 1.0, 1e-9);
  EXPECT_EQ(out.at("heading_rmse_deg"), nullptr);
  EXPECT_EQ(out.at("rpe_of"), "displacement");
  EXPECT_NEAR(out.at("rpe_per_m_rmse_m"), 0.0, 1e-9);
  EXPECT_NE(out.at("warnings")[0].get<std::string>().find("1 rows without a pose were skipped, the "
                                                          "first at line 9"),
            std::string::npos);
}

TEST_F(Evaluate, WritesAPage) {
  const ProgramResult result =
      evaluate({path("estimate.csv"), path("truth.csv"), "--align", "origin", "-o", path("out")});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.out.find("ATE, m"), std::string::npos);
  EXPECT_EQ(json::parse(read_text(path("out/evaluation.json"))).at("align"), "origin");
  const std::string page = read_text(path("out/evaluation.html"));
  std::size_t drawings = 0;
  for (std::size_t at = page.find("<svg"); at != std::string::npos; at = page.find("<svg", at + 1))
    ++drawings;
  EXPECT_EQ(drawings, 4U);
  EXPECT_NE(page.find("estimate, aligned"), std::string::npos);
  EXPECT_EQ(page.find("<script"), std::string::npos);
  EXPECT_EQ(page.find("nan"), std::string::npos);
}

// Figures of one drive in two clocks, or of two drives: which of both is said.
TEST_F(Evaluate, StampsThatDoNotFitAreRefused) {
  const auto with_times = [&](double first_s, int reversed_after) {
    std::string out = "time_s,x_m,y_m,yaw_rad\n";
    for (int i = 0; i < 20; ++i) {
      const int k = i > reversed_after ? 20 - i : i;
      out += line("%.9f,0,0,0\n", first_s + k);
    }
    write_text(path("other.csv"), out);
  };
  with_times(1000.0, 20);
  ProgramResult result = evaluate({path("other.csv"), path("truth.csv")});
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_NE(result.err.find("the times do not overlap: the estimate is from 1000 to 1019 s, the "
                            "truth from 0 to 19.9 s"),
            std::string::npos)
      << result.err;
  EXPECT_NE(result.err.find("other.csv and "), std::string::npos);
  EXPECT_EQ(evaluate({path("other.csv"), path("truth.csv"), "--offset-s", "-1000"}).exit_code, 0);
  with_times(0.05, 20);
  result = evaluate({path("other.csv"), path("truth.csv")});
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_NE(result.err.find("the nearest differ by 0.05 s; --max-dt-s"), std::string::npos)
      << result.err;
  with_times(0.0, 10);
  result = evaluate({path("other.csv"), path("truth.csv")});
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_NE(result.err.find("other.csv:13: time_s: the time does not increase"), std::string::npos)
      << result.err;
  fs::copy(path("kitti.txt"), path("long.kitti"));
  std::ofstream(path("long.kitti"), std::ios::app) << "1 0 0 0 0 1 0 0 0 0 1 0\n";
  result = evaluate({path("long.kitti"), path("truth.csv")});
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_NE(result.err.find("201 of the estimate and 200 of the truth"), std::string::npos)
      << result.err;
}

TEST_F(Evaluate, RefusesUsageInOneLine) {
  const std::string estimate = path("estimate.csv"), truth = path("truth.csv");
  const struct {
    Args args;
    std::string says;
  } cases[] = {
      {{estimate}, "TRUTH"},
      {{estimate, truth, "--align", "SE3"}, "--align is \"SE3\""},
      {{estimate, truth, "--rpe-m", "0"}, "--rpe-m must be above 0"},
      {{estimate, truth, "--rpe-s", "nan"}, "--rpe-s must be above 0"},
      {{estimate, truth, "--max-dt-s", "-1"}, "--max-dt-s must be"},
      {{estimate, truth, "--offset-s", "1e300"}, "--offset-s must be"},
      {{estimate, truth, "--segments-m", "1,,2"}, "--segments-m is \"1,,2\""},
      {{estimate, truth, "--segments-m", "1,-2"}, "--segments-m is \"1,-2\""},
      {{estimate, truth, "--format-est", "bag"}, "--format-est is \"bag\""},
      {{path("truth.kitti"), truth, "--offset-s", "1"}, "KITTI has none"},
      {{estimate, truth, "--json", estimate}, "is an input of this run"},
  };
  const std::string before = read_text(estimate);
  for (const auto& [args, says] : cases) {
    expect_one_line_error(evaluate(args), 2, says);
  }
  EXPECT_EQ(read_text(estimate), before);
}

TEST_F(Evaluate, HostileFilesAreRefusedInOneLine) {
  const struct {
    const char* name;
    std::string text;
    std::string says;
  } cases[] = {
      {"a.csv", "", "a.csv: no line that names the columns"},
      {"a.csv", "time_s,x_m\n0,0\n", "a.csv: no column y_m"},
      {"a.csv", "time_s,x_m,y_m\n0,0,zero\n", "a.csv:2: y_m is \"zero\""},
      {"a.tum", "0 0 0 0 0 0 0 2\n", "a.tum:1: qx qy qz qw"},
      {"a.kitti", "1 0 0 0 0 1 0 0 0 0 1 x\n", "a.kitti:1: tz is \"x\""},
      {"a.txt", "1 2 3\n", "a.txt:1: must hold 8 numbers"},
      {"a.png", "\x89PNG\r\n", "a.png: the extension"},
  };
  for (const auto& [name, text, says] : cases) {
    write_text(path(name), text);
    expect_one_line_error(evaluate({path(name), path("truth.csv")}), 3, says);
  }
  EXPECT_EQ(evaluate({path("none.csv"), path("truth.csv")}).exit_code, 3);
  EXPECT_EQ(evaluate({folder_, path("truth.csv")}).exit_code, 3);
  EXPECT_EQ(evaluate({path("estimate.csv"), path("truth.csv"), "-o", path("truth.csv")}).exit_code,
            1);
}

}  // namespace
}  // namespace lsv
