// SPDX-License-Identifier: BSD-3-Clause
// The judge at the door: which grabbed frame may be measured, which exposure it is, and when that
// was. It stands before the queue, so that what the queue drops and what never arrived are told
// apart.
//
//   id -> steps since the newest frame (frame_ids.h)    seen before: duplicate; older: late
//   camera's stamp -> exposures since then, time        by the stamps: ids can be contiguous
//                                                       although exposures were lost
//
// A stamp is believed when it agrees with the id, or when the time of arrival says that the id is
// wrong; a frame cannot have been exposed after it arrived. Otherwise it is replaced: id x period
// from the last stamp that was good. Where the camera's clock goes on from elsewhere (it was set,
// it wrapped), the stamps handed out go on without a step. They always increase.
// No wall clock is used. A pure value, no threads, allocates nothing.
#pragma once

#include <cstdint>
#include <optional>

#include "lsv/core/frame.h"
#include "lsv/core/health_snapshot.h"
#include "lsv/stream/frame_ids.h"
#include "lsv/stream/live_source.h"

namespace lsv {

struct Admission {
  FrameRejection rejection = FrameRejection::none;
  /// Exposures between this frame and the newest one before it that have not arrived. Of a damaged
  /// frame too, when its label can be believed: it did arrive.
  std::int64_t missing_before = 0;
  bool stamp_replaced = false;
};

class Intake {
 public:
  /// `info.period_ns` > 0. Frames must have `info.format`.
  explicit Intake(const LiveSourceInfo& info);

  /// `frame` gets its index and stamp when it is not rejected.
  Admission judge(Frame& frame, const FrameLabel& label);

  /// The camera was opened anew: ids and clock begin again, and the next frame is placed by its
  /// time of arrival. The format remains the one of the start.
  void restart(const LiveSourceInfo& info);

 private:
  /// On the time line of the stream.
  struct Place {
    std::int64_t index = 0;
    std::int64_t stamp_ns = 0;
    std::int64_t arrival_ns = 0;
  };
  struct GoodStamp {
    std::int64_t camera_ns = 0;  // unwrapped
    std::int64_t index = 0;
  };
  struct Judged {
    std::int64_t exposures = 1;  // since the newest frame
    std::int64_t stamp_ns = 0;
    bool good = false;     // the stamp is the camera's own
    bool agrees = false;   // ... and the id says the same
    bool anchors = false;  // the camera's clock is continued from here
    bool by_time = false;  // the id is not to be believed
  };

  void forget_clock();
  std::optional<std::int64_t> camera_time(const FrameLabel& label) const;
  Judged first(const std::optional<std::int64_t>& camera_ns, const FrameLabel& label) const;
  Judged by_arrival(const std::optional<std::int64_t>& camera_ns, const FrameLabel& label) const;
  std::optional<Judged> by_time_alone(std::int64_t camera_ns, const FrameLabel& label) const;
  Judged by_step(std::int64_t step, const std::optional<std::int64_t>& camera_ns,
                 const FrameLabel& label) const;
  std::int64_t shortest_way_ns() const;
  bool time_is_right(std::int64_t step, std::int64_t exposures, std::int64_t camera_ns,
                     const FrameLabel& label) const;
  bool clock_goes_on(std::int64_t step, std::int64_t camera_ns) const;
  bool was_restarted(std::int64_t step, const FrameLabel& label);
  void place(const Judged& judged, std::int64_t step, const std::optional<std::int64_t>& camera_ns,
             const FrameLabel& label);
  void measure_period(std::int64_t camera_ns);
  std::int64_t periods_ns(std::int64_t exposures) const;

  FrameFormat format_;
  FrameIds ids_;
  std::int64_t nominal_period_ns_;
  double period_ns_;  // as measured, near the nominal one
  std::int64_t clock_wraps_ns_;

  bool has_newest_ = false;
  Place newest_;
  bool restarting_ = false;
  std::optional<GoodStamp> good_;         // the last
  std::optional<GoodStamp> period_base_;  // where measuring the period begins
  GoodStamp next_period_base_;
  std::int64_t offset_ns_ = 0;                  // stamp handed out - camera's clock
  std::int64_t earliest_ns_ = 0;                // least arrival - camera's clock, lately
  int ways_ = 0;                                // of which that is the least, to kWaysThatTell
  std::optional<std::int64_t> last_camera_ns_;  // of the newest frame, good or not
  int strays_ = 0;    // replaced stamps in a row that follow each other well
  int late_run_ = 0;  // late frames in a row that follow each other
  std::int64_t last_late_step_ = 0;
};

}  // namespace lsv
