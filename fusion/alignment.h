// SPDX-License-Identifier: BSD-3-Clause
// The transform that brings an estimate to the truth before errors are taken,
//   p' = scale R p + t,   q' = R q.
// none: R = 1, t = 0. origin: the first poses coincide. se2: turn about z and shift in x and y.
// se3, sim3: any rotation and shift, sim3 with a scale; least squares over the positions of all
// pairs in closed form (Umeyama, PAMI 13(4), 1991, eqs 34 to 43). Where positions leave a turn
// open, the smallest turn that fits is taken. Pure functions.
#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "fusion/association.h"
#include "lsv/core/trajectory.h"

namespace lsv {

enum class AlignmentKind { none, origin, se2, se3, sim3 };
inline constexpr std::array kAllAlignmentKinds = {AlignmentKind::none, AlignmentKind::origin,
                                                  AlignmentKind::se2, AlignmentKind::se3,
                                                  AlignmentKind::sim3};
std::string_view word(AlignmentKind kind);
std::optional<AlignmentKind> alignment_kind(std::string_view word);

/// What the poses say of the turn.
enum class AlignmentStatus {
  determined,
  free_about_line,  // positions on one line: the turn about it is not known
  free_turn,        // positions in one place, or without relation: R = 1, scale = 1
};
std::string_view word(AlignmentStatus status);

struct Alignment {
  AlignmentKind kind = AlignmentKind::none;
  AlignmentStatus status = AlignmentStatus::determined;
  Quaternion rotation{.x = 0.0, .y = 0.0, .z = 0.0, .w = 1.0};
  std::array<double, 3> translation_m{};
  double scale = 1.0;  // > 0
};

/// Never worse than no alignment, except `origin`. Every number is finite.
Alignment align(const PosePairs& pairs, AlignmentKind kind);

TrajectoryPose aligned(const Alignment& alignment, const TrajectoryPose& pose);
/// The other way: a pose of the truth in the frame of the estimate.
TrajectoryPose unaligned(const Alignment& alignment, const TrajectoryPose& pose);

/// Rows of R.
std::array<std::array<double, 3>, 3> rotation_matrix(const Quaternion& rotation);

}  // namespace lsv
