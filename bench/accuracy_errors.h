// SPDX-License-Identifier: BSD-3-Clause
// The errors of one method over many pairs. An outlier is an error above 1 px along an axis, or no
// answer; RMSE, bias and maximum are over the rest, coverage over every answer.
#pragma once

#include "bench/accuracy_methods.h"
#include "tools/simulated_loop.h"

namespace lsv::bench {

inline constexpr double kOutlier_px = 1.0;

class Errors {
 public:
  void add(const Estimate& estimate, const cli::TrueShift& truth);

  int pairs() const { return pairs_; }
  int outliers() const { return outliers_; }
  double outlier_ratio() const { return static_cast<double>(outliers_) / pairs_; }
  /// So many outliers that the rest says nothing.
  bool fails() const { return 2 * outliers_ >= pairs_; }

  /// NaN when there are none.
  double rmse_px() const;  // of both axes together
  double bias_x_px() const;
  double bias_y_px() const;
  double max_px() const;

  /// Whether the method states a sigma.
  bool has_sigma() const { return judged_ > 0; }
  /// Share of the errors, both axes together, within 1 and 1.96 sigma.
  double within_1_sigma() const { return share(within_1_); }
  double within_196_sigma() const { return share(within_196_); }
  /// Number of errors that the two shares are of.
  int judged() const { return judged_; }

 private:
  void judge(double error_px, double sigma_px);
  int good() const { return pairs_ - outliers_; }
  double share(int count) const;

  int pairs_ = 0;
  int outliers_ = 0;
  int judged_ = 0;
  int within_1_ = 0;
  int within_196_ = 0;
  double sum_x_px_ = 0.0;
  double sum_y_px_ = 0.0;
  double squares_px2_ = 0.0;
  double max_px_ = 0.0;
};

}  // namespace lsv::bench
