// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/output/base64.h"

#include <gtest/gtest.h>

#include <string_view>
#include <vector>

namespace lsv {
namespace {

TEST(Base64, MatchesThePublishedVectors) {
  // RFC 4648, section 10.
  constexpr std::pair<std::string_view, std::string_view> kVectors[] = {{"", ""},
                                                                        {"f", "Zg=="},
                                                                        {"fo", "Zm8="},
                                                                        {"foo", "Zm9v"},
                                                                        {"foob", "Zm9vYg=="},
                                                                        {"fooba", "Zm9vYmE="},
                                                                        {"foobar", "Zm9vYmFy"}};
  for (const auto& [bytes, text] : kVectors)
    EXPECT_EQ(base64(std::vector<std::uint8_t>(bytes.begin(), bytes.end())), text);
}

}  // namespace
}  // namespace lsv
