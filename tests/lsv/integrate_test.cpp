// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/integrate.h"

#include <gtest/gtest.h>

#include <cmath>

namespace lsv {
namespace {

TEST(Integrator, StartsAtTheOriginWithoutDoubt) {
  const Integrator integrator;
  EXPECT_EQ(integrator.position().x_m, 0.0);
  EXPECT_EQ(integrator.position().sigma_y_m, 0.0);
}

TEST(Integrator, ThereAndBackIsTheOriginAndTheDoubtGrows) {
  Integrator integrator;
  integrator.add({.x_m = 0.3, .y_m = -0.1, .sigma_x_m = 3e-6, .sigma_y_m = 1e-6});
  integrator.add({.x_m = -0.3, .y_m = 0.1, .sigma_x_m = 4e-6, .sigma_y_m = 0.0});
  EXPECT_EQ(integrator.position().x_m, 0.0);
  EXPECT_EQ(integrator.position().y_m, 0.0);
  EXPECT_NEAR(integrator.position().sigma_x_m, 5e-6, 1e-18);
  EXPECT_NEAR(integrator.position().sigma_y_m, 1e-6, 1e-18);
}

// A model error repeats with the motion and adds up linearly; noise does not.
TEST(Integrator, ModelErrorsAddUpLinearly) {
  Integrator integrator;
  for (int i = 0; i < 100; ++i) {
    integrator.add({.x_m = 1e-5,
                    .y_m = 0.0,
                    .sigma_x_m = 5e-9,
                    .sigma_y_m = 5e-9,
                    .model_sigma_x_m = 3e-9,
                    .model_sigma_y_m = 0.0});
  }
  EXPECT_NEAR(integrator.position().sigma_x_m, std::hypot(100 * 3e-9, 10 * 4e-9), 1e-15);
  EXPECT_NEAR(integrator.position().sigma_y_m, 50e-9, 1e-15);
}

// 24 h at 1 kHz and 42 um a step: a float32 sum stops for good at 1024 m.
TEST(Integrator, StillAdvancesAfterADayOfDriving) {
  Integrator integrator;
  const Displacement step{.x_m = 42e-6, .y_m = 0.0, .sigma_x_m = 1e-9, .sigma_y_m = 1e-9};
  constexpr int kFrames = 86'400'000;
  for (int i = 0; i < kFrames; ++i) integrator.add(step);
  EXPECT_NEAR(integrator.position().x_m, 3628.8, 5e-6);
  float single = 0.0F;
  for (int i = 0; i < kFrames; ++i) single += 42e-6F;
  EXPECT_LT(single, 1025.0F);
}

}  // namespace
}  // namespace lsv
