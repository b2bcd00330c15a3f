// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/mount_fit.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>
#include <utility>

#include "calibration/chain_least_squares.h"
#include "calibration/ground_travel.h"
#include "calibration/heading_jumps.h"
#include "calibration/rigid_start.h"
#include "calibration/robust.h"
#include "calibration/track_links.h"

namespace lsv {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

// A node is a reference pose: place of the sensor on the ground, heading of the body. Shared are
// the figures of MountCovariance.
constexpr int kYaw = 2;
constexpr int kScale = 3;
constexpr int kClock = 4;
using Chain = ChainLeastSquares<3, 5, 5>;

constexpr std::size_t kFewestPoses = 20;
// Motion and turning below so many sigmas of the reference could be its errors.
constexpr double kLeastSpread_sigmas = 50.0;
// Of the information matrix with its columns at one length, square root.
constexpr double kLargestCondition = 100.0;
// A mount less certain than that is none.
constexpr double kWorstLever_m = 0.1;
constexpr double kWorstYaw_rad = 0.1;
constexpr double kMostOutliers_ratio = 0.1;
// Residuals this improbable are not chance.
constexpr double kMaxChi2Sigmas = 3.0;
// Time stamps and what the travel does between two frames; far below any reference.
constexpr double kLinkFloor_m = 1e-7;
constexpr double kClockReach_s = 0.5;
constexpr double kClockStep_s = 0.1;
constexpr double kClockDelta_s = 0.01;
constexpr int kMostSteps = 25;
constexpr int kMostPasses = 20;

Error bad_drive(const std::string& sentence) { return {ErrorCode::bad_input, sentence}; }

std::string text_of(const char* format, double value) {
  char text[64];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

constexpr double kDegrees = 180.0 / std::numbers::pi;

/// One set of poses and the track between them, at one offset of the clocks.
struct Links {
  std::vector<TrackLink> here;
  std::vector<TrackLink> earlier;  // at a smaller offset, and at a larger one; for the derivative
  std::vector<TrackLink> later;
};

struct State {
  Chain::Shared q = Chain::Shared::Zero();
  std::vector<Chain::Node> nodes;
};

struct Minimum {
  State state;
  Chain::SharedMatrix information_root = Chain::SharedMatrix::Zero();
  double chi2 = 0.0;
  bool has_settled = false;
};

class MountProblem {
 public:
  /// `poses` about the origin of their first.
  MountProblem(BodyReference poses, const SensorTrack& track, const MountOptions& options)
      : poses_(std::move(poses)), track_(track), options_(options) {
    for (const ReferencePose& pose : poses_) stamps_.push_back(pose.stamp);
  }

  const BodyReference& poses() const { return poses_; }

  struct Start {
    Chain::Shared q = Chain::Shared::Zero();
    std::vector<bool> outliers;
  };
  /// By a linear fit to the headings as they are, which no outlier can upset for long.
  Start start() const {
    const Links links = links_at(0.0);
    std::vector<RigidRow> rows;
    Vector2d path_m = Vector2d::Zero();
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      const bool is_linked = i > 0 && is_usable(links, i - 1);
      if (is_linked)
        path_m += travel(links.here, i - 1, poses_[i - 1].yaw_rad, poses_[i].yaw_rad).d_m;
      rows.push_back({.begins_chain = !is_linked,
                      .yaw_rad = poses_[i].yaw_rad,
                      .path_m = path_m,
                      .target_m = position(poses_[i])});
    }
    std::optional<Vector2d> lever_m;
    if (options_.lever) lever_m = Vector2d(-options_.lever->x_m, -options_.lever->y_m);
    const RigidStart found = rigid_start(rows, lever_m);
    std::vector<double> residuals;
    for (std::size_t i = 0; i < poses_.size(); ++i)
      residuals.push_back(found.residuals_m[i].cwiseAbs().maxCoeff() / poses_[i].sigma_m);
    const double limit = outlier_limit_sigmas(residuals);
    Start out;
    for (const double residual : residuals) out.outliers.push_back(residual > limit);
    out.q.head<2>() = -found.c_m;
    out.q(kYaw) = std::atan2(found.b, found.a);
    out.q(kScale) = 1.0;
    return out;
  }

  Minimum minimise(const Chain::Shared& start) const {
    Minimum out;
    out.state.q = start;
    for (const ReferencePose& pose : poses_) {
      const Vector2d place = position(pose) + rotation(pose.yaw_rad) * start.head<2>();
      out.state.nodes.emplace_back(place.x(), place.y(), pose.yaw_rad);
    }
    for (int step = 0; step < kMostSteps; ++step) {
      const Chain::Solution solution = solve_linear(out.state);
      const Chain::Shared& change = solution.shared;
      if (!change.allFinite()) break;
      const double shrink = std::min(1.0, kClockStep_s / std::abs(change(kClock)));
      out.state.q += shrink * change;
      if (std::abs(out.state.q(kClock)) > kClockReach_s) break;
      for (std::size_t i = 0; i < out.state.nodes.size(); ++i)
        out.state.nodes[i] += shrink * solution.nodes[i];
      out.information_root = solution.information_root;
      out.chi2 = solution.squares;
      constexpr double kSettled_sigmas = 1e-3;
      out.has_settled = (solution.information_root * change).norm() < kSettled_sigmas;
      if (out.has_settled) break;
    }
    return out;
  }

  /// Reference less fit.
  Vector2d residual_m(const State& state, std::size_t i) const {
    const Chain::Node& node = state.nodes[i];
    return position(poses_[i]) - (node.head<2>() - rotation(node(2)) * state.q.head<2>());
  }

  /// True where a pose contradicts the rest.
  std::vector<bool> outliers(const State& state) const {
    std::vector<double> places;
    std::vector<double> headings;
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      const Vector2d left_m = residual_m(state, i) / poses_[i].sigma_m;
      places.push_back(std::max(std::abs(left_m.x()), std::abs(left_m.y())));
      headings.push_back(std::abs(turn_between(state.nodes[i](2), poses_[i].yaw_rad)) /
                         poses_[i].sigma_yaw_rad);
    }
    const double place_limit = outlier_limit_sigmas(places);
    const double heading_limit = outlier_limit_sigmas(headings);
    std::vector<bool> out(poses_.size());
    for (std::size_t i = 0; i < poses_.size(); ++i)
      out[i] = places[i] > place_limit || headings[i] > heading_limit;
    return out;
  }

  struct Extent {
    std::size_t links = 0;
    std::size_t gaps = 0;
    double travel_m = 0.0;
    double turn_rad = 0.0;  // largest less smallest heading
  };
  Extent extent(double clock_offset_s) const {
    const Links links = links_at(clock_offset_s);
    Extent out;
    double yaw_rad = 0.0;
    double least_rad = 0.0;
    double most_rad = 0.0;
    for (std::size_t i = 0; i < links.here.size(); ++i) {
      yaw_rad += turn_between(poses_[i].yaw_rad, poses_[i + 1].yaw_rad);
      least_rad = std::min(least_rad, yaw_rad);
      most_rad = std::max(most_rad, yaw_rad);
      if (!is_usable(links, i)) {
        ++out.gaps;
        continue;
      }
      ++out.links;
      out.travel_m += std::hypot(links.here[i].moments_m[0][0], links.here[i].moments_m[0][1]);
    }
    out.turn_rad = most_rad - least_rad;
    return out;
  }

  bool fits_scale() const { return options_.scale_sigma_ratio > 0.0; }
  bool fits_clock() const { return options_.fit_clock; }
  int priors() const {
    return (options_.lever ? 2 : 0) + (fits_scale() && std::isfinite(options_.scale_sigma_ratio));
  }
  std::vector<int> fitted() const {
    std::vector<int> out = {0, 1, kYaw};
    if (fits_scale()) out.push_back(kScale);
    if (options_.fit_clock) out.push_back(kClock);
    return out;
  }

 private:
  static Vector2d position(const ReferencePose& pose) { return {pose.x_m, pose.y_m}; }

  Links links_at(double clock_offset_s) const {
    Links out;
    out.here = link_track(stamps_, track_, clock_offset_s);
    if (!options_.fit_clock) return out;
    out.earlier = link_track(stamps_, track_, clock_offset_s - kClockDelta_s);
    out.later = link_track(stamps_, track_, clock_offset_s + kClockDelta_s);
    return out;
  }

  bool is_usable(const Links& links, std::size_t i) const {
    if (std::abs(turn_between(poses_[i].yaw_rad, poses_[i + 1].yaw_rad)) > kLargestTurn_rad)
      return false;
    if (!links.here[i].is_known) return false;
    return !options_.fit_clock || (links.earlier[i].is_known && links.later[i].is_known);
  }

  static GroundTravel travel(const std::vector<TrackLink>& links, std::size_t i, double from_rad,
                             double to_rad) {
    return ground_travel(links[i], from_rad, turn_between(from_rad, to_rad));
  }

  Chain::Solution solve_linear(const State& state) const {
    const Links links = links_at(state.q(kClock));
    Chain chain(poses_.size());
    add_priors(state.q, chain);
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      add_pose(state, i, chain);
      if (i + 1 < poses_.size() && is_usable(links, i)) add_link(links, state, i, chain);
      chain.next_node();
    }
    return chain.solve();
  }

  void add_priors(const Chain::Shared& q, Chain& chain) const {
    const auto add = [&](int figure, double value, double sigma) {
      Chain::Equation e;
      e.shared(figure) = 1.0 / sigma;
      e.right = (value - q(figure)) / sigma;
      chain.add(e);
    };
    if (options_.lever) {
      add(0, options_.lever->x_m, options_.lever->sigma_m);
      add(1, options_.lever->y_m, options_.lever->sigma_m);
    }
    // What is not fitted stays.
    if (!fits_scale())
      add(kScale, q(kScale), 1.0);
    else if (std::isfinite(options_.scale_sigma_ratio))
      add(kScale, 1.0, options_.scale_sigma_ratio);
    if (!options_.fit_clock) add(kClock, q(kClock), 1.0);
  }

  void add_pose(const State& state, std::size_t i, Chain& chain) const {
    const ReferencePose& pose = poses_[i];
    const double yaw_rad = state.nodes[i](2);
    Chain::Equation heading;
    heading.node(2) = 1.0 / pose.sigma_yaw_rad;
    heading.right = turn_between(yaw_rad, pose.yaw_rad) / pose.sigma_yaw_rad;
    chain.add(heading);
    const Matrix2d turn = rotation(yaw_rad);
    const Vector2d by_heading = -left_of(turn * state.q.head<2>());
    const Vector2d left_m = residual_m(state, i);
    for (int axis = 0; axis < 2; ++axis) {
      Chain::Equation e;
      e.node(axis) = 1.0 / pose.sigma_m;
      e.node(2) = by_heading(axis) / pose.sigma_m;
      e.shared.head<2>() = -turn.row(axis).transpose() / pose.sigma_m;
      e.right = left_m(axis) / pose.sigma_m;
      chain.add(e);
    }
  }

  /// next - place = k R(yaw) D
  void add_link(const Links& links, const State& state, std::size_t i, Chain& chain) const {
    const Chain::Node& from = state.nodes[i];
    const Chain::Node& to = state.nodes[i + 1];
    const Matrix2d mount = state.q(kScale) * rotation(state.q(kYaw));
    const GroundTravel way = travel(links.here, i, from(2), to(2));
    const Vector2d way_m = mount * way.d_m;
    Eigen::Matrix<double, 2, 5> shared = Eigen::Matrix<double, 2, 5>::Zero();
    shared.col(kYaw) = -left_of(way_m);
    if (fits_scale()) shared.col(kScale) = -way_m / state.q(kScale);
    if (options_.fit_clock) {
      const Vector2d change_m =
          travel(links.later, i, from(2), to(2)).d_m - travel(links.earlier, i, from(2), to(2)).d_m;
      shared.col(kClock) = -mount * change_m / (2.0 * kClockDelta_s);
    }
    const Vector2d by_from = -mount * way.by_from;
    const Vector2d by_to = -mount * way.by_to;
    const Vector2d right_m = way_m - (to.head<2>() - from.head<2>());
    const Matrix2d covariance =
        mount * travel_covariance(links.here[i], from(2)) * mount.transpose() +
        kLinkFloor_m * kLinkFloor_m * Matrix2d::Identity();
    const Matrix2d whitener =
        Eigen::LLT<Matrix2d>(covariance).matrixL().solve(Matrix2d::Identity().eval());
    for (int row = 0; row < 2; ++row) {
      const auto w = whitener.row(row);
      Chain::Equation e;
      e.node << -w(0), -w(1), w.dot(by_from);
      e.next << w(0), w(1), w.dot(by_to);
      e.shared = (w * shared).transpose();
      e.right = w.dot(right_m);
      chain.add(e);
    }
  }

  BodyReference poses_;
  std::vector<Stamp> stamps_;
  const SensorTrack& track_;
  const MountOptions& options_;
};

/// Placed poses whose heading does not jump, about the first of them.
BodyReference usable_poses(const BodyReference& reference, const SensorTrack& track) {
  BodyReference out;
  const std::vector<bool> jumps = heading_jumps(reference);
  for (const std::size_t i : placed_poses(reference, track, 0.0)) {
    if (!jumps[i]) out.push_back(reference[i]);
  }
  for (std::size_t i = out.size(); i-- > 0;) {
    out[i].x_m -= out[0].x_m;
    out[i].y_m -= out[0].y_m;
  }
  return out;
}

Result<void> check_motion(const BodyReference& poses, const MountOptions& options) {
  std::vector<double> x_m, y_m, yaw_rad, sigma_m, sigma_yaw_rad;
  double heading_rad = 0.0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (i > 0) heading_rad += turn_between(poses[i - 1].yaw_rad, poses[i].yaw_rad);
    x_m.push_back(poses[i].x_m);
    y_m.push_back(poses[i].y_m);
    yaw_rad.push_back(heading_rad);
    sigma_m.push_back(poses[i].sigma_m);
    sigma_yaw_rad.push_back(poses[i].sigma_yaw_rad);
  }
  const double moved_m = std::max(spread(x_m), spread(y_m));
  if (moved_m < kLeastSpread_sigmas * median(sigma_m))
    return bad_drive("the body moved by only " + text_of("%.3g", 1e3 * moved_m) +
                     " mm, too little against the sigma of the reference: without driving the yaw "
                     "of a sensor is unknown");
  const double turned_rad = spread(yaw_rad);
  if (!options.lever && turned_rad < kLeastSpread_sigmas * median(sigma_yaw_rad))
    return bad_drive("the body turned by only " + text_of("%.2g", kDegrees * turned_rad) +
                     " deg, too little against the sigma of its heading: without turning the lever "
                     "arm is unknown; drive curves to both sides, or give the lever arm");
  return {};
}

struct Certainty {
  Chain::SharedMatrix covariance = Chain::SharedMatrix::Zero();
  double condition = 0.0;
};

Certainty certainty(const Chain::SharedMatrix& information_root, const std::vector<int>& fitted) {
  Certainty out;
  const Chain::SharedMatrix inverse =
      information_root.triangularView<Eigen::Upper>().solve(Chain::SharedMatrix::Identity());
  const Chain::SharedMatrix covariance = inverse * inverse.transpose();
  for (const int i : fitted) {
    for (const int j : fitted) out.covariance(i, j) = covariance(i, j);
  }
  Chain::SharedMatrix scaled = information_root;
  for (int i = 0; i < scaled.cols(); ++i) scaled.col(i).normalize();
  const Eigen::SelfAdjointEigenSolver<Chain::SharedMatrix> eigen(scaled.transpose() * scaled,
                                                                 Eigen::EigenvaluesOnly);
  out.condition =
      std::sqrt(eigen.eigenvalues().maxCoeff() / std::max(0.0, eigen.eigenvalues().minCoeff()));
  return out;
}

Result<void> check_minimum(const MountProblem& problem, const Minimum& minimum,
                           const Certainty& found) {
  if (!(found.condition < kLargestCondition)) {
    std::string figures = "yaw and lever arm";
    if (problem.fits_scale()) figures += " and scale";
    if (problem.fits_clock()) figures += " and clock";
    return bad_drive(
        figures + " cannot be told apart (condition number " + text_of("%.0f", found.condition) +
        "): curves of one radius alone do not do; add straight stretches and curves of "
        "other radii, to both sides, at changing speed");
  }
  if (!minimum.has_settled)
    return bad_drive(
        "the fit does not settle: reference and track do not belong together, or their clocks "
        "differ");
  return {};
}

Result<void> check_certainty(const Certainty& found) {
  const double lever_m = std::sqrt(std::max(found.covariance(0, 0), found.covariance(1, 1)));
  const double yaw_rad = std::sqrt(found.covariance(kYaw, kYaw));
  if (!(lever_m < kWorstLever_m && yaw_rad < kWorstYaw_rad))
    return bad_drive("the drive leaves the mount too uncertain (lever arm +- " +
                     text_of("%.0f", 1e3 * lever_m) + " mm, yaw +- " +
                     text_of("%.1f", kDegrees * yaw_rad) +
                     " deg): drive longer, with more and sharper curves");
  return {};
}

void fill(const MountProblem& problem, const Minimum& minimum, Certainty found, MountFit& out) {
  const Chain::Shared& q = minimum.state.q;
  out.x_m = q(0);
  out.y_m = q(1);
  out.yaw_rad = turn_between(0.0, q(kYaw));
  out.scale_ratio = q(kScale);
  out.clock_offset_s = q(kClock);
  const MountProblem::Extent extent = problem.extent(q(kClock));
  out.travel_m = extent.travel_m;
  out.turn_rad = extent.turn_rad;
  out.gaps = extent.gaps;
  out.poses = problem.poses().size();
  out.chi2 = minimum.chi2;
  out.dof = 2 * static_cast<int>(extent.links) + problem.priors() -
            static_cast<int>(problem.fitted().size());
  const double ratio = out.chi2 / out.dof;
  if (ratio > 1.0 + kMaxChi2Sigmas * std::sqrt(2.0 / out.dof)) out.sigma_factor = std::sqrt(ratio);
  found.covariance *= out.sigma_factor * out.sigma_factor;
  for (int i = 0; i < found.covariance.rows(); ++i) {
    for (int j = 0; j < found.covariance.cols(); ++j)
      out.cov[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)] = found.covariance(i, j);
  }
  for (std::size_t i = 0; i < problem.poses().size(); ++i) {
    const Vector2d left_m =
        rotation(-minimum.state.nodes[i](2)) * problem.residual_m(minimum.state, i);
    out.residuals.push_back({.stamp = problem.poses()[i].stamp,
                             .forward_m = left_m.x(),
                             .left_m = left_m.y(),
                             .sigma_m = problem.poses()[i].sigma_m});
  }
}

/// The poses that are no outliers.
BodyReference kept(const BodyReference& poses, const std::vector<bool>& outliers) {
  BodyReference out;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (!outliers[i]) out.push_back(poses[i]);
  }
  return out;
}

Result<MountFit> fit_unmirrored(const BodyReference& reference, const SensorTrack& track,
                                const MountOptions& options) {
  BodyReference poses = usable_poses(reference, track);
  if (poses.size() < kFewestPoses)
    return bad_drive("only " + std::to_string(poses.size()) +
                     " reference poses lie within the track, and " + std::to_string(kFewestPoses) +
                     " are needed: do both cover the same time, on one clock?");
  if (Result<void> moves = check_motion(poses, options); !moves) return moves.error();
  const std::size_t all = poses.size();
  std::optional<Chain::Shared> start;
  for (int pass = 0; pass < kMostPasses; ++pass) {
    if (static_cast<double>(all - poses.size()) > kMostOutliers_ratio * static_cast<double>(all))
      return bad_drive("more than a tenth of the reference poses contradict the track");
    const MountProblem problem(poses, track, options);
    if (problem.extent(0.0).links < kFewestPoses)
      return bad_drive("the track holds too few accepted shifts between poses of the reference");
    if (!start) {
      const MountProblem::Start first = problem.start();
      poses = kept(problem.poses(), first.outliers);
      if (poses.size() == problem.poses().size()) start = first.q;
      // Without the worst others come to light.
      if (!start) continue;
    }
    const Minimum minimum = problem.minimise(*start);
    const Certainty found = certainty(minimum.information_root, problem.fitted());
    if (Result<void> sound = check_minimum(problem, minimum, found); !sound) return sound.error();
    start = minimum.state.q;
    poses = kept(problem.poses(), problem.outliers(minimum.state));
    if (poses.size() < problem.poses().size()) continue;
    if (Result<void> certain = check_certainty(found); !certain) return certain.error();
    MountFit out;
    fill(problem, minimum, found, out);
    out.outliers = all - poses.size();
    return out;
  }
  return bad_drive("the reference poses that contradict the track do not come to an end");
}

SensorTrack mirrored(SensorTrack track) {
  for (TrackStep& step : track) {
    step.dy_m = -step.dy_m;
    step.xy_m2 = -step.xy_m2;
  }
  return track;
}

}  // namespace

Result<MountFit> fit_mount(const BodyReference& reference, const SensorTrack& track,
                           const MountOptions& options) {
  Result<MountFit> out = fit_unmirrored(reference, track, options);
  constexpr double kSuspect_factor = 2.0;
  if (out && out.value().sigma_factor < kSuspect_factor) return out;
  const Result<MountFit> mirror = fit_unmirrored(reference, mirrored(track), options);
  if (mirror && (!out || mirror.value().sigma_factor < out.value().sigma_factor / kSuspect_factor))
    return bad_drive(
        "the track fits only when its y axis is turned round: the reference axes of the sensor are "
        "mirrored against the body (z up); lsv calibrate scale finds the orientation");
  return out;
}

std::optional<Mount> mirrored_mount(const BodyReference& reference, const SensorTrack& track,
                                    const MountOptions& options, const MountFit& fit) {
  constexpr double kAsWell_factor = 1.2;
  const Result<MountFit> mirror = fit_unmirrored(reference, mirrored(track), options);
  if (!mirror || mirror.value().sigma_factor > kAsWell_factor * fit.sigma_factor)
    return std::nullopt;
  return mount_of(mirror.value());
}

Mount mount_of(const MountFit& fit) {
  return {.x_m = fit.x_m,
          .y_m = fit.y_m,
          .yaw_rad = fit.yaw_rad,
          .sigma_x_m = std::sqrt(fit.cov[0][0]),
          .sigma_y_m = std::sqrt(fit.cov[1][1]),
          .sigma_yaw_rad = std::sqrt(fit.cov[2][2])};
}

}  // namespace lsv
