// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/output/report.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/lsv/output/track_samples.h"

namespace lsv {
namespace {

using namespace testing_samples;
using nlohmann::json;

PlaneSnapshot sample_plane(int max_dx_px = 5, int max_dy_px = 4) {
  PlaneSnapshot plane;
  plane.frame = 1;
  plane.max_dx_px = max_dx_px;
  plane.max_dy_px = max_dy_px;
  plane.dx_px = 2.0;
  plane.dy_px = -3.0;
  plane.status = "ok";
  plane.engine = "zncc";
  for (int dy = -max_dy_px; dy <= max_dy_px; ++dy)
    for (int dx = -max_dx_px; dx <= max_dx_px; ++dx)
      plane.zncc.push_back(dx == 2 && dy == -3 ? 0.9375F : 0.0625F);
  return plane;
}

std::string page_of(const std::vector<StepReport>& reports, const RunInfo& info = sample_run(),
                    std::optional<PlaneSnapshot> plane = {},
                    std::optional<FramePreview> preview = {}, bool interrupted = false) {
  const ScratchDirectory scratch;
  ReportBuilder report(opened(scratch.file("r.html")), info);
  if (plane) {
    EXPECT_TRUE(report.set_plane(*plane).ok());
  }
  if (preview) report.set_preview(*preview);
  feed(report, reports, interrupted);
  return text_of(scratch.file("r.html"));
}

std::size_t count_of(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1))
    ++count;
  return count;
}

std::string data_text(const std::string& page) {
  const std::string open = "<script type=\"application/json\" id=\"run-data\">";
  const std::size_t start = page.find(open) + open.size();
  return page.substr(start, page.find("</script>", start) - start);
}

json data_of(const std::string& page) { return json::parse(data_text(page)); }

TEST(Report, HoldsEverythingItNeeds) {
  const std::string page = page_of(sample_reports());
  EXPECT_TRUE(page.starts_with("<!DOCTYPE html>"));
  EXPECT_TRUE(page.ends_with("</html>\n"));
  EXPECT_EQ(page.find("{{"), std::string::npos);
  EXPECT_NE(page.find("d3={version:"), std::string::npos);
  EXPECT_NE(page.find("Michael Bostock"), std::string::npos);
  EXPECT_NE(page.find("Redistribution and use in source and binary forms"), std::string::npos);
  EXPECT_NE(page.find("function drawTrajectory"), std::string::npos);
}

TEST(Report, AsksTheNetworkForNothing) {
  const std::string page = page_of(sample_reports());
  EXPECT_NE(page.find("default-src 'none'"), std::string::npos);
  for (const char* part : {" src=", "@import", "url(http", "<link", "//cdn"})
    EXPECT_EQ(page.find(part), std::string::npos) << part;
}

TEST(Report, SeriesAreTheReports) {
  const json series = data_of(page_of(sample_reports()))["series"];
  EXPECT_EQ(series["frames_per_point"], 1);
  EXPECT_EQ(series["frame"], json::parse("[0,1,2,5,6]"));
  EXPECT_EQ(series["t_s"], json::parse("[0.0,0.01,0.02,0.03,0.04]"));
  EXPECT_EQ(series["y_m"], json::parse("[0.0,-0.002,-0.002,-0.004,-0.004]"));
  EXPECT_EQ(series["vx_m_s"], json::parse("[null,0.1,null,0.1,null]"));
  EXPECT_EQ(series["refused_q"], json::parse("[null,null,4.5,null,null]"));
  EXPECT_EQ(series["refused"], json::parse(R"([[2,{"below_q_gate":1}],[4,{"dark":1}]])"));
}

TEST(Report, SummaryAndReasonsWithAdvice) {
  const json data = data_of(page_of(sample_reports(1'700'000'000'123'456'789)));
  EXPECT_EQ(data["summary"]["shifts_ok"], 2);
  EXPECT_EQ(data["summary"]["settings"]["sensor_name"], "LSV-01");
  EXPECT_EQ(data["start_s"], "1700000000.123456789");
  ASSERT_EQ(data["reasons"].size(), 2U);
  EXPECT_EQ(data["reasons"][0]["status"], "dark");
  EXPECT_EQ(data["reasons"][0]["share"], 0.25);
  EXPECT_EQ(data["reasons"][0]["advice"], std::string(advice(ShiftStatus::dark)));
}

TEST(Report, TextFromOutsideCannotLeaveItsScript) {
  const std::string attack = "</script><script>alert(1)</script><!--<script>&amp;{{d3}}\xff";
  RunInfo info = sample_run();
  info.source_description = attack;
  info.time_base = attack;
  info.config.calibration.sensor_name = attack;
  PlaneSnapshot plane = sample_plane();
  plane.status = plane.engine = attack;
  const std::string page = page_of(sample_reports(), info, plane);
  const std::string plain = page_of(sample_reports());
  EXPECT_EQ(count_of(page, "</script"), count_of(plain, "</script"));
  EXPECT_EQ(count_of(page, "<script"), count_of(plain, "<script"));
  EXPECT_EQ(page.find("alert(1)<"), std::string::npos);
  EXPECT_EQ(data_text(page).find('<'), std::string::npos);
  const std::string kept = data_of(page)["summary"]["settings"]["source"];
  EXPECT_EQ(kept, attack.substr(0, attack.size() - 1) + "\xef\xbf\xbd");
}

TEST(Report, TheSameRunGivesTheSameBytes) {
  FramePreview preview{.frame = 1, .width_px = 2, .height_px = 1, .grey = {0, 255}};
  const std::string first = page_of(sample_reports(), sample_run(), sample_plane(), preview);
  const std::string second = page_of(sample_reports(), sample_run(), sample_plane(), preview);
  EXPECT_EQ(first, second);
}

TEST(Report, AnInterruptedRunIsMarked) {
  EXPECT_EQ(
      data_of(page_of(sample_reports(), sample_run(), {}, {}, true))["summary"]["interrupted"],
      true);
}

TEST(Report, PlaneKeepsItsAxes) {
  const json plane = data_of(page_of(sample_reports(), sample_run(), sample_plane()))["plane"];
  const json& map = plane["map"];
  EXPECT_EQ(map["columns"], 11);
  EXPECT_EQ(map["rows"], 9);
  EXPECT_EQ(map["first_dx_px"], -5);
  EXPECT_EQ(map["first_dy_px"], -4);
  EXPECT_EQ(map["values"][(-3 + 4) * 11 + (2 + 5)], 0.9375);
  // The neighbourhood is cut at the border of the plane.
  const json& near = plane["near"];
  EXPECT_EQ(near["first_dx_px"], -1);
  EXPECT_EQ(near["first_dy_px"], -4);
  EXPECT_EQ(near["columns"], 7);
  EXPECT_EQ(near["rows"], 5);
  EXPECT_EQ(near["values"][1 * 7 + 3], 0.9375);
}

TEST(Report, ALargePlaneIsReducedAndKeepsItsPeak) {
  const json plane =
      data_of(page_of(sample_reports(), sample_run(), sample_plane(300, 7)))["plane"];
  const json& map = plane["map"];
  EXPECT_EQ(map["reduction"], 3);
  EXPECT_EQ(map["columns"], 201);
  EXPECT_EQ(map["rows"], 5);
  EXPECT_EQ(map["values"][(-3 + 7) / 3 * 201 + (2 + 300) / 3], 0.9375);
  EXPECT_EQ(plane["near"]["values"][3 * 7 + 3], 0.9375);
}

TEST(Report, AnUnknownPlaneIsNotAPeak) {
  PlaneSnapshot plane = sample_plane();
  plane.zncc.assign(plane.zncc.size(), static_cast<float>(kUnknown));
  plane.zncc[12] = -0.5F;
  plane.dx_px = plane.dy_px = kUnknown;
  const json out = data_of(page_of(sample_reports(), sample_run(), plane))["plane"];
  EXPECT_TRUE(out["dx_px"].is_null());
  EXPECT_TRUE(out["map"]["values"][0].is_null());
  EXPECT_EQ(out["near"]["first_dx_px"], -5);
}

TEST(Report, APlaneOfTheWrongSizeIsRefused) {
  const ScratchDirectory scratch;
  ReportBuilder report(opened(scratch.file("r.html")), sample_run());
  PlaneSnapshot plane = sample_plane();
  plane.zncc.pop_back();
  EXPECT_FALSE(report.set_plane(plane).ok());
  plane.max_dx_px = -1;
  EXPECT_FALSE(report.set_plane(plane).ok());
}

TEST(Report, PreviewOfASmallFrameIsTheFrame) {
  Frame frame({3, 2, PixelType::mono16, 12});
  frame.index = 8;
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 3; ++x) frame.row16(y)[x] = static_cast<std::uint16_t>(819 * (3 * y + x));
  const FramePreview preview = preview_of(frame.view());
  EXPECT_EQ(preview.frame, 8);
  EXPECT_EQ(preview.reduction, 1);
  EXPECT_EQ(preview.grey, (std::vector<std::uint8_t>{0, 51, 102, 153, 204, 255}));
  const json image = data_of(page_of(sample_reports(), sample_run(), {}, preview))["image"];
  EXPECT_EQ(image["grey"], "ADNmmcz/");
}

TEST(Report, Base64IsPadded) {
  const auto grey = [](std::vector<std::uint8_t> bytes) {
    FramePreview preview{.width_px = static_cast<int>(bytes.size()), .height_px = 1};
    preview.grey = std::move(bytes);
    return data_of(page_of({}, sample_run(), {}, preview))["image"]["grey"];
  };
  EXPECT_EQ(grey({'M'}), "TQ==");
  EXPECT_EQ(grey({'M', 'a'}), "TWE=");
  EXPECT_EQ(grey({'M', 'a', 'n'}), "TWFu");
}

TEST(Report, PreviewOfALargeFrameIsItsMeans) {
  Frame frame({1030, 4, PixelType::mono8, 8});
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 1030; ++x) frame.row8(y)[x] = static_cast<std::uint8_t>(x < 3 ? 90 : 30);
  const FramePreview preview = preview_of(frame.view());
  EXPECT_EQ(preview.reduction, 3);
  EXPECT_EQ(preview.width_px, 343);
  EXPECT_EQ(preview.height_px, 1);
  EXPECT_EQ(preview.grey[0], 90);
  EXPECT_EQ(preview.grey[1], 30);
  EXPECT_EQ(preview.grey.size(), 343U);
}

TEST(Report, AMillionFramesStaySmall) {
  const ScratchDirectory scratch;
  ReportBuilder report(opened(scratch.file("r.html")), sample_run());
  StepReport last = first_report();
  ASSERT_TRUE(report.write(last).ok());
  for (int i = 1; i < 1'000'000; ++i) {
    StepReport next = accepted_after(last);
    // No two values are alike, so that no number is short.
    next.velocity.vx_m_s = 0.1 * std::sin(0.7 * i);
    next.shift.quality.q = 9.0 + std::sin(0.3 * i);
    if (i % 5 == 0) next = refused_after(last, ShiftStatus::below_zncc_gate);
    ASSERT_TRUE(report.write(next).ok());
    last = next;
  }
  ASSERT_TRUE(report.finish({}).ok());
  ASSERT_TRUE(report.commit().ok());
  EXPECT_LT(std::filesystem::file_size(scratch.file("r.html")), 2'000'000U);
  const json data = data_of(text_of(scratch.file("r.html")));
  EXPECT_EQ(data["series"]["frames_per_point"], 256);
  EXPECT_EQ(data["reasons"][0]["count"], 199'999);
}

}  // namespace
}  // namespace lsv
