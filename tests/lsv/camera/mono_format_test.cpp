// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/camera/mono_format.h"

#include <arv.h>
#include <gtest/gtest.h>

namespace lsv {
namespace {

TEST(MonoFormat, CodesAreThoseOfAravis) {
  EXPECT_EQ(mono_format("Mono8")->pfnc_code, std::uint32_t{ARV_PIXEL_FORMAT_MONO_8});
  EXPECT_EQ(mono_format("Mono10")->pfnc_code, std::uint32_t{ARV_PIXEL_FORMAT_MONO_10});
  EXPECT_EQ(mono_format("Mono12")->pfnc_code, std::uint32_t{ARV_PIXEL_FORMAT_MONO_12});
  EXPECT_EQ(mono_format("Mono14")->pfnc_code, std::uint32_t{ARV_PIXEL_FORMAT_MONO_14});
  EXPECT_EQ(mono_format("Mono16")->pfnc_code, std::uint32_t{ARV_PIXEL_FORMAT_MONO_16});
}

TEST(MonoFormat, NameAndCodeMeanTheSameAndAFrameCanLookLikeIt) {
  for (const char* const name : {"Mono8", "Mono10", "Mono12", "Mono14", "Mono16"}) {
    const auto by_name = mono_format(name);
    ASSERT_TRUE(by_name) << name;
    const auto by_code = mono_format(by_name->pfnc_code);
    ASSERT_TRUE(by_code) << name;
    EXPECT_EQ(by_code->name, name);
    EXPECT_EQ(std::string("Mono") + std::to_string(by_code->bit_depth), name);
    EXPECT_TRUE(is_possible(
        {.width_px = 1, .height_px = 1, .type = by_code->type, .bit_depth = by_code->bit_depth}))
        << name;
  }
}

TEST(MonoFormat, PackedAndColourPixelsAreNotRead) {
  for (const char* const name : {"Mono12Packed", "Mono12p", "RGB8", "BayerRG8", "mono8", ""})
    EXPECT_FALSE(mono_format(name)) << name;
  EXPECT_FALSE(mono_format(std::uint32_t{ARV_PIXEL_FORMAT_MONO_12_PACKED}));
  EXPECT_FALSE(mono_format(std::uint32_t{0}));
}

TEST(MonoFormat, MessagesNameAllOfThem) {
  EXPECT_EQ(mono_format_names(), "Mono8, Mono10, Mono12, Mono14 and Mono16");
}

}  // namespace
}  // namespace lsv
