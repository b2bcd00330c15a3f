// SPDX-License-Identifier: BSD-3-Clause
#include "fusion/chi_square.h"

#include <gtest/gtest.h>

#include <cmath>

namespace lsv {
namespace {

// Limits from printed tables (95 %, 99 %, 99.9 %).
TEST(ChiSquare, AgreesWithPrintedTables) {
  EXPECT_NEAR(chi_square_limit(0.05, 1), 3.841, 5e-4);
  EXPECT_NEAR(chi_square_limit(0.05, 2), 5.991, 5e-4);
  EXPECT_NEAR(chi_square_limit(0.01, 2), 9.210, 5e-4);
  EXPECT_NEAR(chi_square_limit(0.001, 2), 13.816, 5e-4);
  EXPECT_NEAR(chi_square_limit(1e-6, 2), 27.631, 5e-4);
  EXPECT_NEAR(chi_square_limit(0.05, 3), 7.815, 5e-4);
  EXPECT_NEAR(chi_square_limit(0.01, 4), 13.277, 5e-4);
  EXPECT_NEAR(chi_square_limit(0.05, 7), 14.067, 5e-4);
  EXPECT_NEAR(chi_square_limit(0.05, 16), 26.296, 5e-4);
}

TEST(ChiSquare, TheTailOfNothingIsAll) {
  for (int dof = 1; dof <= 16; ++dof) {
    EXPECT_DOUBLE_EQ(chi_square_tail(0.0, dof), 1.0) << dof;
    EXPECT_NEAR(chi_square_tail(chi_square_limit(1e-5, dof), dof), 1e-5, 1e-13) << dof;
  }
}

}  // namespace
}  // namespace lsv
