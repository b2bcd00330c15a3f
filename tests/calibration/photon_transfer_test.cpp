// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/photon_transfer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <random>

namespace lsv {
namespace {

constexpr double kK = 0.4;
constexpr double kDark_counts = 60.0;
constexpr double kDarkVariance_counts2 = 9.0;

TransferPoint point(double signal_counts, double relative_sigma, double error = 0.0) {
  const double variance = kDarkVariance_counts2 + kK * signal_counts;
  return {
      .mean_counts = {kDark_counts + signal_counts, 1e-3},
      .variance_counts2 = {variance * (1.0 + relative_sigma * error), relative_sigma * variance}};
}

TEST(PhotonTransfer, AnExactLineGivesK) {
  const PhotonTransfer fit =
      fit_photon_transfer(point(0.0, 1e-3), {point(500.0, 1e-3), point(2000.0, 1e-3)}).value();
  EXPECT_NEAR(fit.k_counts_per_e.value, kK, 1e-12);
  EXPECT_NEAR(fit.chi2, 0.0, 1e-12);
  EXPECT_EQ(fit.dof, 1);
  EXPECT_EQ(fit.sigma_factor, 1.0);
}

// An error of the dark moves all levels alike: leaving that out would make the sigma too small.
TEST(PhotonTransfer, TheSigmaIsHonestThoughTheLevelsShareTheDark) {
  std::mt19937_64 random(11);
  std::normal_distribution<double> normal;
  for (const double dark_sigma : {1e-3, 0.1}) {
    double squares = 0.0;
    double chi2 = 0.0;
    constexpr int kTries = 400;
    for (int k = 0; k < kTries; ++k) {
      std::vector<TransferPoint> levels;
      for (const double signal : {50.0, 100.0, 150.0, 200.0})
        levels.push_back(point(signal, 0.01, normal(random)));
      const PhotonTransfer fit =
          fit_photon_transfer(point(0.0, dark_sigma, normal(random)), levels).value();
      squares += std::pow((fit.k_counts_per_e.value - kK) / fit.k_counts_per_e.sigma, 2.0);
      chi2 += fit.chi2 / fit.dof;
    }
    std::printf("dark sigma %.3f: error / sigma rms %.3f, chi2 / dof %.3f\n", dark_sigma,
                std::sqrt(squares / kTries), chi2 / kTries);
    EXPECT_NEAR(std::sqrt(squares / kTries), 1.0, 0.12);
    EXPECT_NEAR(chi2 / kTries, 1.0, 0.15);
  }
}

TEST(PhotonTransfer, ABendRaisesTheSigma) {
  std::vector<TransferPoint> levels = {point(100.0, 1e-3), point(500.0, 1e-3), point(1000.0, 1e-3)};
  levels[2].variance_counts2.value *= 0.9;
  const PhotonTransfer fit = fit_photon_transfer(point(0.0, 1e-3), levels).value();
  EXPECT_GT(fit.sigma_factor, 10.0);
}

TEST(PhotonTransfer, RefusesWhatTellsNothing) {
  const Result<PhotonTransfer> one = fit_photon_transfer(point(0.0, 1e-3), {point(500.0, 1e-3)});
  ASSERT_FALSE(one);
  EXPECT_NE(one.error().message.find("two levels"), std::string::npos);
  std::vector<TransferPoint> flat = {point(500.0, 1e-3), point(1000.0, 1e-3)};
  for (TransferPoint& level : flat) level.variance_counts2 = {kDarkVariance_counts2, 0.01};
  const Result<PhotonTransfer> none = fit_photon_transfer(point(0.0, 1e-3), flat);
  ASSERT_FALSE(none);
  EXPECT_NE(none.error().message.find("does not grow"), std::string::npos);
}

}  // namespace
}  // namespace lsv
