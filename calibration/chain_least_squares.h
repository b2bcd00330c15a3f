// SPDX-License-Identifier: BSD-3-Clause
// Linear least squares over a chain: each node has unknowns of its own, an equation knows one node
// or two neighbours, and some unknowns are shared by all. Nodes are eliminated one after the other
// by Householder QR, so that weights may differ by ten orders of magnitude and a chain may break
// anywhere (G. J. Bierman, Factorization Methods for Discrete Sequential Estimation, 1977, ch. V:
// the square-root information filter with its smoother). Time and memory grow with the nodes.
// Internal to calibration/.
#pragma once

#include <Eigen/Core>
#include <Eigen/QR>
#include <vector>

namespace lsv {

/// At most kNew equations may be added between two calls of next_node(). Each node needs equations
/// of its own that determine it.
template <int kNode, int kShared, int kNew>
class ChainLeastSquares {
 public:
  using Node = Eigen::Matrix<double, kNode, 1>;
  using Shared = Eigen::Matrix<double, kShared, 1>;
  using SharedMatrix = Eigen::Matrix<double, kShared, kShared>;

  /// Coefficients and right side, divided by the sigma of the equation.
  struct Equation {
    Node node = Node::Zero();
    Node next = Node::Zero();
    Shared shared = Shared::Zero();
    double right = 0.0;
  };

  struct Solution {
    Shared shared;
    SharedMatrix information_root;  // upper triangular; its square is the information matrix
    std::vector<Node> nodes;
    double squares = 0.0;  // weighted sum of squared residuals
  };

  explicit ChainLeastSquares(std::size_t nodes) { eliminated_.reserve(nodes); }

  void add(const Equation& equation) {
    stack_.row(used_++) << equation.node.transpose(), equation.next.transpose(),
        equation.shared.transpose(), equation.right;
  }

  void next_node() {
    const Stack r =
        Eigen::HouseholderQR<Stack>(stack_).matrixQR().template triangularView<Eigen::Upper>();
    eliminated_.push_back(r.template topRows<kNode>());
    squares_ += r(kColumns - 1, kColumns - 1) * r(kColumns - 1, kColumns - 1);
    constexpr int kCarried = kColumns - 1 - kNode;
    stack_.setZero();
    stack_.template block<kCarried, kNode>(0, 0) = r.template block<kCarried, kNode>(kNode, kNode);
    stack_.template block<kCarried, kShared + 1>(0, 2 * kNode) =
        r.template block<kCarried, kShared + 1>(kNode, 2 * kNode);
    used_ = kCarried;
  }

  /// After the last node, whose next_node() has been called.
  Solution solve() {
    // No node is left, so its columns are empty.
    using Rest = Eigen::Matrix<double, kRows, kShared + 1>;
    const Rest r = Eigen::HouseholderQR<Rest>(stack_.template rightCols<kShared + 1>())
                       .matrixQR()
                       .template triangularView<Eigen::Upper>();
    Solution out;
    out.information_root = r.template topLeftCorner<kShared, kShared>();
    out.shared = out.information_root.template triangularView<Eigen::Upper>().solve(
        r.template block<kShared, 1>(0, kShared));
    out.squares = squares_ + r(kShared, kShared) * r(kShared, kShared);
    out.nodes.resize(eliminated_.size());
    Node later = Node::Zero();
    for (std::size_t i = eliminated_.size(); i-- > 0;) {
      const auto& rows = eliminated_[i];
      const Node right = rows.template rightCols<1>() -
                         rows.template block<kNode, kNode>(0, kNode) * later -
                         rows.template block<kNode, kShared>(0, 2 * kNode) * out.shared;
      later = rows.template leftCols<kNode>().template triangularView<Eigen::Upper>().solve(right);
      out.nodes[i] = later;
    }
    return out;
  }

 private:
  static constexpr int kColumns = 2 * kNode + kShared + 1;
  static constexpr int kRows = kColumns - 1 - kNode + kNew;
  static_assert(kRows >= kColumns);
  using Stack = Eigen::Matrix<double, kRows, kColumns>;

  Stack stack_ = Stack::Zero();
  int used_ = 0;
  double squares_ = 0.0;
  std::vector<Eigen::Matrix<double, kNode, kColumns>> eliminated_;
};

}  // namespace lsv
