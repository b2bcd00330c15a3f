// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/scale_ratio.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <string>
#include <utility>
#include <vector>

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

// A node is the second sensor's place less that of the first (z) and the heading, at a reference
// pose. Shared are the matrix [a -b; b a] from the first travel to the second, c, and what is to be
// added to the times of the second track.
constexpr int kClock = 4;
using Chain = ChainLeastSquares<3, 5, 5>;

constexpr std::size_t kFewestPoses = 20;
constexpr double kLeastSpread_sigmas = 50.0;
constexpr double kMostOutliers_ratio = 0.1;
constexpr double kMaxChi2Sigmas = 3.0;
// Of travel per link, so that a track without noise can be had; and of the rig, at the least.
constexpr double kLinkFloor_m = 1e-8;
constexpr double kRigFloor_m = 1e-7;
constexpr double kLoose = 3.0;
constexpr double kClockReach_s = 0.5;
constexpr double kClockDelta_s = 0.01;
// How well two clocks agree at the worst where the drive does not tell.
constexpr double kClockSigma_s = 0.02;
// Nearer than that, no change of speed looks like a wrong shift.
constexpr double kClocksAgree_s = 1e-4;
constexpr int kMostSteps = 25;
constexpr int kMostPasses = 8;

Error bad_pair(const std::string& sentence) { return {ErrorCode::bad_input, sentence}; }

struct Lever {
  Vector2d c_m;
  double sigma_m;
};

struct State {
  Chain::Shared q = Chain::Shared::Zero();
  std::vector<Chain::Node> nodes;

  double yaw_rad(std::size_t i) const { return nodes[i](2); }
  /// Of the rig: how far the sensors are from where they belong to each other.
  Vector2d strain_m(std::size_t i) const {
    return rotation(yaw_rad(i)) * q.segment<2>(2) - nodes[i].head<2>();
  }
};

/// Of the linear fit to the headings as they are.
struct Start {
  State state;
  double strain_m = 0.0;  // sigma of what it leaves along the line between the sensors
};

struct Minimum {
  State state;
  Chain::SharedMatrix information_root;
  double chi2 = 0.0;
};

Matrix2d between(const Chain::Shared& q) {
  return (Matrix2d() << q(0), -q(1), q(1), q(0)).finished();
}

class PairProblem {
 public:
  PairProblem(BodyReference poses, const PairSensor& first, const PairSensor& second,
              const std::optional<Lever>& lever, double clock_offset_s)
      : poses_(std::move(poses)),
        start_clock_s_(clock_offset_s),
        lever_(lever),
        second_sensor_(second) {
    for (const ReferencePose& pose : poses_) stamps_.push_back(pose.stamp);
    first_ = link_track(stamps_, first.track, first.clock_offset_s);
    set_clock(start_clock_s_);
    for (std::size_t i = 0; i < first_.size(); ++i) {
      const double turn_rad = turn_between(poses_[i].yaw_rad, poses_[i + 1].yaw_rad);
      is_sound_.push_back(std::abs(turn_rad) <= kLargestTurn_rad);
    }
  }

  const BodyReference& poses() const { return poses_; }
  std::size_t usable_links() const {
    std::size_t out = 0;
    for (std::size_t i = 0; i < first_.size(); ++i) out += is_usable(i) ? 1 : 0;
    return out;
  }
  int priors() const { return 1 + (lever_ ? 2 : 0); }

  double travel_m() const {
    double out = 0.0;
    for (std::size_t i = 0; i < first_.size(); ++i) {
      if (is_usable(i)) out += std::hypot(first_[i].moments_m[0][0], first_[i].moments_m[0][1]);
    }
    return out;
  }

  /// The sigma of the rig is found from how it strains along the line between the sensors, where no
  /// error of a heading is seen. It begins loose: a stiff rig would hide its strain in the tracks.
  Result<Minimum> minimise() {
    Minimum out;
    set_clock(start_clock_s_);
    const Start first = start();
    out.state = first.state;
    rig_sigma_m_ = std::max(kRigFloor_m, kLoose * first.strain_m);
    constexpr int kMostTrials = 12;
    constexpr double kSettled_ratio = 0.97;
    for (int trial = 0; trial < kMostTrials; ++trial) {
      // One step is enough to see the strain; the last sigma gets as many as it takes.
      if (!improve(out)) return unsettled();
      const double found_m = std::max(kRigFloor_m, strain_along_m(out.state));
      const bool has_settled = found_m > kSettled_ratio * rig_sigma_m_;
      if (has_settled) break;
      rig_sigma_m_ = found_m;
    }
    for (int step = 0; step < kMostSteps; ++step) {
      const std::optional<double> change_sigmas = improve(out);
      constexpr double kSettled_sigmas = 1e-3;
      if (!change_sigmas) break;
      if (*change_sigmas < kSettled_sigmas) return out;
    }
    return unsettled();
  }

  double rig_sigma_m() const { return rig_sigma_m_; }

  /// Links whose travel stands out along the line between the sensors, where no error of a heading
  /// is seen: a shift that was accepted and wrong. True when there were any.
  bool screen_links() {
    const State state = start().state;
    const Vector2d along = state.q.segment<2>(2).normalized();
    std::vector<double> absolutes_m;
    std::vector<std::size_t> links;
    for (std::size_t i = 0; i < first_.size(); ++i) {
      if (!is_usable(i)) continue;
      const double middle_rad =
          state.yaw_rad(i) + 0.5 * turn_between(state.yaw_rad(i), state.yaw_rad(i + 1));
      absolutes_m.push_back(std::abs(equation(state, i).left_m.dot(rotation(middle_rad) * along)));
      links.push_back(i);
    }
    constexpr double kGross_sigmas = 10.0;
    const double limit_m = kGross_sigmas * sigma_of_nine_tenths(absolutes_m);
    bool found = false;
    for (std::size_t k = 0; k < links.size(); ++k) {
      if (absolutes_m[k] <= std::max(limit_m, kGross_sigmas * kRigFloor_m)) continue;
      is_sound_[links[k]] = false;
      found = true;
    }
    return found;
  }

  /// In sigmas, per pose.
  std::vector<double> heading_residuals(const State& state) const {
    std::vector<double> out;
    for (std::size_t i = 0; i < poses_.size(); ++i)
      out.push_back(std::abs(turn_between(state.yaw_rad(i), poses_[i].yaw_rad)) /
                    poses_[i].sigma_yaw_rad);
    return out;
  }

 private:
  static Error unsettled() {
    return bad_pair("the fit of the two tracks to each other does not settle");
  }

  /// One step of Gauss-Newton; its length in sigmas, or nothing when it led nowhere.
  std::optional<double> improve(Minimum& out) {
    const Chain::Solution solution = solve_linear(out.state);
    if (!solution.shared.allFinite()) return std::nullopt;
    out.state.q += solution.shared;
    if (std::abs(out.state.q(kClock)) > kClockReach_s) return std::nullopt;
    set_clock(out.state.q(kClock));
    for (std::size_t i = 0; i < poses_.size(); ++i) out.state.nodes[i] += solution.nodes[i];
    out.information_root = solution.information_root;
    out.chi2 = solution.squares;
    return (solution.information_root * solution.shared).norm();
  }

  /// 0 = second - between first - (change of z).
  struct LinkEquation {
    Matrix2d whitener;
    Vector2d left_m;
    Vector2d by_from;
    Vector2d by_to;
    Matrix2d by_matrix;
    Vector2d by_clock;
  };

  bool is_usable(std::size_t i) const {
    return is_sound_[i] && first_[i].is_known && second_[i].is_known && earlier_[i].is_known &&
           later_[i].is_known;
  }

  void set_clock(double offset_s) {
    constexpr double kSame_s = 1e-9;  // stamps are not finer
    if (std::abs(offset_s - clock_s_) < kSame_s) return;
    clock_s_ = offset_s;
    const double all_s = second_sensor_.clock_offset_s + offset_s;
    second_ = link_track(stamps_, second_sensor_.track, all_s);
    earlier_ = link_track(stamps_, second_sensor_.track, all_s - kClockDelta_s);
    later_ = link_track(stamps_, second_sensor_.track, all_s + kClockDelta_s);
  }

  Start start() const {
    std::vector<RigidRow> rows;
    Vector2d first_m = Vector2d::Zero();
    Vector2d second_m = Vector2d::Zero();
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      const bool is_linked = i > 0 && is_usable(i - 1);
      if (is_linked) {
        const double from_rad = poses_[i - 1].yaw_rad;
        const double turn_rad = turn_between(from_rad, poses_[i].yaw_rad);
        first_m += ground_travel(first_[i - 1], from_rad, turn_rad).d_m;
        second_m += ground_travel(second_[i - 1], from_rad, turn_rad).d_m;
      }
      rows.push_back({.begins_chain = !is_linked,
                      .yaw_rad = poses_[i].yaw_rad,
                      .path_m = first_m,
                      .target_m = second_m});
    }
    std::optional<Vector2d> known_m;
    if (lever_) known_m = lever_->c_m;
    const RigidStart found = rigid_start(rows, known_m);
    Start out;
    out.state.q << found.a, found.b, found.c_m, start_clock_s_;
    const Vector2d along = found.c_m.normalized();
    std::vector<double> strains_m;
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      const Matrix2d turn = rotation(poses_[i].yaw_rad);
      const Vector2d z_m = turn * found.c_m;
      out.state.nodes.emplace_back(z_m.x(), z_m.y(), poses_[i].yaw_rad);
      strains_m.push_back(std::abs(found.residuals_m[i].dot(turn * along)));
    }
    out.strain_m = sigma_of_nine_tenths(std::move(strains_m));
    return out;
  }

  LinkEquation equation(const State& state, std::size_t i) const {
    const double from_rad = state.yaw_rad(i);
    const double turn_rad = turn_between(from_rad, state.yaw_rad(i + 1));
    const GroundTravel first = ground_travel(first_[i], from_rad, turn_rad);
    const GroundTravel second = ground_travel(second_[i], from_rad, turn_rad);
    const Matrix2d m = between(state.q);
    LinkEquation out;
    out.left_m =
        second.d_m - m * first.d_m - (state.nodes[i + 1].head<2>() - state.nodes[i].head<2>());
    out.by_from = second.by_from - m * first.by_from;
    out.by_to = second.by_to - m * first.by_to;
    out.by_matrix << -first.d_m, -left_of(first.d_m);
    out.by_clock = (ground_travel(later_[i], from_rad, turn_rad).d_m -
                    ground_travel(earlier_[i], from_rad, turn_rad).d_m) /
                   (2.0 * kClockDelta_s);
    const Matrix2d covariance = travel_covariance(second_[i], from_rad) +
                                m * travel_covariance(first_[i], from_rad) * m.transpose() +
                                kLinkFloor_m * kLinkFloor_m * Matrix2d::Identity();
    out.whitener = Eigen::LLT<Matrix2d>(covariance).matrixL().solve(Matrix2d::Identity().eval());
    return out;
  }

  double strain_along_m(const State& state) const {
    const Vector2d along = state.q.segment<2>(2).normalized();
    std::vector<double> strains_m;
    for (std::size_t i = 0; i < poses_.size(); ++i)
      strains_m.push_back(std::abs(state.strain_m(i).dot(rotation(state.yaw_rad(i)) * along)));
    return sigma_of_nine_tenths(std::move(strains_m));
  }

  Chain::Solution solve_linear(const State& state) const {
    Chain chain(poses_.size());
    Chain::Equation clock;
    clock.shared(kClock) = 1.0 / kClockSigma_s;
    clock.right = -state.q(kClock) / kClockSigma_s;
    chain.add(clock);
    for (int axis = 0; lever_ && axis < 2; ++axis) {
      Chain::Equation e;
      e.shared(2 + axis) = 1.0 / lever_->sigma_m;
      e.right = (lever_->c_m(axis) - state.q(2 + axis)) / lever_->sigma_m;
      chain.add(e);
    }
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      add_pose(state, i, chain);
      if (i < first_.size() && is_usable(i)) add_link(state, i, chain);
      chain.next_node();
    }
    return chain.solve();
  }

  void add_pose(const State& state, std::size_t i, Chain& chain) const {
    Chain::Equation heading;
    heading.node(2) = 1.0 / poses_[i].sigma_yaw_rad;
    heading.right = turn_between(state.yaw_rad(i), poses_[i].yaw_rad) / poses_[i].sigma_yaw_rad;
    chain.add(heading);
    const Matrix2d turn = rotation(state.yaw_rad(i));
    const Vector2d by_heading = -left_of(turn * state.q.segment<2>(2));
    const Vector2d strain_m = state.strain_m(i);
    for (int axis = 0; axis < 2; ++axis) {
      Chain::Equation e;
      e.node(axis) = 1.0 / rig_sigma_m_;
      e.node(2) = by_heading(axis) / rig_sigma_m_;
      e.shared.segment<2>(2) = -turn.row(axis).transpose() / rig_sigma_m_;
      e.right = strain_m(axis) / rig_sigma_m_;
      chain.add(e);
    }
  }

  void add_link(const State& state, std::size_t i, Chain& chain) const {
    const LinkEquation link = equation(state, i);
    for (int row = 0; row < 2; ++row) {
      const auto w = link.whitener.row(row);
      Chain::Equation e;
      e.node << w(0), w(1), w.dot(link.by_from);
      e.next << -w(0), -w(1), w.dot(link.by_to);
      e.shared.head<2>() = (w * link.by_matrix).transpose();
      e.shared(kClock) = w.dot(link.by_clock);
      e.right = -w.dot(link.left_m);
      chain.add(e);
    }
  }

  BodyReference poses_;
  std::vector<Stamp> stamps_;
  double start_clock_s_;
  double clock_s_ = std::numeric_limits<double>::infinity();  // of the links below
  std::optional<Lever> lever_;
  const PairSensor& second_sensor_;
  std::vector<TrackLink> first_;
  std::vector<TrackLink> second_;  // and at clock offsets a little smaller and larger
  std::vector<TrackLink> earlier_;
  std::vector<TrackLink> later_;
  std::vector<bool> is_sound_;  // links that may be used where both tracks know them
  double rig_sigma_m_ = kRigFloor_m;
};

/// Poses that both tracks place, without those whose heading jumps.
BodyReference common_poses(const BodyReference& reference, const PairSensor& first,
                           const PairSensor& second) {
  const std::vector<std::size_t> a = placed_poses(reference, first.track, first.clock_offset_s);
  const std::vector<std::size_t> b = placed_poses(reference, second.track, second.clock_offset_s);
  std::vector<std::size_t> both;
  std::ranges::set_intersection(a, b, std::back_inserter(both));
  const std::vector<bool> jumps = heading_jumps(reference);
  BodyReference out;
  for (const std::size_t i : both) {
    if (!jumps[i]) out.push_back(reference[i]);
  }
  return out;
}

std::optional<Lever> lever_of(const Mount& first, const Mount& second, Baseline baseline) {
  if (baseline == Baseline::from_motion) return std::nullopt;
  const Vector2d apart_m(second.x_m - first.x_m, second.y_m - first.y_m);
  const double ends_m = std::max(std::hypot(first.sigma_x_m, second.sigma_x_m),
                                 std::hypot(first.sigma_y_m, second.sigma_y_m));
  return Lever{.c_m = rotation(-second.yaw_rad) * apart_m,
               .sigma_m = std::hypot(ends_m, apart_m.norm() * second.sigma_yaw_rad)};
}

Result<void> check_motion(const PairProblem& problem, Baseline baseline) {
  if (problem.poses().size() < kFewestPoses || problem.usable_links() < kFewestPoses)
    return bad_pair("the two tracks and the reference have too little time in common");
  double heading_rad = 0.0;
  std::vector<double> headings_rad, sigmas_rad;
  for (std::size_t i = 0; i < problem.poses().size(); ++i) {
    const ReferencePose& pose = problem.poses()[i];
    if (i > 0) heading_rad += turn_between(problem.poses()[i - 1].yaw_rad, pose.yaw_rad);
    headings_rad.push_back(heading_rad);
    sigmas_rad.push_back(pose.sigma_yaw_rad);
  }
  if (baseline == Baseline::from_motion &&
      spread(headings_rad) < kLeastSpread_sigmas * median(sigmas_rad))
    return bad_pair("the body hardly turned: the ratio of the scales needs the lever arms");
  return {};
}

ScaleRatio result_of(const PairProblem& problem, const Minimum& minimum) {
  const Chain::Shared& q = minimum.state.q;
  ScaleRatio out;
  out.ratio = std::hypot(q(0), q(1));
  out.yaw_rad = std::atan2(-q(1), q(0));
  out.travel_m = problem.travel_m();
  out.rig_sigma_m = problem.rig_sigma_m();
  out.clock_offset_s = q(kClock);
  out.chi2 = minimum.chi2;
  out.dof = 2 * static_cast<int>(problem.usable_links()) + problem.priors() -
            static_cast<int>(Chain::Shared::SizeAtCompileTime);
  const double squares = out.chi2 / out.dof;
  if (squares > 1.0 + kMaxChi2Sigmas * std::sqrt(2.0 / out.dof))
    out.sigma_factor = std::sqrt(squares);
  const Chain::SharedMatrix inverse = minimum.information_root.triangularView<Eigen::Upper>().solve(
      Chain::SharedMatrix::Identity());
  const Chain::SharedMatrix all = inverse * inverse.transpose();
  const Matrix2d cov = all.topLeftCorner<2, 2>();
  const Vector2d along = q.head<2>() / out.ratio;
  const Vector2d across = left_of(along) / out.ratio;
  out.sigma_clock_offset_s = out.sigma_factor * std::sqrt(all(kClock, kClock));
  out.sigma_ratio = out.sigma_factor * std::sqrt(along.dot(cov * along));
  out.sigma_yaw_rad = out.sigma_factor * std::sqrt(across.dot(cov * across));
  return out;
}

}  // namespace

Result<ScaleRatio> fit_scale_ratio(const BodyReference& reference, const PairSensor& first,
                                   const PairSensor& second, Baseline baseline) {
  const std::optional<Lever> lever = lever_of(first.mount, second.mount, baseline);
  BodyReference poses = common_poses(reference, first, second);
  const std::size_t all = poses.size();
  double clock_offset_s = 0.0;
  for (int pass = 0; pass < kMostPasses; ++pass) {
    PairProblem problem(poses, first, second, lever, clock_offset_s);
    if (Result<void> moves = check_motion(problem, baseline); !moves) return moves.error();
    const std::size_t links = problem.usable_links();
    // Before the clocks agree, every change of speed would look like a wrong shift.
    for (int again = 0; pass > 0 && again < kMostPasses && problem.screen_links(); ++again) {
    }
    const Result<Minimum> minimum = problem.minimise();
    if (!minimum) return minimum.error();
    const std::vector<double> headings = problem.heading_residuals(minimum.value().state);
    const double limit = outlier_limit_sigmas(headings);
    BodyReference kept;
    for (std::size_t i = 0; i < poses.size(); ++i) {
      if (headings[i] <= limit) kept.push_back(poses[i]);
    }
    const double clock_change_s = minimum.value().state.q(kClock) - clock_offset_s;
    clock_offset_s += clock_change_s;
    const bool is_clean = std::abs(clock_change_s) <= kClocksAgree_s &&
                          kept.size() == poses.size() && (pass > 0 || !problem.screen_links());
    if (!is_clean) {
      // What the first pass says of headings is not to be trusted yet.
      if (pass > 0) poses = std::move(kept);
      continue;
    }
    const std::size_t left_out = all - kept.size() + links - problem.usable_links();
    if (static_cast<double>(left_out) > kMostOutliers_ratio * static_cast<double>(all)) break;
    ScaleRatio out = result_of(problem, minimum.value());
    out.outliers = left_out;
    return out;
  }
  return bad_pair(
      "the two tracks contradict each other or the headings in more than a tenth of the drive");
}

double false_yaw_rad_per_m(double ratio, const Mount& first, const Mount& second) {
  const double x_m = second.x_m - first.x_m;
  const double y_m = second.y_m - first.y_m;
  return -(ratio - 1.0) * y_m / (x_m * x_m + y_m * y_m);
}

Calibration with_reading_divided(const Calibration& calibration, double ratio) {
  Calibration out = calibration;
  out.sc_x_ratio *= ratio;
  out.sc_y_ratio *= ratio;
  return out;
}

}  // namespace lsv
