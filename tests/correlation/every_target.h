// SPDX-License-Identifier: BSD-3-Clause
// Tests that run once per SIMD instruction set: those that this machine has and this program holds,
// the scalar one included.
#pragma once

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <cstdint>
#include <string>
#include <vector>

#include "correlation/kernels.h"

namespace lsv::test {

inline std::vector<std::int64_t> all_targets() {
  std::vector<std::int64_t> out;
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) out.push_back(target);
  return out;
}

inline std::string target_name(std::int64_t target) { return hwy::TargetName(target); }

/// Forces one instruction set for as long as it lives and proves that it is the one in force.
class ForcedTarget {
 public:
  explicit ForcedTarget(std::int64_t target) {
    hwy::SetSupportedTargetsForTest(target);
    EXPECT_EQ(kernels::simd_target(), hwy::TargetName(target));
  }
  ~ForcedTarget() { hwy::SetSupportedTargetsForTest(0); }
  ForcedTarget(const ForcedTarget&) = delete;
  ForcedTarget& operator=(const ForcedTarget&) = delete;
};

class EveryTargetTest : public testing::TestWithParam<std::int64_t> {
 private:
  ForcedTarget forced_{GetParam()};
};

}  // namespace lsv::test

#define LSV_INSTANTIATE_FOR_EVERY_TARGET(fixture)                        \
  INSTANTIATE_TEST_SUITE_P(                                              \
      EveryTarget, fixture, testing::ValuesIn(lsv::test::all_targets()), \
      [](const auto& tested) { return lsv::test::target_name(tested.param); })
