// SPDX-License-Identifier: BSD-3-Clause
// Values of a scenario that contradict themselves are mistakes: a drive made of them would not be
// the one that was meant.
#include "tools/rover_scenario.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "tools/rover_file.h"

namespace lsv::cli {
namespace {

const std::string kGood =
    "schema = \"lsv.scenario/1\"\n[drive]\nstep_s = 0.1\nsteps = 10\n[wheels]\nradius_m = 0.1\n"
    "track_m = 0.8\n[[command]]\nduration_s = 1\nleft_rad_s = 1\nright_rad_s = 1\n";
const std::string kSensor = "[[lsv]]\nx_m = 1\ny_m = 0\nnoise_m_s = 1e-3\n";

std::string refusal(const std::string& text) {
  const Result<RoverScenario> scenario = parse_scenario(text, "s.toml");
  return scenario ? "" : scenario.error().message;
}

TEST(RoverScenario, WhatContradictsItselfIsRefused) {
  EXPECT_EQ(refusal(kGood), "");
  EXPECT_EQ(refusal(kGood + kSensor + "lost_from_s = 1\nlost_to_s = 2\n"), "");
  EXPECT_EQ(refusal(kGood + kSensor + "outlier_share = 0.1\noutlier_m_s = 0.3\n"), "");
  const std::pair<std::string, std::string> wrong[] = {
      {kSensor + "lost_from_s = 1\n", "s.toml:16: lsv.lost_from_s and the other end"},
      {kSensor + "lost_to_s = 1\n", "s.toml:16: lsv.lost_to_s and the other end"},
      {kSensor + "lost_from_s = 2\nlost_to_s = 1\n", "lost_from_s below lost_to_s"},
      {kSensor + "outlier_share = 0.1\n", "lsv.outlier_share does nothing alone"},
      {kSensor + "outlier_m_s = 0.1\n", "lsv.outlier_m_s does nothing alone"},
      {kSensor + "name = \"a, b\"\n", "lsv.name must be 1 to 64 characters without comma"},
      {kSensor + "name = \"a\\nb\"\n", "lsv.name must be"},
      {kSensor + "name = \"it's\"\n", "lsv.name must be"},
      {kSensor + "name = \"\"\n", "lsv.name must be"},
      {"[[patch]]\nsoil = \"A\"\nleft_m = 2\nright_m = 1\n", "patch.left_m must be below right_m"},
      {"[[patch]]\nsoil = \"A\"\nbottom_m = 2\ntop_m = 2\n", "patch.bottom_m must be below top_m"},
      {"[[patch]]\nsoil = \"A\"\nefficiency_ratio = 0.7\n", "patch.soil says the efficiency"},
      {"[[side_slip]]\nbegin_s = 2\nend_s = 1\nvy_m_s = 1\n", "side_slip.begin_s must be below"},
      {"[[command]]\nduration_s = 1\nleft_rad_s = 1e300\nright_rad_s = 1\n",
       "command.left_rad_s must be between"},
      {"[imu]\ngyro_noise_rad_s = 1\ngyro_bias_sigma_rad_s = -1\n", "imu.gyro_bias_sigma_rad_s"}};
  for (const auto& [text, sentence] : wrong)
    EXPECT_NE(refusal(kGood + text).find(sentence), std::string::npos)
        << text << refusal(kGood + text);
}

// What is simulated can be fused.
TEST(RoverScenario, NotMoreSensorsThanAreFused) {
  std::string text = kGood;
  for (std::size_t i = 0; i < kMaxLsvSensors; ++i) text += kSensor;
  EXPECT_EQ(refusal(text), "");
  EXPECT_NE(refusal(text + kSensor).find("one sensor too many: lsv fuse takes 8"),
            std::string::npos)
      << refusal(text + kSensor);
}

}  // namespace
}  // namespace lsv::cli
