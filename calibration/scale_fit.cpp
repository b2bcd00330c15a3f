// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/scale_fit.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <utility>

namespace lsv {
namespace {

using Eigen::Matrix2d;
using Eigen::Matrix4d;
using Eigen::Vector2d;

// Travel across the main direction, in proportion to the travel along it.
constexpr double kMinAcross_ratio = 0.1;
// Residuals this improbable are not chance.
constexpr double kMaxChi2Sigmas = 3.0;
// The weights depend on the scale; they settle at once.
constexpr int kPasses = 3;

double wrapped_rad(double angle_rad) { return std::remainder(angle_rad, 2.0 * std::numbers::pi); }

/// A point of a run about the centre of its series; an end-to-end run has no centre to fit.
struct Row {
  std::size_t run = 0;
  Vector2d p_px = Vector2d::Zero();
  Vector2d r_m = Vector2d::Zero();
  Matrix2d cov_px2 = Matrix2d::Zero();
  double sigma_m = 0.0;
};

/// The matrix and, per axis of the reference, the covariance of its row.
struct Matrix {
  Matrix2d m = Matrix2d::Zero();
  Matrix2d cov[2] = {Matrix2d::Zero(), Matrix2d::Zero()};
};

double variance_m2(const Row& row, const Matrix2d& m, int axis) {
  return row.sigma_m * row.sigma_m + (m.row(axis) * row.cov_px2 * m.row(axis).transpose()).value();
}

std::vector<Row> rows_of(const std::vector<ScaleRun>& runs) {
  std::vector<Row> out;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    Vector2d centre_px = Vector2d::Zero();
    Vector2d centre_m = Vector2d::Zero();
    const auto count = static_cast<double>(runs[i].points.size());
    if (runs[i].points.size() > 1) {
      for (const ScalePoint& point : runs[i].points) {
        centre_px += Vector2d(point.dx_px, point.dy_px) / count;
        centre_m += Vector2d(point.x_m, point.y_m) / count;
      }
    }
    for (const ScalePoint& point : runs[i].points) {
      Row row{.run = i, .sigma_m = point.sigma_m};
      row.p_px = Vector2d(point.dx_px, point.dy_px) - centre_px;
      row.r_m = Vector2d(point.x_m, point.y_m) - centre_m;
      row.cov_px2 << point.cov.xx_px2, point.cov.xy_px2, point.cov.xy_px2, point.cov.yy_px2;
      out.push_back(row);
    }
  }
  return out;
}

constexpr std::size_t kNobody = static_cast<std::size_t>(-1);

/// Without the run `left_out`. False when the rest does not determine both columns.
bool solve(const std::vector<Row>& rows, std::size_t left_out, Matrix& out) {
  for (int pass = 0; pass < kPasses; ++pass) {
    const Matrix2d before = out.m;
    for (int axis = 0; axis < 2; ++axis) {
      Matrix2d normal = Matrix2d::Zero();
      Vector2d right = Vector2d::Zero();
      for (const Row& row : rows) {
        if (row.run == left_out) continue;
        const double weight = 1.0 / variance_m2(row, before, axis);
        normal += weight * row.p_px * row.p_px.transpose();
        right += weight * row.r_m(axis) * row.p_px;
      }
      const Eigen::SelfAdjointEigenSolver<Matrix2d> eigen(normal);
      const double least = eigen.eigenvalues()(0);
      if (!(least > kMinAcross_ratio * kMinAcross_ratio * eigen.eigenvalues()(1))) return false;
      const Eigen::LDLT<Matrix2d> inverse(normal);
      out.m.row(axis) = inverse.solve(right).transpose();
      out.cov[axis] = inverse.solve(Matrix2d::Identity());
    }
  }
  return out.m.allFinite() && std::abs(out.m.determinant()) > 0.0;
}

/// Why the runs do not determine the scale.
Error span_error(const std::vector<Row>& rows) {
  Matrix2d scatter = Matrix2d::Zero();
  for (const Row& row : rows) scatter += row.p_px * row.p_px.transpose();
  const Eigen::SelfAdjointEigenSolver<Matrix2d> eigen(scatter);
  const Vector2d main = eigen.eigenvectors().col(1);
  const double across = std::sqrt(std::max(0.0, eigen.eigenvalues()(0) / eigen.eigenvalues()(1)));
  if (!(eigen.eigenvalues()(1) > 0.0))
    return {ErrorCode::bad_input, "the runs do not move: their tracks end where they began"};
  char text[320];
  std::snprintf(
      text, sizeof text,
      "the runs go along one direction only (%.0f deg from image x, %.1f %% across it): "
      "the scale across it, the skew and the mirror would be a guess; add runs at about a "
      "right angle to it",
      std::remainder(std::atan2(main.y(), main.x()), std::numbers::pi) * 180.0 / std::numbers::pi,
      100.0 * across);
  return {ErrorCode::bad_input, text};
}

/// Rows sc_x, sc_y, angle, skew; columns xx, xy, yx, yy.
Matrix4d decomposition_jacobian(const Matrix2d& m, const ScaleFit& fit) {
  const double xx = m(0, 0), xy = m(0, 1), yx = m(1, 0), yy = m(1, 1);
  const double kx2 = xx * xx + yx * yx;
  const double ky2 = xy * xy + yy * yy;
  Matrix4d out;
  out.row(0) << -fit.sc_x_ratio * xx / kx2, 0.0, -fit.sc_x_ratio * yx / kx2, 0.0;
  out.row(1) << 0.0, -fit.sc_y_ratio * xy / ky2, 0.0, -fit.sc_y_ratio * yy / ky2;
  out.row(2) << -yx / kx2, 0.0, xx / kx2, 0.0;
  out.row(3) << 0.0, -yy / ky2, 0.0, xy / ky2;
  out.row(3) -= out.row(2);
  return out;
}

void decompose(const Matrix& matrix, double pixel_pitch_x_m, double pixel_pitch_y_m,
               ScaleFit& out) {
  const Matrix2d& m = matrix.m;
  const double mirror = m.determinant() < 0.0 ? -1.0 : 1.0;
  out.sc_x_ratio = pixel_pitch_x_m / std::hypot(m(0, 0), m(1, 0));
  out.sc_y_ratio = pixel_pitch_y_m / std::hypot(m(0, 1), m(1, 1));
  out.orientation.mirrored = mirror < 0.0;
  out.orientation.angle_rad = std::atan2(m(1, 0), m(0, 0));
  out.orientation.skew_rad =
      wrapped_rad(std::atan2(-mirror * m(0, 1), mirror * m(1, 1)) - out.orientation.angle_rad);
  Matrix4d entries = Matrix4d::Zero();
  entries.topLeftCorner<2, 2>() = matrix.cov[0];
  entries.bottomRightCorner<2, 2>() = matrix.cov[1];
  const Matrix4d j = decomposition_jacobian(m, out);
  const Matrix4d cov =
      out.sigma_factor * out.sigma_factor *
      (j * entries * j.transpose()).selfadjointView<Eigen::Upper>().toDenseMatrix();
  for (int i = 0; i < 4; ++i) {
    for (int k = 0; k < 4; ++k)
      out.cov[static_cast<std::size_t>(i)][static_cast<std::size_t>(k)] = cov(i, k);
  }
}

/// Error of a prediction of the end of a run by a matrix that has not seen it.
double left_out_sigmas(const Row& end, const Matrix& others, int axis) {
  const double residual_m = end.r_m(axis) - others.m.row(axis).dot(end.p_px);
  const double variance = variance_m2(end, others.m, axis) +
                          (end.p_px.transpose() * others.cov[axis] * end.p_px).value();
  return residual_m / std::sqrt(variance);
}

ScaleResidual residual_of(const std::string& name, const Row& end, const Matrix& fit) {
  ScaleResidual out;
  out.name = name;
  const Vector2d left_m = end.r_m - fit.m * end.p_px;
  out.x_m = left_m.x();
  out.y_m = left_m.y();
  out.sigma_x_m = std::sqrt(variance_m2(end, fit.m, 0));
  out.sigma_y_m = std::sqrt(variance_m2(end, fit.m, 1));
  return out;
}

}  // namespace

Result<ScaleFit> fit_scale(const std::vector<ScaleRun>& runs, double pixel_pitch_x_m,
                           double pixel_pitch_y_m) {
  const std::vector<Row> rows = rows_of(runs);
  const int offsets =
      2 * static_cast<int>(std::count_if(
              runs.begin(), runs.end(), [](const ScaleRun& run) { return run.points.size() > 1; }));
  ScaleFit out;
  out.dof = 2 * static_cast<int>(rows.size()) - 4 - offsets;
  if (out.dof < 1) {
    return Error{ErrorCode::bad_input,
                 "too few runs: four numbers are fitted, and something must be left to check them "
                 "with; give at least three runs"};
  }
  Matrix matrix;
  if (!solve(rows, kNobody, matrix)) return span_error(rows);

  out.chi2 = 0.0;
  for (const Row& row : rows) {
    const Vector2d left_m = row.r_m - matrix.m * row.p_px;
    for (int axis = 0; axis < 2; ++axis)
      out.chi2 += left_m(axis) * left_m(axis) / variance_m2(row, matrix.m, axis);
  }
  const double ratio = out.chi2 / out.dof;
  if (ratio > 1.0 + kMaxChi2Sigmas * std::sqrt(2.0 / out.dof)) out.sigma_factor = std::sqrt(ratio);
  decompose(matrix, pixel_pitch_x_m, pixel_pitch_y_m, out);

  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (i + 1 < rows.size() && rows[i + 1].run == rows[i].run) continue;
    ScaleResidual residual = residual_of(runs[rows[i].run].name, rows[i], matrix);
    Matrix others;
    if (solve(rows, rows[i].run, others)) {
      residual.left_out_x_sigmas = left_out_sigmas(rows[i], others, 0);
      residual.left_out_y_sigmas = left_out_sigmas(rows[i], others, 1);
    }
    out.residuals.push_back(std::move(residual));
  }
  return out;
}

Calibration with_scale(const Calibration& base, const ScaleFit& fit) {
  Calibration out = base;
  out.sc_x_ratio = fit.sc_x_ratio;
  out.sc_y_ratio = fit.sc_y_ratio;
  out.scale.emplace();
  out.scale->orientation = fit.orientation;
  out.scale->cov = fit.cov;
  return out;
}

ScaleChange compare_scales(const Calibration& first, const Calibration& second) {
  const auto figures = [](const Calibration& c) {
    const ScaleOrientation o = c.scale ? c.scale->orientation : ScaleOrientation{};
    return std::array<double, 4>{c.sc_x_ratio, c.sc_y_ratio, o.angle_rad, o.skew_rad};
  };
  const auto variance = [](const Calibration& c, std::size_t i) {
    return c.scale ? c.scale->cov[i][i] : kUnknown;
  };
  const auto mirrored = [](const Calibration& c) {
    return c.scale && c.scale->orientation.mirrored;
  };
  const auto a = figures(first);
  const auto b = figures(second);
  ScaleChange out;
  for (std::size_t i = 0; i < a.size(); ++i) {
    out.difference[i] = i < 2 ? b[i] - a[i] : wrapped_rad(b[i] - a[i]);
    out.sigmas[i] = out.difference[i] / std::sqrt(variance(first, i) + variance(second, i));
  }
  out.mirror_changed = mirrored(first) != mirrored(second);
  return out;
}

}  // namespace lsv
