// SPDX-License-Identifier: BSD-3-Clause
// `lsv calibrate geometry` as a user meets it. The physics is tested beside its functions; here:
// units as typed, what is said for people and for programs, what is refused.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/support/run_program.h"
#include "tests/tools/run_lsv.h"

namespace lsv {
namespace {

using nlohmann::json;
using test::Args;
using test::expect_one_line_error;
using test::ProgramResult;
using test::with;

ProgramResult geometry(const Args& args) {
  Args command = {LSV_PROGRAM, "calibrate", "geometry"};
  command.insert(command.end(), args.begin(), args.end());
  return test::run_program(command);
}

json geometry_json(const Args& args) {
  const ProgramResult result = geometry(with(args, {"--json", "-"}));
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "");
  return json::parse(result.out);
}

const Args kEqualHeights = {"--source-distance-m", "0.1", "--sensor-distance-m", "0.1"};
const Args kUnequalHeights = {"--source-distance-m", "0.1", "--sensor-distance-m", "0.11"};
const Args kCamera = {"--pixel-um", "14", "--rate-hz", "1000", "--size", "128x64"};

TEST(CalibrateGeometry, NumbersForProgramsInSiUnits) {
  const json out = geometry_json(with(
      with(kEqualHeights, kCamera),
      {"--wavelength-nm", "532", "--spot-mm", "1.2", "--speed-mm-s", "80", "--sigma-px", "0.1"}));
  EXPECT_EQ(out.at("schema"), "lsv.geometry/1");
  EXPECT_EQ(out.at("input").at("model"), "objective");
  EXPECT_NEAR(out.at("input").at("pixel_pitch_m").get<double>(), 14e-6, 1e-15);
  const json& scale = out.at("scale");
  EXPECT_EQ(scale.at("sc_ratio"), 2.0);
  EXPECT_EQ(scale.at("sc_slope_height_per_m"), 0.0);
  EXPECT_NEAR(scale.at("sc_slope_sensor_per_m").get<double>(), 10.0, 1e-9);
  EXPECT_NEAR(scale.at("surface_m_per_px").get<double>(), 7e-6, 1e-15);
  EXPECT_NEAR(scale.at("tilt_travel_m_s_per_rad_s").get<double>(), 0.1, 1e-12);
  EXPECT_NEAR(out.at("speckle").at("size_px").get<double>(), 3.167, 0.001);
  EXPECT_NEAR(out.at("window").at("largest_speed_x_m_s").get<double>(), 0.224, 1e-9);
  EXPECT_NEAR(out.at("window").at("largest_speed_y_m_s").get<double>(), 0.112, 1e-9);
  EXPECT_NEAR(out.at("window").at("ground_y_m").get<double>(), 448e-6, 1e-12);
  EXPECT_NEAR(out.at("noise").at("velocity_sigma_m_s").get<double>(), 0.7e-3, 1e-12);
  EXPECT_NEAR(out.at("speed").at("shift_px_per_frame").get<double>(), 11.43, 0.005);
  EXPECT_TRUE(out.at("measured").is_null());
  EXPECT_TRUE(out.at("warnings").empty());
}

TEST(CalibrateGeometry, WhatWasNotGivenIsNull) {
  const json out = geometry_json({"--collimated", "--sensor-distance-m", "0.1"});
  EXPECT_EQ(out.at("scale").at("sc_ratio"), 1.0);
  EXPECT_EQ(out.at("input").at("collimated"), true);
  EXPECT_TRUE(out.at("input").at("source_distance_m").is_null());
  EXPECT_TRUE(out.at("speckle").at("size_m").is_null());
  EXPECT_TRUE(out.at("window").at("largest_speed_x_m_s").is_null());
  EXPECT_TRUE(out.at("speed").at("shift_px_per_frame").is_null());
}

TEST(CalibrateGeometry, ExplainsAMeasuredScale) {
  const json unequal = geometry_json(with(kUnequalHeights, {"--measured-sc", "2.05",
                                                            "--measured-sc-sigma", "0.002"}))
                           .at("measured");
  const json& by = unequal.at("explained_by");
  EXPECT_NEAR(unequal.at("sc_difference_ratio").get<double>(), -0.05, 1e-12);
  EXPECT_NEAR(by.at("sensor").at("change_m").get<double>(), -5e-3, 1e-12);
  EXPECT_NEAR(by.at("sensor").at("sigma_m").get<double>(), 0.2e-3, 1e-12);
  EXPECT_NEAR(by.at("source").at("change_m").get<double>(), 0.11 / 1.05 - 0.1, 1e-12);
  EXPECT_NEAR(by.at("height").at("change_m").get<double>(), 0.1, 1e-12);

  const json equal = geometry_json(with(kEqualHeights, {"--measured-sc", "1.985"})).at("measured");
  EXPECT_TRUE(equal.at("explained_by").at("height").is_null());
  EXPECT_NEAR(equal.at("explained_by").at("incidence").at("angle_rad").get<double>(), 0.12278,
              1e-5);
  EXPECT_TRUE(equal.at("sc_sigma_ratio").is_null());
}

TEST(CalibrateGeometry, ExplainsForPeople) {
  const ProgramResult equal = geometry(with(kEqualHeights, {"--measured-sc", "1.985"}));
  EXPECT_EQ(equal.exit_code, 0) << equal.err;
  EXPECT_EQ(equal.err, "");
  for (const char* says :
       {"Sc 2.00000", "1 deg/s moves the pattern by 3.491 mm/s and reads as 1.745 mm/s",
        "speckle    give --wavelength-nm, --spot-mm\n", "-0.750 %",
        "at 98.5 mm, not 100 mm: -1.5 mm",
        "height   cannot explain it: source and sensor at one height give 2 at every height",
        "beam     7.03 deg off the normal"}) {
    EXPECT_NE(equal.out.find(says), std::string::npos) << says << " in\n" << equal.out;
  }
  const ProgramResult close =
      geometry(with(kEqualHeights, {"--measured-sc", "1.999", "--measured-sc-sigma", "0.001"}));
  EXPECT_NE(close.out.find("agree within 2 sigma"), std::string::npos) << close.out;
  EXPECT_EQ(close.out.find("explain"), std::string::npos) << close.out;
}

TEST(CalibrateGeometry, WarnsOfAliasingAndOfSpeedBeyondTheRange) {
  const Args optics = with(with(kEqualHeights, kCamera), {"--wavelength-nm", "532"});
  const auto warnings = [&](const Args& more) {
    return geometry_json(with(optics, more)).at("warnings").dump();
  };
  EXPECT_NE(warnings({"--spot-mm", "2"}).find("aliases"), std::string::npos);
  EXPECT_NE(warnings({"--spot-mm", "1.5"}).find("recommended 3 px"), std::string::npos);
  EXPECT_EQ(warnings({"--spot-mm", "1.2", "--speed-mm-s", "111"}), "[]");
  EXPECT_NE(warnings({"--speed-mm-s", "113"}).find("beyond the range"), std::string::npos);
  // The cure that the warning names cures it.
  EXPECT_NE(warnings({"--spot-mm", "2"}).find("make the spot 1.27 mm"), std::string::npos);
  EXPECT_EQ(warnings({"--spot-mm", "1.26"}), "[]");
}

TEST(CalibrateGeometry, ImagedSpeckle) {
  const json out = geometry_json({"--magnification", "0.25", "--f-number", "20", "--focal-mm", "25",
                                  "--source-distance-m", "0.15", "--wavelength-nm", "660",
                                  "--pixel-um", "5.5", "--measured-sc", "0.255"});
  EXPECT_EQ(out.at("input").at("model"), "imaged");
  EXPECT_EQ(out.at("scale").at("sc_ratio"), 0.25);
  EXPECT_NEAR(out.at("scale").at("object_distance_m").get<double>(), 0.125, 1e-12);
  EXPECT_NEAR(out.at("scale").at("relative_slope_height_refocused_per_m").get<double>(), -10.0,
              1e-9);
  EXPECT_NEAR(out.at("scale").at("relative_slope_height_fixed_focus_per_m").get<double>(),
              1.0 / 0.15, 1e-9);
  EXPECT_NEAR(out.at("speckle").at("size_px").get<double>(), 3.0, 1e-9);
  EXPECT_NEAR(out.at("measured").at("explained_by").at("defocus").at("defocus_m").get<double>(),
              3e-3, 1e-9);
  const ProgramResult text = geometry({"--magnification", "0.25"});
  EXPECT_NE(text.out.find("height     give --source-distance-m or --collimated"), std::string::npos)
      << text.out;
}

TEST(CalibrateGeometry, TableOnStandardOutputAndJsonInAFile) {
  const std::string path = test::fresh_directory() + "/geometry.json";
  const ProgramResult result = geometry(with(kEqualHeights, {"--json", path}));
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.out.rfind("optics ", 0), 0U) << result.out;
  EXPECT_EQ(json::parse(test::read_text(path)).at("scale").at("sc_ratio"), 2.0);
}

TEST(CalibrateGeometry, RefusesInOneLineThatNamesTheOption) {
  const struct {
    Args args;
    std::string says;
  } cases[] = {
      {{}, "--sensor-distance-m"},
      {{"--sensor-distance-m", "0.1"}, "--source-distance-m"},
      {with(kEqualHeights, {"--collimated"}), "excludes"},
      {{"--collimated", "--sensor-distance-m", "110"}, "--sensor-distance-m is 110"},
      {{"--collimated", "--sensor-distance-m", "-0.1"}, "--sensor-distance-m is -0.1"},
      {{"--collimated", "--sensor-distance-m", "nan"}, "--sensor-distance-m is nan"},
      {{"--sensor-distance-m", "0.1", "--source-distance-m", "inf"}, "--source-distance-m is inf"},
      {{"--sensor-distance-m", "0.1", "--source-distance-m", "0"}, "--source-distance-m is 0"},
      {with(kEqualHeights, {"--magnification", "1"}), "--sensor-distance-m is for objective"},
      {{"--magnification", "1", "--spot-mm", "1"}, "--spot-mm is for objective"},
      {with(kEqualHeights, {"--f-number", "8"}), "--f-number needs --magnification"},
      {with(kEqualHeights, {"--focal-mm", "25"}), "--focal-mm needs --magnification"},
      {with(kEqualHeights, {"--wavelength-nm", "0.532"}), "--wavelength-nm is 0.532"},
      {with(kEqualHeights, {"--spot-mm", "0"}), "--spot-mm is 0"},
      {with(kEqualHeights, {"--pixel-um", "14e-6"}), "--pixel-um"},
      {with(kEqualHeights, {"--rate-hz", "0"}), "--rate-hz is 0"},
      {with(kEqualHeights, {"--rate-hz", "fast"}), "--rate-hz"},
      {with(kEqualHeights, {"--size", "128"}), "--size is \"128\""},
      {with(kEqualHeights, {"--size", "0x128"}), "--size is 0x128"},
      {with(kEqualHeights, {"--size", "128x-1"}), "--size is 128x-1"},
      {with(kEqualHeights, {"--speed-mm-s", "-80"}), "--speed-mm-s is -80"},
      {with(kEqualHeights, {"--sigma-px", "-1"}), "--sigma-px is -1"},
      {with(kEqualHeights, {"--measured-sc", "0"}), "--measured-sc is 0"},
      {with(kEqualHeights, {"--measured-sc-sigma", "0.1"}), "needs --measured-sc"},
      {with(kEqualHeights, {"--measured-sc", "2", "--measured-sc-sigma", "nan"}), "is nan"},
  };
  for (const auto& [args, says] : cases) {
    expect_one_line_error(geometry(args), 2, says);
  }
}

TEST(CalibrateGeometry, OutputThatCannotBeWritten) {
  const ProgramResult result =
      geometry(with(kEqualHeights, {"--json", test::fresh_directory() + "/missing/g.json"}));
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_EQ(result.out, "");
  EXPECT_NE(result.err.find("g.json"), std::string::npos) << result.err;
}

}  // namespace
}  // namespace lsv
