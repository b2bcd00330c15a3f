// SPDX-License-Identifier: BSD-3-Clause
// `lsv calibrate noise` as a user meets it. The model is tested beside its functions; here: units
// as typed, what is said for people and for programs, what is refused.
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

const std::string kSample = std::string(LSV_SOURCE_DIR) + "/sample_frames/calibration.toml";

/// The example of --help; a later option of the same name would be an error, so `changed` takes the
/// place of the value that is there.
Args arguments(const std::vector<std::pair<std::string, std::string>>& changed = {}) {
  std::vector<std::pair<std::string, std::string>> options = {
      {"--calibration", kSample}, {"--size", "128x128"},     {"--rate-hz", "1000"},
      {"--exposure-us", "200"},   {"--speckle-px", "4"},     {"--mean-counts", "60"},
      {"--speed-mm-s", "80"},     {"--full-well-e", "10000"}};
  for (const auto& [name, value] : changed) {
    const auto same = [&wanted = name](const auto& option) { return option.first == wanted; };
    const auto found = std::find_if(options.begin(), options.end(), same);
    if (found == options.end())
      options.emplace_back(name, value);
    else
      found->second = value;
  }
  Args out;
  for (const auto& [name, value] : options) out.insert(out.end(), {name, value});
  return out;
}

ProgramResult noise(const Args& args) {
  return test::run_program(with({LSV_PROGRAM, "calibrate", "noise"}, args));
}

json noise_json(const Args& args) {
  const ProgramResult result = noise(with(args, {"--json", "-"}));
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "");
  return json::parse(result.out);
}

TEST(CalibrateNoise, NumbersForProgramsInSiUnits) {
  const json out = noise_json(arguments());
  EXPECT_EQ(out.at("schema"), "lsv.noise/1");
  const json& in = out.at("input");
  EXPECT_NEAR(in.at("shift_px").get<double>(), 80e-3 * 1.985 / 14e-6 / 1000.0, 1e-9);
  EXPECT_NEAR(in.at("blur_px").get<double>(), 0.2 * in.at("shift_px").get<double>(), 1e-9);
  EXPECT_EQ(in.at("dark_counts"), 3.0);
  EXPECT_EQ(in.at("noise_sd_counts"), 0.5);
  EXPECT_NEAR(in.at("electrons_per_count").get<double>(), 10000.0 / 255.0, 1e-9);
  const json& pair = out.at("pair");
  EXPECT_EQ(pair.at("in_range"), true);
  const double sigma_x_px = pair.at("x").at("sigma_px").get<double>();
  EXPECT_GT(sigma_x_px, 0.5e-3);
  EXPECT_LT(sigma_x_px, 1.5e-3);
  EXPECT_LT(pair.at("y").at("sigma_px").get<double>(), sigma_x_px);
  EXPECT_NEAR(pair.at("velocity_sigma_x_m_s").get<double>(), sigma_x_px * 14e-6 / 1.985 * 1000.0,
              1e-12);
  EXPECT_GT(out.at("tracking").at("step_sigma_x_px").get<double>(), sigma_x_px);
  const json& best = out.at("recommendation").at("best");
  EXPECT_GE(best.at("rate_hz").get<double>(), 100.0);
  EXPECT_LE(best.at("rate_hz").get<double>(), 1000.0);
  EXPECT_LE(best.at("blur_px").get<double>(), 4.0);
  EXPECT_TRUE(out.at("warnings").empty()) << out.at("warnings");
}

TEST(CalibrateNoise, OptionsComeBeforeTheCalibration) {
  const json in =
      noise_json(
          arguments({{"--noise-counts", "2"}, {"--dark-counts", "9"}, {"--bit-depth", "12"}}))
          .at("input");
  EXPECT_EQ(in.at("noise_sd_counts"), 2.0);
  EXPECT_EQ(in.at("dark_counts"), 9.0);
  EXPECT_EQ(in.at("bit_depth"), 12);
}

TEST(CalibrateNoise, ExplainsForPeople) {
  const ProgramResult result = noise(arguments());
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "");
  for (const char* says :
       {"pitch 14 x 14 um, Sc 1.985 along x", "moves it 11.34 px per frame, 2.27 px while",
        "sigma of the shift, mpx", "velocity, mm/s", "steady tracking", "gate 6",
        "window, rate and exposure for 80 mm/s", "twice the exposure", "half the rate"}) {
    EXPECT_NE(result.out.find(says), std::string::npos) << says << " in\n" << result.out;
  }
  EXPECT_EQ(result.out.find("warning"), std::string::npos) << result.out;
}

TEST(CalibrateNoise, WarnsWhereTheSpeedIsOutOfRange) {
  const auto warnings = [](const std::vector<std::pair<std::string, std::string>>& changed) {
    return noise_json(arguments(changed)).at("warnings").dump();
  };
  EXPECT_NE(warnings({{"--speed-mm-s", "250"}, {"--exposure-us", "20"}}).find("is out of range"),
            std::string::npos);
  EXPECT_NE(warnings({{"--speed-mm-s", "2500"}}).find("can follow this speed"), std::string::npos);
  EXPECT_NE(warnings({{"--exposure-us", "1000"}}).find("expose shorter"), std::string::npos);
  EXPECT_NE(warnings({{"--mean-counts", "0"}}).find("too little signal"), std::string::npos);
  const json dark = noise_json(arguments({{"--mean-counts", "0"}}));
  EXPECT_TRUE(dark.at("pair").at("x").at("sigma_px").is_null());
  EXPECT_TRUE(dark.at("recommendation").at("best").is_null());
}

TEST(CalibrateNoise, TheChoiceKeepsToCameraAndProcessor) {
  const json out = noise_json(arguments({{"--camera-rates", "64:4000,128:1000,256:400"},
                                         {"--windows", "96,192,256"},
                                         {"--push-us", "600"},
                                         {"--update-hz", "200"}}))
                       .at("recommendation");
  ASSERT_EQ(out.at("windows").size(), 3U);
  EXPECT_EQ(out.at("windows").at(0).at("window_px"), 96);
  // 256 px take 2.4 ms: at most 208 Hz.
  const json& large = out.at("windows").at(2);
  EXPECT_LE(large.at("push_load_ratio").get<double>(), 0.5 + 1e-9);
  EXPECT_LT(large.at("rate_hz").get<double>(), 210.0);
}

TEST(CalibrateNoise, AFolderGetsPageAndNumbers) {
  const std::string folder = test::fresh_directory() + "/out";
  const ProgramResult result = noise(with(arguments(), {"-o", folder}));
  EXPECT_EQ(result.exit_code, 0) << result.err;
  const std::string page = test::read_text(folder + "/report.html");
  for (const char* says : {"default-src 'none'", "sigma against window", "sigma against 1 - rho",
                           "Bridget LSV", "class=\"best\""})
    EXPECT_NE(page.find(says), std::string::npos) << says;
  EXPECT_EQ(page.find("http://"), page.find("http://www.w3.org/2000/svg"));
  EXPECT_EQ(page.find("nan"), std::string::npos);
  EXPECT_EQ(json::parse(test::read_text(folder + "/noise.json")).at("schema"), "lsv.noise/1");
}

TEST(CalibrateNoise, TheSameInputGivesTheSameBytes) {
  EXPECT_EQ(noise(arguments()).out, noise(arguments()).out);
}

TEST(CalibrateNoise, HostileInput) {
  using Changed = std::vector<std::pair<std::string, std::string>>;
  const std::pair<Changed, const char*> cases[] = {
      {{{"--rate-hz", "0"}}, "--rate-hz is 0"},
      {{{"--rate-hz", "nan"}}, "--rate-hz is nan"},
      {{{"--rate-hz", "inf"}}, "--rate-hz is inf"},
      {{{"--speed-mm-s", "-80"}}, "--speed-mm-s is -80"},
      {{{"--speed-mm-s", "nan"}}, "--speed-mm-s is nan"},
      {{{"--speed-mm-s", "0"}}, "--speed-mm-s is 0"},
      {{{"--exposure-us", "0"}}, "--exposure-us is 0"},
      {{{"--exposure-us", "1001"}}, "longer than the time between frames"},
      {{{"--speckle-px", "-4"}}, "--speckle-px is -4"},
      {{{"--mean-counts", "-1"}}, "--mean-counts is -1"},
      {{{"--mean-counts", "256"}}, "--mean-counts is 256"},
      {{{"--rho", "1.1"}}, "--rho is 1.1"},
      {{{"--rho", "nan"}}, "--rho is nan"},
      {{{"--full-well-e", "0"}}, "--full-well-e is 0"},
      {{{"--bit-depth", "7"}}, "--bit-depth must be 8 to 16"},
      {{{"--dark-counts", "255"}}, "dark level is at full scale"},
      {{{"--size", "128"}}, "must be WIDTHxHEIGHT"},
      {{{"--size", "0x128"}}, "at least 1 px"},
      {{{"--windows", "64,,128"}}, "--windows is \"64,,128\""},
      {{{"--windows", "4096"}}, "--windows is \"4096\""},
      {{{"--camera-rates", "128"}}, "WINDOW:HZ"},
      {{{"--camera-rates", "128:nan"}}, "WINDOW:HZ"},
      {{{"--camera-rates", "128:-5"}}, "WINDOW:HZ"},
      {{{"--update-hz", "0"}}, "--update-hz is 0"},
      {{{"--push-us", "-1"}}, "--push-us is -1"},
  };
  for (const auto& [changed, says] : cases) {
    expect_one_line_error(noise(arguments(changed)), 2, says);
  }
}

TEST(CalibrateNoise, AMissingCalibrationIsNamed) {
  const ProgramResult missing = noise(arguments({{"--calibration", "/nowhere/sensor.toml"}}));
  EXPECT_EQ(missing.exit_code, 3);
  EXPECT_EQ(missing.out, "");
  EXPECT_NE(missing.err.find("/nowhere/sensor.toml"), std::string::npos) << missing.err;
}

TEST(CalibrateNoise, TheCalibrationIsNeverOverwritten) {
  const std::string copy = test::fresh_directory() + "/sensor.toml";
  std::filesystem::copy_file(kSample, copy);
  const std::string before = test::read_text(copy);
  const ProgramResult result = noise(with(arguments({{"--calibration", copy}}), {"--json", copy}));
  EXPECT_EQ(result.exit_code, 2) << result.err;
  EXPECT_EQ(test::read_text(copy), before);
}

TEST(CalibrateNoise, OutputThatCannotBeWritten) {
  const ProgramResult result =
      noise(with(arguments(), {"--json", test::fresh_directory() + "/missing/n.json"}));
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_EQ(result.out, "");
  EXPECT_NE(result.err.find("n.json"), std::string::npos) << result.err;
}

}  // namespace
}  // namespace lsv
