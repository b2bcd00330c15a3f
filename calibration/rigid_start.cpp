// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/rigid_start.h"

#include <Eigen/QR>
#include <utility>

#include "calibration/ground_travel.h"
#include "calibration/robust.h"

namespace lsv {
namespace {

/// Columns a, b, c, target.
using Columns = Eigen::Matrix<double, 2, 5>;

Columns columns_of(const RigidRow& row) {
  Columns out;
  out << row.path_m, left_of(row.path_m), rotation(row.yaw_rad), row.target_m;
  return out;
}

/// Calls `with(begin, end)` for every chain of rows.
template <typename With>
void each_chain(const std::vector<RigidRow>& rows, const With& with) {
  for (std::size_t begin = 0; begin < rows.size();) {
    std::size_t end = begin + 1;
    while (end < rows.size() && !rows[end].begins_chain) ++end;
    with(begin, end);
    begin = end;
  }
}

/// Every chain about its mean, which takes its start out.
std::vector<Columns> centred(const std::vector<RigidRow>& rows) {
  std::vector<Columns> out;
  for (const RigidRow& row : rows) out.push_back(columns_of(row));
  each_chain(rows, [&out](std::size_t begin, std::size_t end) {
    Columns mean = Columns::Zero();
    for (std::size_t i = begin; i < end; ++i) mean += out[i];
    mean /= static_cast<double>(end - begin);
    for (std::size_t i = begin; i < end; ++i) out[i] -= mean;
  });
  return out;
}

void centre_at_median(const std::vector<RigidRow>& rows, std::vector<Eigen::Vector2d>& residuals) {
  each_chain(rows, [&residuals](std::size_t begin, std::size_t end) {
    for (int axis = 0; axis < 2; ++axis) {
      std::vector<double> values;
      for (std::size_t i = begin; i < end; ++i) values.push_back(residuals[i](axis));
      const double middle = median(std::move(values));
      for (std::size_t i = begin; i < end; ++i) residuals[i](axis) -= middle;
    }
  });
}

}  // namespace

RigidStart rigid_start(const std::vector<RigidRow>& rows,
                       const std::optional<Eigen::Vector2d>& c_m) {
  const std::vector<Columns> equations = centred(rows);
  Eigen::Matrix<double, 5, 5> squares = Eigen::Matrix<double, 5, 5>::Zero();
  for (const Columns& e : equations) squares += e.transpose() * e;

  Eigen::Vector4d q = Eigen::Vector4d::Zero();
  if (c_m) {
    q.tail<2>() = *c_m;
    const Eigen::Vector2d right = squares.block<2, 1>(0, 4) - squares.block<2, 2>(0, 2) * *c_m;
    const Eigen::Matrix2d normal = squares.topLeftCorner<2, 2>();
    q.head<2>() = normal.completeOrthogonalDecomposition().solve(right);
  } else {
    // Of the least length where a drive does not determine it.
    const Eigen::Matrix4d normal = squares.topLeftCorner<4, 4>();
    q = normal.completeOrthogonalDecomposition().solve(squares.block<4, 1>(0, 4));
  }
  RigidStart out{.a = q(0), .b = q(1), .c_m = q.tail<2>(), .residuals_m = {}};
  for (const Columns& e : equations) out.residuals_m.push_back(e.col(4) - e.leftCols<4>() * q);
  centre_at_median(rows, out.residuals_m);
  return out;
}

}  // namespace lsv
