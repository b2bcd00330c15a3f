// SPDX-License-Identifier: BSD-3-Clause
// `lsv calibrate mount` and `lsv simulate tracks` as a user meets them. The fits are tested beside
// their functions; here: files in and out, what is said, what is refused.
#include <gtest/gtest.h>

#include <algorithm>
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
using test::expect_one_line_error;
using test::lsv_run;
using test::ProgramResult;
using test::read_text;
using test::with;
using test::write_text;

const std::string kSampleFrames = LSV_SOURCE_DIR "/sample_frames/drive.tif";

/// Of 20 s, small, in `folder`/drive.
ProgramResult simulate(const std::string& folder, const Args& more = {}) {
  return lsv_run(with({"simulate", "tracks", "-o", folder + "/drive", "--duration-s", "20",
                       "--reference-rate-hz", "20", "--track-rate-hz", "100"},
                      more));
}

Args sensor(const std::string& folder, const std::string& name) {
  return {"--track", folder + "/drive/" + name + ".csv", "--calibration",
          folder + "/drive/" + name + ".toml"};
}

ProgramResult mount(const std::string& folder, const Args& more,
                    const std::string& reference = "body.csv") {
  return lsv_run(with(
      {"calibrate", "mount", "--reference", folder + "/drive/" + reference, "-o", folder + "/out"},
      more));
}

ProgramResult mount_both(const std::string& folder, const Args& more = {}) {
  return mount(folder, with(with(sensor(folder, "front"), sensor(folder, "rear")), more));
}

json mount_json(const std::string& folder) {
  return json::parse(read_text(folder + "/out/mount.json"));
}

double worst_sigmas(const json& found, double x_m, double y_m, double yaw_rad) {
  const auto off = [&found](const char* figure, const char* sigma, double truth) {
    return std::abs(found.at(figure).get<double>() - truth) / found.at(sigma).get<double>();
  };
  return std::max({off("x_m", "sigma_x_m", x_m), off("y_m", "sigma_y_m", y_m),
                   off("yaw_rad", "sigma_yaw_rad", yaw_rad)});
}

/// The number behind `key` in a calibration file.
double number_of(const std::string& path, const std::string& key) {
  const std::string text = read_text(path);
  const std::size_t at = text.find("\n" + key + " = ");
  EXPECT_NE(at, std::string::npos) << key << " in " << text;
  return std::stod(text.substr(at + key.size() + 4));
}

// The example of the help, but shorter: truth comes back within its sigmas.
TEST(CalibrateMount, RecoversTheTruthOfTheSimulator) {
  const std::string folder = test::fresh_directory();
  ASSERT_EQ(simulate(folder).exit_code, 0);
  const ProgramResult result = mount_both(folder);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "");
  const test::CsvTable truth(read_text(folder + "/drive/truth.csv"));
  const json out = mount_json(folder);
  EXPECT_EQ(out.at("schema"), "lsv.mount/1");
  EXPECT_EQ(truth.text(0, "sensor"), "front");
  EXPECT_LT(worst_sigmas(out.at("sensors")[0], truth.number(0, "x_m"), truth.number(0, "y_m"),
                         truth.number(0, "yaw_rad")),
            3.5);
  const json& pair = out.at("pairs")[0];
  EXPECT_NEAR(pair.at("reads_ratio").get<double>(), truth.number(1, "reads_ratio"),
              3.5 * pair.at("sigma_reads_ratio").get<double>());
  EXPECT_LT(pair.at("sigma_reads_ratio").get<double>(), 2e-4);
  // The rear one reads more and sits to the right: a turn to the left, (ratio - 1) 0.3 / 0.55^2...
  EXPECT_NEAR(pair.at("false_yaw_rad_per_m").get<double>(), 1e-3 * 0.3 / (0.55 * 0.55 + 0.3 * 0.3),
              5e-5);
  EXPECT_NEAR(pair.at("false_yaw_deg_per_h_at_42_mm_s").get<double>(),
              pair.at("false_yaw_rad_per_m").get<double>() * 0.042 * 180.0 / M_PI * 3600.0, 1e-9);
  EXPECT_NE(out.at("warnings").dump().find("rear reads +0.1"), std::string::npos);
  EXPECT_NE(result.out.find("--correct-ratio"), std::string::npos) << result.out;
}

// The new calibration is the old one with a mount, and lsv track takes it.
TEST(CalibrateMount, WritesTheCalibrationOfEachSensor) {
  const std::string folder = test::fresh_directory();
  ASSERT_EQ(simulate(folder).exit_code, 0);
  ASSERT_EQ(mount_both(folder).exit_code, 0);
  const json out = mount_json(folder);
  for (const std::size_t i : {0U, 1U}) {
    const std::string path = folder + "/out/" + (i == 0 ? "front.toml" : "rear.toml");
    EXPECT_EQ(number_of(path, "x_m"), out.at("sensors")[i].at("x_m").get<double>());
    EXPECT_EQ(number_of(path, "yaw_rad"), out.at("sensors")[i].at("yaw_rad").get<double>());
    EXPECT_EQ(number_of(path, "sc_x_ratio"), 1.985);
    const ProgramResult tracked =
        lsv_run({"track", kSampleFrames, "--rate-hz", "1000", "--calibration", path, "--csv",
                 folder + "/t.csv", "-q"});
    EXPECT_EQ(tracked.exit_code, 0) << tracked.err;
  }
  const std::string page = read_text(folder + "/out/report.html");
  EXPECT_NE(page.find("<svg"), std::string::npos);
  EXPECT_NE(page.find("would fit as well"), std::string::npos);
  EXPECT_EQ(page.find("<script"), std::string::npos);
  EXPECT_EQ(page.find("nan"), std::string::npos);
  // The same input gives the same bytes.
  fs::rename(folder + "/out", folder + "/before");
  ASSERT_EQ(mount_both(folder).exit_code, 0);
  for (const char* name : {"front.toml", "rear.toml"})
    EXPECT_EQ(read_text(folder + "/out/" + name), read_text(folder + "/before/" + name));
  EXPECT_EQ(read_text(folder + "/out/report.html"), page);
}

TEST(CalibrateMount, CorrectsTheRatio) {
  const std::string folder = test::fresh_directory();
  ASSERT_EQ(simulate(folder).exit_code, 0);
  ASSERT_EQ(mount_both(folder, {"--correct-ratio"}).exit_code, 0);
  const json out = mount_json(folder);
  const double ratio = out.at("pairs")[0].at("reads_ratio");
  EXPECT_EQ(out.at("pairs")[0].at("corrected"), true);
  EXPECT_EQ(number_of(folder + "/out/front.toml", "sc_x_ratio"), 1.985);
  EXPECT_NEAR(number_of(folder + "/out/rear.toml", "sc_x_ratio"), 1.985 * ratio, 1e-12);
  EXPECT_NEAR(number_of(folder + "/out/rear.toml", "sc_y_ratio"), 2.0 * ratio, 1e-12);
  EXPECT_LT(worst_sigmas(out.at("sensors")[1], -0.25, -0.15, -1.5), 3.5);
  // With the corrected calibration in its place there is nothing left to correct.
  fs::copy(folder + "/out/rear.toml", folder + "/drive/rear.toml",
           fs::copy_options::overwrite_existing);
  fs::remove_all(folder + "/out");
  ASSERT_EQ(mount_both(folder).exit_code, 0);
  EXPECT_NEAR(mount_json(folder).at("pairs")[0].at("reads_ratio").get<double>(), 1.0, 1e-9);
}

TEST(CalibrateMount, ReadsTumFiles) {
  const std::string folder = test::fresh_directory();
  ASSERT_EQ(simulate(folder).exit_code, 0);
  const test::CsvTable body(read_text(folder + "/drive/body.csv"));
  std::string tum = "# t x y z qx qy qz qw\n";
  char line[160];
  for (std::size_t i = 0; i < body.rows(); ++i) {
    const double half_rad = 0.5 * body.number(i, "yaw_rad");
    std::snprintf(line, sizeof line, "%s %.9f  %.9f 0 0 0 %.12f %.12f\n",
                  body.text(i, "time_s").c_str(), body.number(i, "x_m"), body.number(i, "y_m"),
                  std::sin(half_rad), std::cos(half_rad));
    tum += line;
  }
  write_text(folder + "/drive/body.tum", tum);
  ASSERT_EQ(mount(folder, sensor(folder, "front")).exit_code, 0);
  const json csv = mount_json(folder);
  const Args front = sensor(folder, "front");
  EXPECT_EQ(mount(folder, front, "body.tum").exit_code, 3);
  const ProgramResult result =
      mount(folder, with(front, {"--sigma-reference-m", "1e-3", "--sigma-reference-rad", "1e-3"}),
            "body.tum");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json found = mount_json(folder).at("sensors")[0];
  EXPECT_NEAR(found.at("x_m"), csv.at("sensors")[0].at("x_m").get<double>(), 1e-7);
  EXPECT_NEAR(found.at("yaw_rad"), csv.at("sensors")[0].at("yaw_rad").get<double>(), 1e-7);
}

// What the position column holds over refused frames must not count.
TEST(CalibrateMount, RefusedFramesAndLostGround) {
  const std::string folder = test::fresh_directory();
  ASSERT_EQ(simulate(folder, {"--refused", "0.05", "--lost-s", "7,8.5"}).exit_code, 0);
  ASSERT_EQ(mount(folder, sensor(folder, "front")).exit_code, 0);
  const json found = mount_json(folder).at("sensors")[0];
  EXPECT_LT(worst_sigmas(found, 0.30, 0.15, 0.05), 3.5);
  EXPECT_GE(found.at("gaps"), 1);
  EXPECT_GT(found.at("shifts_rejected"), 150);
  EXPECT_EQ(found.at("sigma_factor"), 1.0);
}

TEST(CalibrateMount, TellsAClockThatIsOff) {
  const std::string folder = test::fresh_directory();
  ASSERT_EQ(simulate(folder, {"--clock-ahead-s", "0.05"}).exit_code, 0);
  const ProgramResult ignorant = mount(folder, sensor(folder, "front"));
  ASSERT_EQ(ignorant.exit_code, 0) << ignorant.err;
  EXPECT_NE(ignorant.out.find("its clock is ahead of that of the reference by +5"),
            std::string::npos)
      << ignorant.out;
  const ProgramResult fitted = mount(folder, with(sensor(folder, "front"), {"--fit-clock"}));
  ASSERT_EQ(fitted.exit_code, 0) << fitted.err;
  const json found = mount_json(folder).at("sensors")[0];
  EXPECT_NEAR(found.at("clock_offset_s"), -0.05,
              4.0 * found.at("sigma_clock_offset_s").get<double>());
  EXPECT_LT(worst_sigmas(found, 0.30, 0.15, 0.05), 3.5);
  EXPECT_EQ(fitted.out.find("its clock"), std::string::npos) << fitted.out;
}

TEST(CalibrateMount, ADriveThatDoesNotTellIsRefusedWithItsReason) {
  const std::string straight = test::fresh_directory();
  ASSERT_EQ(simulate(straight, {"--drive", "straight"}).exit_code, 0);
  const ProgramResult refused = mount(straight, sensor(straight, "front"));
  EXPECT_EQ(refused.exit_code, 3);
  EXPECT_NE(refused.err.find("front.csv: the body turned by only"), std::string::npos)
      << refused.err;
  EXPECT_FALSE(fs::exists(straight + "/out"));
  const ProgramResult given = mount_both(
      straight, {"--lever", "0.3,0.15", "--lever", "-0.25,-0.15", "--lever-sigma-m", "0.001"});
  ASSERT_EQ(given.exit_code, 0) << given.err;
  const json out = mount_json(straight);
  EXPECT_NEAR(out.at("sensors")[0].at("sigma_x_m"), 0.001, 1e-4);
  EXPECT_NEAR(out.at("pairs")[0].at("reads_ratio"), 1.001, 2e-4);
  // Without a curve nothing tells on which side y is.
  EXPECT_NEAR(out.at("sensors")[0].at("mirrored").at("yaw_rad"), -0.05, 1e-3);

  const std::string circle = test::fresh_directory();
  ASSERT_EQ(simulate(circle, {"--drive", "circle"}).exit_code, 0);
  const ProgramResult round = mount(circle, sensor(circle, "front"));
  EXPECT_EQ(round.exit_code, 3);
  EXPECT_NE(round.err.find("cannot be told apart"), std::string::npos) << round.err;
}

TEST(CalibrateMount, RefusesUsageInOneLine) {
  const std::string folder = test::fresh_directory();
  ASSERT_EQ(simulate(folder).exit_code, 0);
  const Args front = sensor(folder, "front");
  const Args both = with(front, sensor(folder, "rear"));
  const struct {
    Args args;
    std::string says;
  } cases[] = {
      {{}, "--track"},
      {{"--track", "a.csv"}, "--calibration"},
      {with(front, {"--track", "b.csv"}), "one --calibration for each --track"},
      {with(front, front), "two calibrations are named front.toml"},
      {with(both, {"--lever", "1,2", "--lever-sigma-m", "1"}), "--lever for each --track"},
      {with(front, {"--lever", "1,2"}), "--lever-sigma-m go together"},
      {with(front, {"--lever", "1,2,3", "--lever-sigma-m", "1"}), "--lever is \"1,2,3\""},
      {with(front, {"--lever", "1,101", "--lever-sigma-m", "1"}), "--lever is \"1,101\""},
      {with(front, {"--lever", "1,1", "--lever-sigma-m", "0"}), "--lever-sigma-m must be above 0"},
      {with(front, {"--sigma-reference-rad", "nan"}), "--sigma-reference-rad must be above 0"},
      {with(front, {"--correct-ratio"}), "--correct-ratio needs two sensors"},
  };
  for (const auto& [args, says] : cases) {
    expect_one_line_error(mount(folder, args), 2, says);
  }
  EXPECT_FALSE(fs::exists(folder + "/out"));
}

TEST(CalibrateMount, NeverOverwritesWhatItReads) {
  const std::string folder = test::fresh_directory();
  ASSERT_EQ(simulate(folder).exit_code, 0);
  const std::string before = read_text(folder + "/drive/front.toml");
  const ProgramResult result = lsv_run(with(
      {"calibrate", "mount", "--reference", folder + "/drive/body.csv", "-o", folder + "/drive"},
      sensor(folder, "front")));
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.err.find("is an input of this run"), std::string::npos) << result.err;
  EXPECT_EQ(read_text(folder + "/drive/front.toml"), before);
}

/// `text` with the first `what` replaced.
std::string with_replaced(std::string text, const std::string& what, const std::string& by) {
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return text.replace(at, what.size(), by);
}

TEST(CalibrateMount, HostileTablesAreRefusedInOneLine) {
  const std::string folder = test::fresh_directory();
  ASSERT_EQ(simulate(folder).exit_code, 0);
  const std::string body = folder + "/drive/body.csv";
  const std::string track = folder + "/drive/front.csv";
  const std::string good_body = read_text(body);
  const std::string good_track = read_text(track);
  const struct {
    std::string path;
    std::string text;
    std::string says;
  } cases[] = {
      {body, "", "no line that names the columns"},
      {body, "time_s,x_m,y_m\n0,1,2\n", "no column yaw_rad"},
      {body, with_replaced(good_body, ",sigma_m", ",sigma_mm"), "--sigma-reference-m"},
      {body, "time_s,x_m,y_m,yaw_rad,sigma_m,sigma_yaw_rad\n", "holds no pose"},
      {body, with_replaced(good_body, "0.050000000,", "x,"), "time_s is \"x\""},
      {body, with_replaced(good_body, "0.050000000,", "0.000000000,"), "does not increase"},
      {body, "time_s,x_m,y_m,yaw_rad,sigma_m,sigma_yaw_rad\n0,nan,0,0,1,1\n", "not a number"},
      {body, "time_s,x_m,y_m,yaw_rad,sigma_m,sigma_yaw_rad\n0,,0,0,1,1\n", "is empty"},
      {body, "time_s,x_m,y_m,yaw_rad,sigma_m,sigma_yaw_rad\n0,1e300,0,0,1,1\n", "beyond 1e8 m"},
      {body, "time_s,x_m,y_m,yaw_rad,sigma_m,sigma_yaw_rad\n0,0,0,0,0,1\n", "must be above 0"},
      {body, "time_s,x_m,y_m,yaw_rad,sigma_m,sigma_yaw_rad\n0,0,0,0,1,-1\n", "must be above 0"},
      {body, "time_s,x_m,y_m,yaw_rad,sigma_m,sigma_yaw_rad\n4.5e9,0,0,0,1,1\n", "126 years"},
      {track, with_replaced(good_track, "sigma_dx_px", "sigma"), "no column sigma_dx_px"},
      {track, with_replaced(good_track, "0.020000000,0.010000000", "0.020000000,0.000000000"),
       "dt_s of an accepted shift must be above 0"},
      {track, with_replaced(good_track, "0.020000000,0.010000000", "0.020000000,0.015000000"),
       "reaches back"},
      {track, with_replaced(good_track, "0.020000000,0.010000000", "0.005,0.010000000"),
       "does not increase"},
      {track, with_replaced(good_track, ",0.005000,", ",-0.005000,"), "a sigma is below 0"},
      {track, good_track.substr(0, good_track.find("1,0.01")), "holds no accepted shift"},
      {track, "\x89PNG\r\n", "no column time_s"},
      {track,
       with_replaced(good_track, "0.020000000,0.010000000,", "0.020000000,0.010000000,1e308"),
       "front.csv"},
  };
  for (const auto& [path, text, says] : cases) {
    SCOPED_TRACE(says);
    write_text(path, text);
    const ProgramResult result = mount(folder, sensor(folder, "front"));
    expect_one_line_error(result, 3, says);
    EXPECT_NE(result.err.find(fs::path(path).filename().string()), std::string::npos) << result.err;
    EXPECT_FALSE(fs::exists(folder + "/out"));
    write_text(body, good_body);
    write_text(track, good_track);
  }
  const Args named = with(sensor(folder, "front"), {"--sigma-reference-m", "1e-3"});
  EXPECT_NE(mount(folder, named).err.find("leave --sigma-reference-m out"), std::string::npos);
  EXPECT_EQ(mount(folder, sensor(folder, "front"), "none.csv").exit_code, 3);
}

TEST(CalibrateMount, HostileTumFiles) {
  const std::string folder = test::fresh_directory();
  ASSERT_EQ(simulate(folder).exit_code, 0);
  const Args args = with(sensor(folder, "front"),
                         {"--sigma-reference-m", "1e-3", "--sigma-reference-rad", "1e-3"});
  const struct {
    std::string text;
    std::string says;
  } cases[] = {
      {"", "holds no pose"},
      {"0 0 0 0 0 0 0\n", "b.tum:1: must hold t x y z qx qy qz qw"},
      {"# c\n0 0 0 0 0 0 0 2\n", "b.tum:2: qx qy qz qw: the quaternion is not of length 1"},
      {"0 0 0 0 0 0 0 1\n0 0 0 0 0 0 0 1\n", "b.tum:2: t: the time does not increase"},
      {"t 0 0 0 0 0 0 1\n", "b.tum:1: t is \"t\", not a time"},
      {"0 nan 0 0 0 0 0 1\n", "b.tum:1: x is \"nan\", not a number"},
      {std::string("0 0 0 0 0 0 0 1\0\n", 17), "not a number"}};
  for (const auto& [text, says] : cases) {
    write_text(folder + "/drive/b.tum", text);
    const ProgramResult result = mount(folder, args, "b.tum");
    EXPECT_EQ(result.exit_code, 3) << says;
    EXPECT_NE(result.err.find(says), std::string::npos) << says << " in " << result.err;
  }
}

TEST(SimulateTracks, RefusesWhatItCannotMake) {
  const std::string folder = test::fresh_directory();
  const struct {
    Args args;
    std::string says;
  } cases[] = {
      {{"--drive", "spiral"}, "--drive is \"spiral\""},
      {{"--sensor", "a,0,0,0"}, "--sensor is \"a,0,0,0\""},
      {{"--sensor", "a/b,0,0,0,1"}, "letters, digits"},
      {{"--sensor", "body,0,0,0,1"}, "not body or truth"},
      {{"--sensor", "a,0,0,0,1", "--sensor", "a,1,0,0,1"}, "two are named a"},
      {{"--sensor", "a,0,0,0,0"}, "read 0.5 to 2 times"},
      {{"--speed-m-s", "0"}, "--speed-m-s is 0"},
      {{"--refused", "2"}, "--refused is 2"},
      {{"--lost-s", "7"}, "--lost-s is \"7\""},
  };
  for (const auto& [args, says] : cases) {
    const ProgramResult result = simulate(folder, args);
    EXPECT_EQ(result.exit_code, 2) << says;
    EXPECT_NE(result.err.find(says), std::string::npos) << says << " in " << result.err;
    EXPECT_TRUE(fs::is_empty(folder)) << says;
  }
  ASSERT_EQ(simulate(folder).exit_code, 0);
  const std::string before = read_text(folder + "/drive/front.csv");
  EXPECT_EQ(simulate(folder).exit_code, 2);
  EXPECT_EQ(read_text(folder + "/drive/front.csv"), before);
}

}  // namespace
}  // namespace lsv
