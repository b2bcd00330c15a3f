// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/output/jsonl_sink.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/lsv/output/track_samples.h"

namespace lsv {
namespace {

using namespace testing_samples;
using nlohmann::json;

std::vector<json> rows_of(const std::vector<StepReport>& reports) {
  const ScratchDirectory scratch;
  JsonlSink sink(opened(scratch.file("t.jsonl")));
  feed(sink, reports);
  std::vector<json> out;
  for (const std::string& line : split(text_of(scratch.file("t.jsonl")), '\n'))
    out.push_back(json::parse(line));
  return out;
}

TEST(JsonlSink, OneObjectPerFrame) {
  const auto rows = rows_of(sample_reports());
  ASSERT_EQ(rows.size(), 5U);
  EXPECT_EQ(rows[0]["status"], "first_frame");
  EXPECT_EQ(rows[3]["frame"], 5);
  for (const json& row : rows) EXPECT_EQ(row.size(), rows[0].size());
}

TEST(JsonlSink, AnAcceptedFrame) {
  const json row = rows_of(sample_reports())[1];
  EXPECT_EQ(row, json::parse(R"({"frame":1,"time_ns":10000000,"time_s":0.01,"dt_s":0.01,
      "status":"ok","held":false,"zncc":0.875,"q":9.5,"peak_ratio":3.0,"peak_to_rms":12.0,"zncc_sigmas":null,
      "outlier_probability":null,
      "dx_px":1.5,"dy_px":-2.25,"cov_px2":[0.0025,0.0001,0.0036],"vx_m_s":0.1,"vy_m_s":-0.2,
      "sigma_vx_m_s":0.001,"sigma_vy_m_s":0.002,"x_m":0.001,"y_m":-0.002,
      "sigma_x_m":1e-5,"sigma_y_m":2e-5,"search":"predicted","keyframe":0,"segment":2,
      "motion":"moving","rotation_rad":null,"sigma_rotation_rad":null,"expansion_ratio":null,
      "sigma_expansion_ratio":null,"static_share":null})"));
}

TEST(JsonlSink, ARefusedFrameKeepsItsQualityAndHoldsItsPosition) {
  const json row = rows_of(sample_reports())[2];
  EXPECT_EQ(row["status"], "below_q_gate");
  EXPECT_EQ(row["held"], true);
  EXPECT_EQ(row["q"], 4.5);
  EXPECT_EQ(row["zncc"], 0.125);
  EXPECT_EQ(row["x_m"], 0.001);
  for (const char* key : {"dx_px", "dy_px", "vx_m_s", "vy_m_s", "sigma_vx_m_s", "sigma_vy_m_s"})
    EXPECT_TRUE(row[key].is_null()) << key;
  EXPECT_EQ(row["cov_px2"], json::parse("[null,null,null]"));
}

TEST(JsonlSink, UnmeasuredQualityIsNull) {
  const json row = rows_of(sample_reports())[4];
  EXPECT_EQ(row["status"], "dark");
  EXPECT_TRUE(row["q"].is_null());
}

TEST(JsonlSink, TimeInNanosecondsIsExact) {
  EXPECT_EQ(rows_of({first_report(1'700'000'000'123'456'789)})[0]["time_ns"],
            1'700'000'000'123'456'789);
}

}  // namespace
}  // namespace lsv
