// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/core/result.h"

#include <gtest/gtest.h>

#include <memory>

namespace lsv {
namespace {

TEST(Result, HoldsAValueOrAnError) {
  const Result<int> value = 7;
  ASSERT_TRUE(value);
  EXPECT_EQ(value.value(), 7);
  const Result<int> error = Error{ErrorCode::bad_input, "why"};
  ASSERT_FALSE(error);
  EXPECT_EQ(error.error().message, "why");
}

TEST(Result, AskingForTheOtherSideThrows) {
  const Result<int> error = Error{ErrorCode::bad_input, "why"};
  EXPECT_THROW((void)error.value(), std::bad_variant_access);
  const Result<int> value = 7;
  EXPECT_THROW((void)value.error(), std::bad_variant_access);
}

TEST(Result, CarriesWhatCannotBeCopied) {
  Result<std::unique_ptr<int>> owner = std::make_unique<int>(3);
  const std::unique_ptr<int> taken = std::move(owner).value();
  EXPECT_EQ(*taken, 3);
}

TEST(Result, OfNothingIsOkByDefault) {
  EXPECT_TRUE(Result<void>());
  EXPECT_FALSE(Result<void>(Error{ErrorCode::output_failed, "full"}));
}

}  // namespace
}  // namespace lsv
