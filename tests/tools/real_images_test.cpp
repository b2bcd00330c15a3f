// SPDX-License-Identifier: BSD-3-Clause
// Real camera images with references, through the program. The images are not part of the
// repository: they are looked for beside it, and the tests say so when they are not there.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <utility>

#include "tests/support/csv_table.h"
#include "tests/support/run_program.h"

namespace lsv {
namespace {

const std::string kData = LSV_SOURCE_DIR "/../shared/data";

class RealImages : public testing::Test {
 protected:
  void SetUp() override {
    // Without the images there is nothing to compare with; a skip is printed, not a pass.
    if (!std::filesystem::is_directory(kData))
      GTEST_SKIP() << "no real images at ../shared/data: not tested";
  }
};

test::ProgramResult track(std::vector<std::string> args) {
  args.insert(args.begin(), {LSV_PROGRAM, "track"});
  const std::string calibration = LSV_SOURCE_DIR "/sample_frames/calibration.toml";
  args.insert(args.end(), {"--rate-hz", "1000", "--calibration", calibration, "--csv", "-", "-q"});
  return test::run_program(args);
}

TEST_F(RealImages, StageTranslationInEveryQuadrant) {
  const std::string folder = kData + "/stage_translation/";
  const test::CsvTable reference(test::read_text(folder + "reference.csv"));
  ASSERT_EQ(reference.rows(), 8U);
  for (std::size_t i = 0; i < reference.rows(); ++i) {
    const auto whole = [&](const char* column) { return std::stoi(reference.text(i, column)); };
    const std::string roi = std::to_string(whole("col0")) + "," + std::to_string(whole("row0")) +
                            "," + std::to_string(whole("col1") - whole("col0")) + "," +
                            std::to_string(whole("row1") - whole("row0"));
    const std::string pair = folder + "stage_" + reference.text(i, "pair");
    const auto result = track({pair + "_ref.pgm", pair + "_tar.pgm", "--roi", roi});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const test::CsvTable row(result.out);
    ASSERT_EQ(row.text(0, "status"), "ok");
    const double ex = row.number(0, "dx_px") - reference.number(i, "dx_px");
    const double ey = row.number(0, "dy_px") - reference.number(i, "dy_px");
    EXPECT_NEAR(ex, 0.0, 0.02) << roi;
    EXPECT_NEAR(ey, 0.0, 0.02) << roi;
    std::printf("%s %s: error %+.4f %+.4f px\n", reference.text(i, "pair").c_str(),
                reference.text(i, "quadrant").c_str(), ex, ey);
  }
}

TEST_F(RealImages, WholePixelShifts) {
  const std::string folder = kData + "/integer_shift/";
  for (const auto& [name, truth_px] :
       {std::pair{"def_01", 1}, {"def_05", 5}, {"def_10", 10}, {"def_15", 15}}) {
    const auto result = track({folder + "ref.pgm", folder + name + ".pgm"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const test::CsvTable row(result.out);
    EXPECT_NEAR(row.number(0, "dx_px"), truth_px, 0.005) << name;
    EXPECT_NEAR(row.number(0, "dy_px"), truth_px, 0.005) << name;
    std::printf("%s: %.4f %.4f px\n", name, row.number(0, "dx_px"), row.number(0, "dy_px"));
  }
}

TEST_F(RealImages, AShiftBeyondTheRangeIsFlaggedAndFoundWhenAllowed) {
  const std::string folder = kData + "/integer_shift/";
  const std::vector<std::string> pair = {folder + "big_ref.pgm", folder + "big_160_140.pgm"};
  const auto narrow = track(pair);
  EXPECT_EQ(narrow.exit_code, 4);
  EXPECT_NE(test::CsvTable(narrow.out).text(0, "status"), "ok");
  // More than half of the second image is blank white.
  const auto blank = track({pair[0], pair[1], "--max-shift", "200"});
  EXPECT_EQ(test::CsvTable(blank.out).text(0, "status"), "saturated");
  const auto wide = track({pair[0], pair[1], "--max-shift", "200", "--max-saturated", "0.9"});
  ASSERT_EQ(wide.exit_code, 0) << wide.err;
  const test::CsvTable row(wide.out);
  EXPECT_NEAR(row.number(0, "dx_px"), 160.0, 0.005);
  EXPECT_NEAR(row.number(0, "dy_px"), 140.0, 0.005);
  std::printf("big: %.4f %.4f px\n", row.number(0, "dx_px"), row.number(0, "dy_px"));
}

TEST_F(RealImages, ACameraAtRestDoesNotMove) {
  const auto result = track({kData + "/static_camera"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const test::CsvTable table(result.out);
  ASSERT_EQ(table.rows(), 5U);
  // An independent Gauss-Newton of the frames against frame 0, see the SOURCE.txt of the images.
  const std::pair<double, double> reference[] = {
      {0.0044, 0.0067}, {0.0099, 0.0088}, {0.0155, 0.0087}, {0.0187, 0.0104}, {0.0166, 0.0153}};
  double x_px = 0.0, y_px = 0.0;
  for (std::size_t i = 0; i < 5; ++i) {
    x_px += table.number(i, "dx_px");
    y_px += table.number(i, "dy_px");
    EXPECT_LT(std::hypot(x_px, y_px), 0.03);
    EXPECT_NEAR(x_px, reference[i].first, 0.01);
    EXPECT_NEAR(y_px, reference[i].second, 0.01);
    std::printf("rest, frame %zu: %+.4f %+.4f px, reference %+.4f %+.4f\n", i + 1, x_px, y_px,
                reference[i].first, reference[i].second);
  }
}

}  // namespace
}  // namespace lsv
