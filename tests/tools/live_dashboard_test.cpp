// SPDX-License-Identifier: BSD-3-Clause
#include "tools/live_dashboard.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tools/health_json.h"

namespace lsv::cli {
namespace {

HealthSnapshot busy() {
  HealthSnapshot h;
  h.state = StreamState::running;
  h.received = 1000;
  h.processed = 990;
  h.rejected = {1, 2, 3, 0, 0};
  h.dropped = 4;
  h.missing = 7;
  h.shifts_ok = 900;
  h.shifts_refused = 89;
  h.deadline_misses = 5;
  h.restarts = 2;
  h.transport_losses = 33;
  h.frame_rate_hz = 249.96;
  h.latency = {.count = 990, .p50_s = 1e-4, .p99_s = 2e-3, .p999_s = 0.0125, .max_s = 0.5};
  return h;
}

StepReport moving() {
  StepReport report;
  report.shift.status = ShiftStatus::ok;
  report.shift.quality.zncc = 0.987654;
  report.shift.quality.q = 41.96;
  report.velocity.vx_m_s = 0.03;
  report.velocity.vy_m_s = -0.04;
  report.position = {.x_m = 1.5, .y_m = -0.25, .sigma_x_m = 1.2e-6, .sigma_y_m = 3.4e-6};
  return report;
}

TEST(LiveDashboard, ShowsWhatARunNeeds) {
  const std::vector<std::string> expected = {
      "running   250.0 Hz, 1000 frames",
      "latency   p50 0.10, p99 2.00, p99.9 12.50, max 500.00 ms; 5 later than a period",
      "quality   Q 42.0, ZNCC 0.988; 900 shifts accepted, 89 refused; now: ok",
      "speed     0.0500 m/s (+0.0300, -0.0400)",
      "position  (1.5000, -0.2500) m, sigma (1.2e-06, 3.4e-06)",
      "losses    7 missing, 6 rejected, 4 dropped; transport 33; opened anew 2 times"};
  EXPECT_EQ(dashboard_block(busy(), moving()), expected);
  EXPECT_EQ(dashboard_line(busy(), moving()),
            "running, 250.0 Hz, 1000 frames, latency p99 2.00 ms, Q 42.0, 0.0500 m/s, at (1.5000, "
            "-0.2500) m, 7 missing, 6 rejected, 4 dropped");
}

TEST(LiveDashboard, WhatIsUnknownIsADash) {
  StepReport refused;
  refused.shift.status = ShiftStatus::dark;
  const std::vector<std::string> block = dashboard_block({}, refused);
  EXPECT_EQ(block[0], "starting  - Hz, 0 frames");
  EXPECT_EQ(block[2], "quality   Q -, ZNCC -; 0 shifts accepted, 0 refused; now: dark");
  EXPECT_EQ(block[3], "speed     - m/s (-, -)");
}

TEST(HealthJson, HoldsEveryCounterAndNullForTheUnknown) {
  const nlohmann::json json = nlohmann::json::parse(health_json(busy()));
  EXPECT_EQ(json.at("schema"), "lsv.health/1");
  EXPECT_EQ(json.at("state"), "running");
  EXPECT_EQ(json.at("received"), 1000);
  EXPECT_EQ(
      json.at("rejected"),
      (nlohmann::json{
          {"damaged", 1}, {"wrong_format", 2}, {"duplicate", 3}, {"late", 0}, {"refused", 0}}));
  EXPECT_EQ(json.at("latency_p999_s"), 0.0125);
  EXPECT_TRUE(json.at("queue_age_max_s").is_null());
}

}  // namespace
}  // namespace lsv::cli
