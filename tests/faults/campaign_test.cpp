// SPDX-License-Identifier: BSD-3-Clause
// The fault campaign in small: every fault whose limits hold does so here, and every detector,
// taken out on purpose, is missed. `lsv faults` runs it in full (docs/reliability.md).
#include "tools/faults/campaign.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <string>
#include <vector>

namespace lsv::faults {
namespace {

CampaignOptions small(Broken broken = Broken::nothing) {
  return {.side_px = 128, .exposures = 1000, .seeds = 1, .broken = broken};
}

Row run(const std::string& id, const CampaignOptions& options) {
  static Scenes scenes(small().side_px, small().exposures);
  const std::vector<Scenario> all = chosen_scenarios({});
  const auto scenario =
      std::find_if(all.begin(), all.end(), [&](const Scenario& one) { return one.id == id; });
  if (scenario == all.end()) {
    ADD_FAILURE() << "there is no " << id;
    return {};
  }
  const auto row = run_scenario(*scenario, scenes, options);
  if (!row) ADD_FAILURE() << row.error().message;
  return row.value();
}

std::string lines(const std::vector<std::string>& all) {
  std::string out;
  for (const std::string& one : all) out += one + "\n";
  return out;
}

/// Those on the footage that every test shares and that fit into it, without the ones that lsv is
/// known to miss (docs/reliability.md).
std::vector<std::string> held_ids() {
  const std::vector<std::string> left_out = {"A2 1000", "A6 dim"};
  std::vector<std::string> out;
  for (const Scenario& scenario : chosen_scenarios({})) {
    const bool is_held = std::find(left_out.begin(), left_out.end(), scenario.id) == left_out.end();
    if (is_held && scenario.scene == Scene::drive) out.push_back(scenario.id);
  }
  return out;
}

class Fault : public testing::TestWithParam<std::string> {};

TEST_P(Fault, IsToldAndDoesNoHarm) {
  const Row row = run(GetParam(), small());
  EXPECT_TRUE(row.broken_limits.empty()) << lines(row.broken_limits);
  EXPECT_GT(row.all.accepted, 0);
}

INSTANTIATE_TEST_SUITE_P(Campaign, Fault, testing::ValuesIn(held_ids()), [](const auto& test) {
  std::string out = test.param;
  std::replace_if(
      out.begin(), out.end(), [](char c) { return std::isalnum(c) == 0; }, '_');
  return out;
});

struct Sabotage {
  Broken broken;
  const char* fault;
  const char* name;
};

class Detector : public testing::TestWithParam<Sabotage> {};

// A campaign that stays green without the detector would prove nothing.
TEST_P(Detector, IsMissedWhenTakenOut) {
  const Row row = run(GetParam().fault, small(GetParam().broken));
  EXPECT_FALSE(row.broken_limits.empty());
}

INSTANTIATE_TEST_SUITE_P(
    Campaign, Detector,
    testing::Values(Sabotage{Broken::loss_by_stamps, "A1 10 %", "loss_by_stamps"},
                    Sabotage{Broken::duplicate_ids, "A3 same id", "duplicate_ids"},
                    Sabotage{Broken::order, "A4 1-5", "order"},
                    Sabotage{Broken::stamp_check, "T1", "stamp_check"},
                    Sabotage{Broken::format_check, "A12 size", "format_check"},
                    Sabotage{Broken::frozen_check, "A3 frozen 3", "frozen_check"},
                    Sabotage{Broken::light_check, "A5 saturated", "light_check"},
                    Sabotage{Broken::row_check, "A5 half", "row_check_half"},
                    Sabotage{Broken::row_check, "A5 torn", "row_check_torn"},
                    Sabotage{Broken::row_check, "A5 stripes", "row_check_stripes"},
                    Sabotage{Broken::correlation_gate, "A2 100", "correlation_gate"},
                    Sabotage{Broken::covariance, "clean", "covariance"},
                    Sabotage{Broken::silence, "A2 100", "silence"},
                    Sabotage{Broken::drop_oldest, "R2 slow", "drop_oldest"}),
    [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace lsv::faults
