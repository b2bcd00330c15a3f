// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/calibration_io.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "calibration/sha256.h"

namespace lsv {
namespace {

const std::string kGood = R"(schema = "lsv.calibration/1"
[sensor]
name = "bench"
pixel_pitch_x_m = 14e-6
pixel_pitch_y_m = 15e-6
sc_x_ratio = 1.985
sc_y_ratio = 2
[camera]
noise_mean_counts = 3.0
noise_sd_counts = 0.5
)";

std::string with(const std::string& from, const std::string& to) {
  std::string out = kGood;
  const std::size_t at = out.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return out.replace(at, from.size(), to);
}

TEST(ParseCalibration, ReadsEveryKey) {
  const Result<Calibration> result = parse_calibration(kGood, "c.toml");
  ASSERT_TRUE(result) << result.error().message;
  const Calibration& c = result.value();
  EXPECT_EQ(c.sensor_name, "bench");
  EXPECT_EQ(c.pixel_pitch_x_m, 14e-6);
  EXPECT_EQ(c.pixel_pitch_y_m, 15e-6);
  EXPECT_EQ(c.sc_x_ratio, 1.985);
  EXPECT_EQ(c.sc_y_ratio, 2.0);
  EXPECT_EQ(c.noise_mean_counts, 3.0);
  EXPECT_EQ(c.noise_sd_counts, 0.5);
  EXPECT_EQ(c.digest, sha256_hex(kGood));
}

TEST(ParseCalibration, AcceptsWindowsLineEndsAndAByteOrderMark) {
  std::string text = "\xEF\xBB\xBF";
  for (const char c : kGood) text += c == '\n' ? std::string("\r\n") : std::string(1, c);
  const Result<Calibration> result = parse_calibration(text, "c.toml");
  ASSERT_TRUE(result) << result.error().message;
  EXPECT_EQ(result.value().sc_y_ratio, 2.0);
}

TEST(ParseCalibration, RefusesWithFileLineAndKey) {
  const struct {
    std::string text;
    std::string says;
  } cases[] = {
      {with("sc_x_ratio = 1.985", "sc_x_ratio = 0"), "c.toml:6: sensor.sc_x_ratio"},
      {with("sc_x_ratio = 1.985", "sc_x_ratio = -2.0"), "c.toml:6: sensor.sc_x_ratio"},
      {with("sc_y_ratio = 2", "sc_y_ratio = nan"), "c.toml:7: sensor.sc_y_ratio"},
      {with("sc_y_ratio = 2", "sc_y_ratio = inf"), "c.toml:7: sensor.sc_y_ratio"},
      {with("sc_y_ratio = 2", "sc_y_ratio = \"2\""), "c.toml:7: sensor.sc_y_ratio"},
      {with("14e-6", "1e999"), "c.toml:4:"},
      {with("14e-6", "14"), "c.toml:4: sensor.pixel_pitch_x_m is 14 but must be between"},
      {with("noise_sd_counts = 0.5", "noise_sd_counts = -0.5"), "c.toml:10: camera.noise_sd"},
      {with("noise_sd_counts = 0.5\n", ""), "c.toml: the key camera.noise_sd_counts is missing"},
      {with("sc_x_ratio = 1.985\n", ""), "c.toml: the key sensor.sc_x_ratio is missing"},
      {with("name = \"bench\"\n", ""), "sensor.name is missing"},
      {with("name = \"bench\"", "name = 7"), "c.toml:3: sensor.name"},
      {with("sc_x_ratio", "sc_x"), "c.toml:6: unknown key sensor.sc_x"},
      {with("[camera]", "[lens]\nf_m = 0.05\n[camera]"), "c.toml:8: unknown key lens"},
      {with("lsv.calibration/1", "lsv.calibration/2"), "c.toml:1: schema"},
      {with("schema = \"lsv.calibration/1\"\n", ""), "the key schema is missing"},
      {with("[camera]", "[sensor]"), "c.toml:8:"},
      {with("sc_y_ratio = 2", "sc_y_ratio = 2\nsc_y_ratio = 3"), "c.toml:8:"},
      {with("sc_y_ratio = 2", "sc_y_ratio ="), "c.toml:7:"},
      {with("[camera]", "\xC3\xA9 = 1\n[camera]"), "c.toml:8:"},
      {kGood.substr(0, 60), "c.toml:"},
      {"", "c.toml: "},
      {"sensor = 3\ncamera = 4\nschema = \"lsv.calibration/1\"\n", "c.toml:1: sensor must be"},
  };
  for (const auto& [text, says] : cases) {
    const Result<Calibration> result = parse_calibration(text, "c.toml");
    ASSERT_FALSE(result) << says;
    EXPECT_EQ(result.error().code, ErrorCode::bad_input);
    EXPECT_NE(result.error().message.find(says), std::string::npos) << result.error().message;
    EXPECT_EQ(result.error().message.find('\n'), std::string::npos) << result.error().message;
  }
}

TEST(ParseCalibration, SurvivesDeepNesting) {
  EXPECT_FALSE(parse_calibration("a = " + std::string(100000, '['), "c.toml"));
}

TEST(LoadCalibration, NamesAFileThatIsNotThere) {
  const Result<Calibration> missing = load_calibration("no/such.toml");
  ASSERT_FALSE(missing);
  EXPECT_NE(missing.error().message.find("no/such.toml"), std::string::npos);
  EXPECT_FALSE(load_calibration(testing::TempDir()));
}

TEST(LoadCalibration, TheSampleCalibrationIsTheSensorOfTheThesis) {
  const Result<Calibration> sample =
      load_calibration(LSV_SOURCE_DIR "/sample_frames/calibration.toml");
  ASSERT_TRUE(sample) << sample.error().message;
  EXPECT_EQ(sample.value().pixel_pitch_x_m, 14e-6);
  EXPECT_EQ(sample.value().sc_x_ratio, 1.985);
  EXPECT_EQ(sample.value().sc_y_ratio, 2.0);
}

TEST(Sha256, MatchesThePublishedVector) {
  EXPECT_EQ(sha256_hex("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

}  // namespace
}  // namespace lsv
