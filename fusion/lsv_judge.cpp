// SPDX-License-Identifier: BSD-3-Clause
#include "fusion/lsv_judge.h"

#include <algorithm>
#include <limits>
#include <optional>

namespace lsv::fusion {
namespace {

using Which = std::array<bool, kMaxLsvSensors>;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Of a time: asked again and again for all but one of the sensors.
class Bench {
 public:
  Bench(const LsvReadings& readings, const LsvMounts& mounts, const GateLimits& limits,
        const Eigen::Vector3d& motion, const Eigen::Matrix3d& covariance)
      : readings_(readings),
        mounts_(mounts),
        limits_(limits),
        motion_(motion),
        covariance_(covariance) {}

  bool agree(const Which& which) const {
    const std::optional<double> ratio = contradiction(which);
    return !ratio || *ratio <= 1.0;
  }
  /// Against the prediction: chi-square over its limit.
  double misfit(const Which& which) const {
    const LsvStack stack = stack_of(readings_, mounts_, which);
    return innovation_chi2(stack, motion_, covariance_) / limit(stack.rows);
  }
  /// The sensor without which the others agree and fit the prediction best, if they do.
  std::optional<std::size_t> odd_one(const Which& which) const {
    return best_without(which,
                        [&](const Which& rest) { return agree(rest) ? misfit(rest) : kInfinity; });
  }
  /// The sensor without which the others agree best, whatever was predicted.
  std::optional<std::size_t> disagreeing_one(const Which& which) const {
    return best_without(which,
                        [&](const Which& rest) { return contradiction(rest).value_or(kInfinity); });
  }

 private:
  /// Against each other: chi-square over its limit; nothing where they have no figure to spare.
  std::optional<double> contradiction(const Which& which) const {
    const Parity p = parity(stack_of(readings_, mounts_, which));
    return p.dof > 0 ? std::optional(p.chi2 / limit(p.dof)) : std::nullopt;
  }
  /// The sensor whose absence leaves the least, if that is within the limit, 1.
  template <typename Ratio>
  static std::optional<std::size_t> best_without(const Which& which, Ratio ratio) {
    if (std::count(which.begin(), which.end(), true) < 2) return std::nullopt;
    std::optional<std::size_t> best;
    double least = 1.0;
    for (std::size_t i = 0; i < which.size(); ++i) {
      if (!which[i]) continue;
      Which rest = which;
      rest[i] = false;
      if (const double of_rest = ratio(rest); of_rest <= least) {
        least = of_rest;
        best = i;
      }
    }
    return best;
  }
  double limit(int dof) const { return limits_[static_cast<std::size_t>(dof)]; }

  const LsvReadings& readings_;
  const LsvMounts& mounts_;
  const GateLimits& limits_;
  const Eigen::Vector3d& motion_;
  const Eigen::Matrix3d& covariance_;
};

}  // namespace

LsvStack stack_of(const LsvReadings& readings, const LsvMounts& mounts, const Which& which) {
  LsvStack stack;
  for (std::size_t i = 0; i < readings.size(); ++i) {
    if (which[i]) stack.add(mounts[i], readings[i].v_m_s, readings[i].variance_m2_s2);
  }
  return stack;
}

LsvJudgement judge(const LsvReadings& readings, const LsvMounts& mounts, const GateLimits& limits,
                   const Eigen::Vector3d& motion, const Eigen::Matrix3d& covariance,
                   bool was_odd_in_agreement) {
  LsvJudgement out;
  Which which{};
  for (std::size_t i = 0; i < readings.size(); ++i) which[i] = readings[i].is_there;
  const auto count = std::count(which.begin(), which.end(), true);
  if (count == 0) return out;
  const auto all_are = [&](LsvVerdict verdict) {
    for (std::size_t i = 0; i < readings.size(); ++i) {
      if (which[i]) out.verdict[i] = verdict;
    }
    out.is_any_believed = verdict == LsvVerdict::believed;
  };
  const Bench bench(readings, mounts, limits, motion, covariance);

  const bool agree = bench.agree(which);
  if (agree && bench.misfit(which) <= 1.0) {
    all_are(LsvVerdict::believed);
    return out;
  }
  const LsvVerdict refusal =
      agree ? LsvVerdict::refused_by_innovation : LsvVerdict::refused_by_parity;
  const auto odd = agree && was_odd_in_agreement ? std::nullopt : bench.odd_one(which);
  if (odd) {
    all_are(LsvVerdict::believed);
    out.is_odd_in_agreement = agree;
    out.verdict[*odd] = refusal;
    return out;
  }
  if (agree && count > 1) {
    all_are(LsvVerdict::believed);
    out.is_jump = true;
    return out;
  }
  if (const auto alone = agree ? std::nullopt : bench.disagreeing_one(which)) {
    all_are(LsvVerdict::believed);
    out.verdict[*alone] = LsvVerdict::refused_by_parity;
    out.is_jump = true;
    return out;
  }
  all_are(refusal);
  return out;
}

}  // namespace lsv::fusion
