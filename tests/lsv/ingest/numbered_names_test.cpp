// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/ingest/numbered_names.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace lsv {
namespace {

using Names = std::vector<std::string>;
using Numbers = std::vector<std::int64_t>;

Names sorted(Names names) {
  std::sort(names.begin(), names.end(), natural_less);
  return names;
}

TEST(NaturalOrder, ComparesDigitRunsAsNumbers) {
  EXPECT_EQ(sorted({"img10", "img2", "img1"}), (Names{"img1", "img2", "img10"}));
  EXPECT_EQ(sorted({"a10b2", "a10b10", "a9b99"}), (Names{"a9b99", "a10b2", "a10b10"}));
  EXPECT_EQ(sorted({"img", "img1"}), (Names{"img", "img1"}));
}

TEST(NaturalOrder, HasNoLimitOnDigits) {
  const std::string nines(40, '9');
  EXPECT_TRUE(natural_less("x" + nines, "x1" + std::string(40, '0')));
}

TEST(NaturalOrder, IsAStrictOrderWithLeadingZeros) {
  EXPECT_FALSE(natural_less("img1", "img1"));
  EXPECT_NE(natural_less("img1", "img01"), natural_less("img01", "img1"));
  EXPECT_TRUE(natural_less("img001", "img2"));
}

TEST(Family, GivesTheOneVaryingNumber) {
  EXPECT_EQ(numbers_of_family({"d/cam1_007.png", "d/cam1_012.png"}), (Numbers{7, 12}));
  EXPECT_EQ(numbers_of_family({"1.png", "2.png", "30.png"}), (Numbers{1, 2, 30}));
}

TEST(Family, NeedsTheSameFolderAndText) {
  EXPECT_FALSE(numbers_of_family({"a/1.png", "b/2.png"}));
  EXPECT_FALSE(numbers_of_family({"ref.pgm", "def_05.pgm"}));
  EXPECT_FALSE(numbers_of_family({"img1.png", "img2.pgm"}));
}

TEST(Family, NeedsExactlyOneVaryingNumber) {
  EXPECT_FALSE(numbers_of_family({"cam1_1.png", "cam2_2.png"}));
  EXPECT_FALSE(numbers_of_family({"a1.png", "a1.png"}));
  EXPECT_FALSE(numbers_of_family({"only1.png"}));
}

TEST(Family, LeavesNumbersBeyond18DigitsAlone) {
  EXPECT_TRUE(numbers_of_family({"100000000000000000.png", "999999999999999999.png"}));
  EXPECT_FALSE(numbers_of_family({"1000000000000000000.png", "2000000000000000000.png"}));
}

}  // namespace
}  // namespace lsv
