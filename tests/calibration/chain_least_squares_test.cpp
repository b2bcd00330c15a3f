// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/chain_least_squares.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <Eigen/QR>
#include <random>

namespace lsv {
namespace {

constexpr int kNodes = 7;
constexpr int kNode = 2;
constexpr int kShared = 3;
constexpr int kAll = kNodes * kNode + kShared;
using Chain = ChainLeastSquares<kNode, kShared, 4>;

// A chain that breaks in the middle, with weights from 1 to 1e6, against all of it at once.
TEST(ChainLeastSquares, SaysWhatADenseSolutionSays) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  Chain chain(kNodes);
  Eigen::MatrixXd dense(0, kAll);
  Eigen::VectorXd right(0);
  const auto add = [&](const Chain::Equation& e, int node) {
    chain.add(e);
    dense.conservativeResize(dense.rows() + 1, Eigen::NoChange);
    right.conservativeResize(right.size() + 1);
    dense.row(dense.rows() - 1).setZero();
    dense.block<1, kNode>(dense.rows() - 1, node * kNode) = e.node.transpose();
    if (node + 1 < kNodes)
      dense.block<1, kNode>(dense.rows() - 1, (node + 1) * kNode) = e.next.transpose();
    dense.bottomRightCorner<1, kShared>() = e.shared.transpose();
    right(right.size() - 1) = e.right;
  };
  const auto equation = [&](bool linked, double weight) {
    Chain::Equation e;
    for (double& value : e.node) value = weight * normal(random);
    for (double& value : e.shared) value = weight * normal(random);
    if (linked) {
      for (double& value : e.next) value = weight * normal(random);
    }
    e.right = weight * normal(random);
    return e;
  };
  add(equation(false, 1.0), 0);  // a prior, before the equations of the first node
  for (int node = 0; node < kNodes; ++node) {
    for (int i = 0; i < 2; ++i) add(equation(false, 1.0), node);
    const bool linked = node + 1 < kNodes && node != 3;
    for (int i = 0; linked && i < 2; ++i) add(equation(true, 1e6), node);
    chain.next_node();
  }
  const Chain::Solution solution = chain.solve();
  const Eigen::VectorXd expected = dense.colPivHouseholderQr().solve(right);
  const double scale = expected.norm();
  for (int node = 0; node < kNodes; ++node) {
    for (int i = 0; i < kNode; ++i)
      EXPECT_NEAR(solution.nodes[static_cast<std::size_t>(node)](i), expected(node * kNode + i),
                  1e-6 * scale)
          << node;
  }
  EXPECT_LT((solution.shared - expected.tail<kShared>()).norm(), 1e-6 * scale);
  EXPECT_NEAR(solution.squares / (dense * expected - right).squaredNorm(), 1.0, 1e-4);
  const Eigen::MatrixXd information = dense.transpose() * dense;
  const Eigen::MatrixXd covariance = information.inverse().bottomRightCorner<kShared, kShared>();
  const Chain::SharedMatrix found =
      (solution.information_root.transpose() * solution.information_root).inverse();
  EXPECT_LT((found - covariance).norm(), 1e-3 * covariance.norm());
}

}  // namespace
}  // namespace lsv
