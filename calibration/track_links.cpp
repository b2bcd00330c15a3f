// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/track_links.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace lsv {
namespace {

// Poses further apart than so many times the usual are a gap of the reference.
constexpr std::int64_t kLongestGap = 5;

std::int64_t usual_interval_ns(const std::vector<Stamp>& stamps) {
  std::vector<std::int64_t> intervals_ns;
  for (std::size_t i = 1; i < stamps.size(); ++i)
    intervals_ns.push_back(stamps[i].ns - stamps[i - 1].ns);
  const auto middle = intervals_ns.begin() + static_cast<std::ptrdiff_t>(intervals_ns.size() / 2);
  std::nth_element(intervals_ns.begin(), middle, intervals_ns.end());
  return *middle;
}

std::int64_t offset_ns(double clock_offset_s) {
  return std::llround(clock_offset_s * static_cast<double>(kNsPerS));
}

/// The part of a step that lies between two times.
void add_part(const TrackStep& step, std::int64_t begin_ns, std::int64_t end_ns,
              std::int64_t from_ns, std::int64_t to_ns, TrackLink& link) {
  const double part =
      static_cast<double>(end_ns - begin_ns) / static_cast<double>(step.end.ns - step.begin.ns);
  const double span_ns = static_cast<double>(to_ns - from_ns);
  const double f =
      (static_cast<double>(begin_ns - from_ns) + static_cast<double>(end_ns - from_ns)) /
      (2.0 * span_ns);
  double weight = part;
  for (auto& moment_m : link.moments_m) {
    moment_m[0] += weight * step.dx_m;
    moment_m[1] += weight * step.dy_m;
    weight *= f;
  }
  link.xx_m2 += part * step.xx_m2;
  link.xy_m2 += part * step.xy_m2;
  link.yy_m2 += part * step.yy_m2;
}

}  // namespace

std::vector<std::size_t> placed_poses(const BodyReference& reference, const SensorTrack& track,
                                      double clock_offset_s) {
  const std::int64_t shift_ns = offset_ns(clock_offset_s);
  std::vector<std::size_t> out;
  auto step = track.begin();
  for (std::size_t i = 0; i < reference.size(); ++i) {
    const std::int64_t time_ns = reference[i].stamp.ns - shift_ns;
    while (step != track.end() && step->end.ns < time_ns) ++step;
    if (step == track.end()) break;
    if (step->begin.ns > time_ns) continue;
    if (step->spans_refused && step->begin.ns < time_ns && time_ns < step->end.ns) continue;
    out.push_back(i);
  }
  return out;
}

std::vector<TrackLink> link_track(const std::vector<Stamp>& stamps, const SensorTrack& track,
                                  double clock_offset_s) {
  const std::int64_t shift_ns = offset_ns(clock_offset_s);
  if (stamps.size() < 2) return {};
  std::vector<TrackLink> out(stamps.size() - 1);
  const std::int64_t longest_ns = kLongestGap * usual_interval_ns(stamps);
  auto first = track.begin();
  for (std::size_t i = 0; i < out.size(); ++i) {
    const std::int64_t from_ns = stamps[i].ns - shift_ns;
    const std::int64_t to_ns = stamps[i + 1].ns - shift_ns;
    while (first != track.end() && first->end.ns <= from_ns) ++first;
    std::int64_t covered_ns = 0;
    for (auto step = first; step != track.end() && step->begin.ns < to_ns; ++step) {
      const std::int64_t begin_ns = std::max(step->begin.ns, from_ns);
      const std::int64_t end_ns = std::min(step->end.ns, to_ns);
      add_part(*step, begin_ns, end_ns, from_ns, to_ns, out[i]);
      covered_ns += end_ns - begin_ns;
    }
    out[i].is_known = covered_ns == to_ns - from_ns && covered_ns <= longest_ns;
  }
  return out;
}

}  // namespace lsv
