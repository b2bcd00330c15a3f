// SPDX-License-Identifier: BSD-3-Clause
// `lsv calibrate camera` as a user meets it, from the frames of a camera to a track without its
// fixed pattern. The estimates are tested beside their functions.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/support/csv_table.h"
#include "tests/support/run_program.h"
#include "tests/tools/run_lsv.h"

namespace lsv {
namespace {

using nlohmann::json;
using test::Args;
using test::lsv_run;
using test::ProgramResult;
using test::read_text;
using test::with;

const std::string kBase = LSV_SOURCE_DIR "/sample_frames/calibration.toml";
// 5 counts of offsets on a dark level of 15, so that next to nothing is cut off at 0.
const Args kSensor = {"--noise-mean",  "15", "--dsnu-counts", "5",  "--prnu-percent", "2",
                      "--hot-pixels",  "30", "--dead-pixels", "30", "--full-well",    "10000",
                      "--sensor-seed", "31"};

std::string flat(const std::string& folder, int light_counts, int frames,
                 const Args& more = kSensor) {
  const std::string path = folder + "/light" + std::to_string(light_counts) + ".tif";
  const ProgramResult made =
      lsv_run(with({"simulate", "flat", "-o", path, "--mean-counts", std::to_string(light_counts),
                    "--frames", std::to_string(frames)},
                   more));
  EXPECT_EQ(made.exit_code, 0) << made.err;
  return path;
}

ProgramResult calibrate(const std::string& dark, const Args& flats, const std::string& out,
                        const Args& more = {}) {
  Args args = {"calibrate", "camera", "--dark", dark, "-o", out};
  for (const std::string& path : flats) args.insert(args.end(), {"--flat", path});
  const bool has_base = std::ranges::find(more, "--calibration") != more.end();
  if (!has_base) args.insert(args.end(), {"--calibration", kBase});
  return lsv_run(with(args, more));
}

void expect_refusal(const ProgramResult& result, int exit_code, const std::string& says) {
  EXPECT_EQ(result.exit_code, exit_code) << result.err;
  EXPECT_EQ(std::ranges::count(result.err, '\n'), 1) << result.err;
  EXPECT_NE(result.err.find(says), std::string::npos) << says << " in\n" << result.err;
}

/// In percent of the distance driven along x.
double distance_error_percent(const std::string& frames, double distance_px, const Args& how) {
  const ProgramResult track =
      lsv_run(with({"track", frames, "--rate-hz", "1000", "--csv", "-", "-q"}, how));
  EXPECT_EQ(track.exit_code, 0) << track.err;
  const test::CsvTable rows(track.out);
  const double x_px = rows.number(rows.rows() - 1, "x_m") / (14e-6 / 1.985);
  return 100.0 * (x_px / distance_px - 1.0);
}

// From the frames to the track, through the files: with the maps the distance is right to 0.02 %.
TEST(CalibrateCamera, TakesTheFixedPatternOutOfATrack) {
  const std::string folder = test::fresh_directory();
  Args flats;
  for (const int light : {30, 60, 90, 120, 150, 200, 400}) flats.push_back(flat(folder, light, 30));
  const ProgramResult made =
      calibrate(flat(folder, 0, 30), flats, folder + "/out",
                {"--date", "2026-11-24", "--method", "simulated", "--exposure-us", "30",
                 "--exposure-us", "60", "--exposure-us", "90", "--exposure-us", "120",
                 "--exposure-us", "150", "--exposure-us", "200", "--exposure-us", "400"});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_EQ(made.err, "");
  std::printf("%s", made.out.c_str());

  const json camera = json::parse(read_text(folder + "/out/camera.json"));
  EXPECT_EQ(camera.at("schema"), "lsv.camera/1");
  const std::map<std::string, double> truth = {{"k_counts_per_e", 0.0255},
                                               {"dark_noise_counts", 0.5},
                                               {"dsnu_counts", 5.0},
                                               {"prnu_ratio", 0.02}};
  for (const auto& [name, value] : truth) {
    const json& figure = camera.at("figures").at(name);
    EXPECT_NEAR(figure.at("value").get<double>(), value, 2.0 * figure.at("sigma").get<double>())
        << name;
  }
  EXPECT_LT(camera.at("figures").at("linearity_error_ratio").at("value").get<double>(), 1e-3);
  EXPECT_EQ(camera.at("defects").at("hot"), 30);
  EXPECT_EQ(camera.at("defects").at("dead"), 30);
  EXPECT_EQ(camera.at("levels").size(), 8U);
  EXPECT_TRUE(camera.at("levels").back().at("saturated"));
  const std::string calibration = read_text(folder + "/out/calibration.toml");
  for (const char* says : {"[emva1288]", "date = '2026-11-24'", "method = 'simulated'",
                           "file = 'sensor_maps.tif'", "width_px = 128", "sc_x_ratio = 1.985"})
    EXPECT_NE(calibration.find(says), std::string::npos) << says << " in\n" << calibration;

  const std::string drive = folder + "/drive.tif";
  ASSERT_EQ(lsv_run(with({"simulate", "speckle", "-o", drive, "--frames", "301", "--profile",
                          "constant", "--speed-px", "0.5", "--seed", "5"},
                         kSensor))
                .exit_code,
            0);
  const std::string new_path = folder + "/out/calibration.toml";
  for (const std::string preset : {"precise", "fast", "classic"}) {
    const Args how = {"--preset", preset};
    const double error =
        distance_error_percent(drive, 150.0, with({"--calibration", new_path}, how));
    const double error_before =
        distance_error_percent(drive, 150.0, with({"--calibration", kBase}, how));
    std::printf("0.5 px per frame, %s: distance error %+.4f %% with the maps, %+.4f %% without\n",
                preset.c_str(), error, error_before);
    if (preset == "precise") {
      EXPECT_LT(std::abs(error), 0.02);
    }
    if (preset == "classic") {
      EXPECT_LT(std::abs(error), 0.01 * std::abs(error_before));
    }
  }

  // A region cuts the maps; a pair is measured with them, too.
  const double cut_error =
      distance_error_percent(drive, 150.0, {"--calibration", new_path, "--roi", "20,30,96,80"});
  EXPECT_LT(std::abs(cut_error), 0.03);
  const Args pair = {"shift", "--pairs", drive, "--stop", "2", "--preset", "fast"};
  const json mapped = json::parse(lsv_run(with(pair, {"--calibration", new_path})).out);
  const json bare = json::parse(lsv_run(with(pair, {"--calibration", kBase})).out);
  std::printf("one pair: dx %.4f px with the maps, %.4f px without\n",
              mapped.at("dx_px").get<double>(), bare.at("dx_px").get<double>());
  EXPECT_NEAR(mapped.at("dx_px").get<double>(), 0.5, 0.01);
  EXPECT_GT(mapped.at("zncc").get<double>(), bare.at("zncc").get<double>());
}

TEST(CalibrateCamera, ThePageShowsEverythingAndNeedsNoNetwork) {
  const std::string folder = test::fresh_directory();
  const ProgramResult made =
      calibrate(flat(folder, 0, 8), {flat(folder, 60, 8), flat(folder, 120, 8)}, folder + "/out");
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_NE(made.out.find("warning: "), std::string::npos) << made.out;
  const std::string page = read_text(folder + "/out/report.html");
  for (const char* says :
       {"PRNU1288", "photon transfer", "data:image/png;base64,", "Dark levels", "Gains of",
        "no sequence reached saturation", "8 frames are few", "at least", "give --exposure-us"})
    EXPECT_NE(page.find(says), std::string::npos) << says;
  EXPECT_EQ(page.find("<script"), std::string::npos);
  std::string outside = page;  // the name of the SVG language is no address that is fetched
  for (std::size_t at = 0; (at = outside.find("http://www.w3.org/2000/svg")) != std::string::npos;)
    outside.erase(at, 26);
  EXPECT_EQ(outside.find("://"), std::string::npos);
  EXPECT_EQ(page.find("nan"), std::string::npos);
}

TEST(CalibrateCamera, RefusesWhatDoesNotFit) {
  const std::string folder = test::fresh_directory();
  const std::string out = folder + "/out";
  const std::string dark = flat(folder, 0, 4);
  const std::string light = flat(folder, 100, 4);
  const std::string single = flat(folder, 101, 1);
  std::filesystem::create_directory(folder + "/other");
  const std::string narrow = flat(folder + "/other", 60, 4, with(kSensor, {"--size", "64x64"}));
  const std::string deep = flat(folder + "/other", 61, 4, with(kSensor, {"--bit-depth", "12"}));
  expect_refusal(calibrate(dark, {light, narrow}, out), 3, "other/light60.tif: is 64 x 64 px");
  expect_refusal(calibrate(dark, {light, deep}, out), 3, "with 12 bit, but the dark");
  expect_refusal(calibrate(dark, {light, single}, out), 3, "light101.tif: holds one frame only");
  expect_refusal(calibrate(dark, {light}, out), 3, "two or more");
  expect_refusal(calibrate(light, {light, dark}, out), 3, "--dark and --flat exchanged?");
  expect_refusal(calibrate(dark, {light, folder + "/none.tif"}, out), 3, "none.tif");
  expect_refusal(calibrate(dark, {light, single}, out, {"--roi", "0,0,64,64"}), 2, "--roi");
  expect_refusal(calibrate(dark, {light, single}, out, {"--exposure-us", "3"}), 2,
                 "--exposure-us must be given as often as --flat");
  expect_refusal(calibrate(dark, {light, light}, out, {"--calibration", folder + "/no.toml"}), 3,
                 "no.toml");
  EXPECT_FALSE(std::filesystem::exists(out));
}

/// A calibration made in two seconds, for what comes after.
class CalibratedCamera : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = test::fresh_directory();
    const ProgramResult made =
        calibrate(flat(folder_, 0, 6), {flat(folder_, 60, 6), flat(folder_, 140, 6)}, out());
    ASSERT_EQ(made.exit_code, 0) << made.err;
    drive_ = speckle("drive", {});
  }
  std::string out() const { return folder_ + "/out"; }
  std::string calibration() const { return out() + "/calibration.toml"; }
  std::string maps() const { return out() + "/sensor_maps.tif"; }

  std::string speckle(const std::string& name, const Args& more) const {
    const std::string path = folder_ + "/" + name + ".tif";
    const ProgramResult made = lsv_run(with({"simulate", "speckle", "-o", path, "--truth",
                                             folder_ + "/" + name + ".csv", "--frames", "3"},
                                            with(kSensor, more)));
    EXPECT_EQ(made.exit_code, 0) << made.err;
    return path;
  }
  ProgramResult track(const std::string& frames, const Args& more = {}) const {
    return lsv_run(with(
        {"track", frames, "--rate-hz", "1000", "--calibration", calibration(), "--csv", "-", "-q"},
        more));
  }

  std::string folder_;
  std::string drive_;
};

TEST_F(CalibratedCamera, OtherFramesAreRefused) {
  EXPECT_EQ(track(drive_).exit_code, 0);
  expect_refusal(track(speckle("binned", {"--size", "64x64"})), 3,
                 "calibration.toml: is for frames of 128 x 128 px with 8 bit ([format]), but these "
                 "are 64 x 64 px with 8 bit, which looks binned by 2");
  expect_refusal(track(speckle("large", {"--size", "160x128"})), 3, "these are 160 x 128 px");
  expect_refusal(track(speckle("deep", {"--bit-depth", "12"})), 3, "with 12 bit");
  // A region of the right frames is right, of wrong ones it stays wrong.
  EXPECT_EQ(track(drive_, {"--roi", "0,0,64,64"}).exit_code, 0);
  expect_refusal(track(speckle("wide", {"--size", "160x160"}), {"--roi", "0,0,128,128"}), 3,
                 "these are 160 x 160 px");
  expect_refusal(lsv_run({"shift", "--pairs", folder_ + "/binned.tif", "--stop", "2",
                          "--calibration", calibration()}),
                 3, "looks binned by 2");
}

TEST_F(CalibratedCamera, MapsThatAreMissingOrChangedAreRefused) {
  const std::string good = read_text(maps());
  const auto put = [this](const std::string& bytes) {
    std::ofstream(maps(), std::ios::binary) << bytes;
  };
  std::string changed = good;
  changed[good.size() / 3] ^= 4;
  put(changed);
  expect_refusal(track(drive_), 3, "sensor_maps.tif: is not the file that");
  put(good.substr(0, good.size() / 2));
  expect_refusal(track(drive_), 3, "sensor_maps.tif: ");
  std::filesystem::remove(maps());
  expect_refusal(track(drive_), 3, "sensor_maps.tif: there is no such sensor maps file");
  put(good);
  EXPECT_EQ(track(drive_).exit_code, 0);
}

// The scale is measured with the maps, and the calibration that comes of it still finds them.
TEST_F(CalibratedCamera, AMeasuredScaleKeepsTheMaps) {
  std::ofstream runs(folder_ + "/runs.csv");
  runs << "track,travel_x_m,travel_y_m,sigma_m\n";
  const std::pair<double, double> ways_px[] = {{1000, 0}, {-1000, 0}, {0, 1000}, {0, -1000}};
  for (const auto& [x_px, y_px] : ways_px) {
    const std::string name = "run" + std::to_string(static_cast<int>(x_px + 2.0 * y_px)) + ".csv";
    std::ofstream(folder_ + "/" + name)
        << "time_s,dt_s,dx_px,dy_px,sigma_dx_px,sigma_dy_px,status\n0.1,0.1," << x_px << "," << y_px
        << ",0.01,0.01,ok\n";
    runs << name << "," << 7e-6 * x_px << "," << 7e-6 * y_px << ",1e-7\n";
  }
  runs.close();
  const ProgramResult scaled =
      lsv_run({"calibrate", "scale", folder_ + "/runs.csv", "--calibration", calibration(),
               "--height-m", "0.1", "--date", "2026-11-24", "-o", folder_ + "/deep/scaled"});
  ASSERT_EQ(scaled.exit_code, 0) << scaled.err;
  const std::string path = folder_ + "/deep/scaled/calibration.toml";
  EXPECT_NE(read_text(path).find("../../out/sensor_maps.tif"), std::string::npos)
      << read_text(path);
  EXPECT_EQ(
      lsv_run({"track", drive_, "--rate-hz", "1000", "--calibration", path, "--csv", "-", "-q"})
          .exit_code,
      0);
}

TEST_F(CalibratedCamera, NothingThatIsReadIsOverwritten) {
  const std::string before = read_text(calibration());
  expect_refusal(
      calibrate(folder_ + "/light0.tif", {folder_ + "/light60.tif", folder_ + "/light140.tif"},
                out(), {"--calibration", calibration()}),
      2, "is an input of this run");
  EXPECT_EQ(read_text(calibration()), before);
  expect_refusal(track(drive_, {"--jsonl", maps()}), 2, "is an input of this run");
  // The same frames give the same bytes, wherever they are written.
  ASSERT_EQ(calibrate(folder_ + "/light0.tif",
                      {folder_ + "/light60.tif", folder_ + "/light140.tif"}, folder_ + "/again")
                .exit_code,
            0);
  for (const char* name : {"/calibration.toml", "/sensor_maps.tif", "/camera.json", "/report.html"})
    EXPECT_EQ(read_text(folder_ + "/again" + name), read_text(out() + name)) << name;
}

TEST(SimulateFlat, TheSensorIsThatOfTheSpeckle) {
  const std::string folder = test::fresh_directory();
  const std::string path = flat(folder, 0, 2);
  const json info = json::parse(lsv_run({"info", path, "--json"}).out);
  EXPECT_EQ(info.at("frames"), 2);
  EXPECT_NEAR(info.at("first_frame").at("mean_counts").get<double>(), 15.4, 0.2);
  expect_refusal(lsv_run({"simulate", "flat", "-o", folder + "/x", "--mean-counts", "-1"}), 2,
                 "mean_signal_counts");
  expect_refusal(lsv_run({"simulate", "flat", "-o", folder + "/x", "--mean-counts", "9",
                          "--gradient-percent", "300"}),
                 2, "gradient");
  expect_refusal(lsv_run({"simulate", "flat", "-o", path, "--mean-counts", "9"}), 2,
                 "exists already");
  expect_refusal(lsv_run({"simulate", "flat", "-o", folder + "/x"}), 2, "--mean-counts");
}

TEST(CalibrateCamera, HelpShowsHowToTryItWithoutACamera) {
  const ProgramResult help = lsv_run({"calibrate", "camera", "--help"});
  EXPECT_EQ(help.exit_code, 0);
  for (const char* says : {"lsv simulate flat -o", "lsv calibrate camera --dark",
                           "lsv simulate speckle -o", "lsv track", "--exposure-us"})
    EXPECT_NE(help.out.find(says), std::string::npos) << says;
}

}  // namespace
}  // namespace lsv
