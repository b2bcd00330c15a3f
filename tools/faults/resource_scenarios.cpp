// SPDX-License-Identifier: BSD-3-Clause
// Faults of the machine that need no real time: R2.
#include "tools/faults/scenario.h"

namespace lsv::faults {

std::vector<Scenario> resource_scenarios() {
  std::vector<Scenario> out;
  constexpr int kDepth = 64;
  constexpr double kAge_s = kDepth * 1e-9 * static_cast<double>(kPeriod_ns);
  out.push_back({.id = "R2 slow",
                 .fault = "consumer 10 times too slow",
                 .inject = [](Script&) {},
                 .limits = {.good_measured_ratio = 0.0,
                            .queue_age_s = kAge_s,
                            .may_drop = true,
                            .quiet_otherwise = false},
                 .stream = {.queue_frames = kDepth},
                 .work_every = 10});
  out.push_back({.id = "R2 stops",
                 .fault = "consumer stops",
                 .inject = [](Script&) {},
                 .limits = {.good_measured_ratio = 0.0,
                            .queue_age_s = kAge_s,
                            .may_drop = true,
                            .quiet_otherwise = false},
                 .stream = {.queue_frames = kDepth},
                 .work_every = 1000});
  return out;
}

}  // namespace lsv::faults
