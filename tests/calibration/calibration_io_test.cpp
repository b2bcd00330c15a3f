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

const std::string kFormat = "[format]\nwidth_px = 128\nheight_px = 96\nbit_depth = 8\n";

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
      {with("lsv.calibration/1", "lsv.calibration/3"), "c.toml:1: schema"},
      {kGood + kFormat, "c.toml:11: [format] needs schema"},
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

Calibration full_calibration() {
  Calibration c = parse_calibration(kGood, "c.toml").value();
  c.sensor_name = "a \"name\" \xC3\xA9";
  ScaleRecord scale;
  scale.orientation = {.angle_rad = -2.1, .skew_rad = 0.003, .mirrored = true};
  for (std::size_t i = 0; i < 4; ++i) scale.cov[i][i] = 1e-8 * static_cast<double>(i + 1);
  scale.cov[0][2] = scale.cov[2][0] = 0.4e-8;
  scale.height_m = 0.12;
  scale.date = "2026-11-24";
  scale.method = "stage";
  scale.inputs_sha256 = sha256_hex("x");
  c.scale = scale;
  c.format = SensorFormat{.width_px = 128, .height_px = 96, .bit_depth = 8};
  c.maps = MapsRecord{.file = "maps.tif", .sha256 = sha256_hex("m")};
  c.camera = CameraRecord{.k_counts_per_e = 0.0255,
                          .sigma_k_counts_per_e = 3e-5,
                          .dark_noise_e = 19.6,
                          .sigma_dark_noise_e = 0.04,
                          .dsnu_e = 194.0,
                          .sigma_dsnu_e = 1.1,
                          .prnu_ratio = 0.0201,
                          .sigma_prnu_ratio = 1e-4,
                          .saturation_counts = 235.0,
                          .sigma_saturation_counts = 12.0,
                          .saturation_e = 8600.0,
                          .sigma_saturation_e = 450.0,
                          .saturation_reached = true,
                          .dark_frames = 50,
                          .flat_frames = 300,
                          .flat_levels = 6,
                          .date = "2026-11-24",
                          .method = "integrating sphere",
                          .inputs_sha256 = sha256_hex("f")};
  c.mount = Mount{.x_m = 0.3,
                  .y_m = -0.2,
                  .yaw_rad = 1.5,
                  .sigma_x_m = 1e-3,
                  .sigma_y_m = 2e-3,
                  .sigma_yaw_rad = 1e-4};
  return c;
}

TEST(CalibrationText, ReadsBackTheSameNumbers) {
  const Calibration c = full_calibration();
  const std::string text = calibration_text(c);
  const Result<Calibration> read = parse_calibration(text, "c.toml");
  ASSERT_TRUE(read) << read.error().message << "\n" << text;
  const Calibration& r = read.value();
  EXPECT_EQ(r.sensor_name, c.sensor_name);
  EXPECT_EQ(r.sc_x_ratio, c.sc_x_ratio);
  ASSERT_TRUE(r.scale && r.format && r.maps && r.camera && r.mount);
  EXPECT_EQ(r.scale->orientation.angle_rad, -2.1);
  EXPECT_TRUE(r.scale->orientation.mirrored);
  EXPECT_EQ(r.scale->method, "stage");
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = 0; j < 4; ++j)
      EXPECT_NEAR(r.scale->cov[i][j], c.scale->cov[i][j], 1e-20) << i << j;
  }
  EXPECT_EQ(r.format->height_px, 96);
  EXPECT_EQ(r.maps->file, "maps.tif");
  EXPECT_EQ(r.camera->k_counts_per_e, 0.0255);
  EXPECT_EQ(r.camera->sigma_saturation_e, 450.0);
  EXPECT_TRUE(r.camera->saturation_reached);
  EXPECT_EQ(r.camera->flat_frames, 300);
  EXPECT_EQ(r.camera->method, "integrating sphere");
  EXPECT_EQ(r.mount->yaw_rad, 1.5);
  EXPECT_EQ(parse_calibration(calibration_text(r), "c.toml").value().sc_y_ratio, c.sc_y_ratio);
}

TEST(CalibrationText, RefusesWhatCannotBe) {
  const std::string good = calibration_text(full_calibration());
  const struct {
    std::string from, to, says;
  } cases[] = {
      {"mirrored = true", "mirrored = 1", "scale.mirrored must be true or false"},
      {"sigma_angle_rad = ", "sigma_angle_rad = 0 # ", "scale.sigma_angle_rad is 0"},
      {"correlations = [0,", "correlations = [2,", "scale.correlations"},
      {"correlations = [", "correlations = [0.9, 0.9, 0, -0.9, 0, 0] # ", "cannot all hold"},
      {"skew_rad = 0.003", "skew_rad = 1.57", "scale.skew_rad"},
      {"width_px = 128", "width_px = 128.5", "format.width_px must be a whole number"},
      {"height_m = 0.12", "height_m = nan", "scale.height_m"},
      {"yaw_rad = 1.5\n", "", "mount.yaw_rad is missing"},
      {"[maps]", "[mats]", "unknown key mats"},
      {"k_counts_per_e = 0.0255", "k_counts_per_e = nan", "emva1288.k_counts_per_e is nan"},
      {"\nk_counts_per_e = 0.0255", "\nk_counts_per_e = 0", "emva1288.k_counts_per_e is 0 but"},
      {"sigma_dark_noise_e = 0.04", "sigma_dark_noise_e = 0", "emva1288.sigma_dark_noise_e is 0"},
      {"prnu_ratio = 0.0201", "prnu_ratio = 2.01", "emva1288.prnu_ratio is 2.01 but must be"},
      {"saturation_reached = true", "saturation_reached = 1", "saturation_reached must be true"},
      {"flat_levels = 6", "flat_levels = 6.5", "emva1288.flat_levels must be a whole number"},
      {"dark_frames = 50\n", "", "the key emva1288.dark_frames is missing"},
      {"dsnu_e = 194", "dsnu_counts = 5", "unknown key emva1288.dsnu_counts"},
  };
  for (const auto& [from, to, says] : cases) {
    std::string text = good;
    const std::size_t at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from << "\n" << text;
    text.replace(at, from.size(), to);
    const Result<Calibration> read = parse_calibration(text, "c.toml");
    ASSERT_FALSE(read) << says;
    EXPECT_NE(read.error().message.find(says), std::string::npos) << read.error().message;
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
