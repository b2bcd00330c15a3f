// SPDX-License-Identifier: BSD-3-Clause
// Holds what a stream says against the truth, and notes every alarm: the invariants of the fault
// campaign.
//   I1 books balance            I2 nothing wrong is called valid     I3 outputs are finite
//   I4 how soon a fault is told I5 how soon it is over               I6 nothing is told without one
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "calibration/scale.h"
#include "lsv/core/health_snapshot.h"
#include "lsv/stream/stream_sink.h"
#include "tools/faults/footage.h"
#include "tools/faults/virtual_camera.h"

namespace lsv::faults {

/// What a stream can say when something is amiss; a set of them in a mask.
enum Alarm : unsigned {
  kMissing = 1,   // exposures never arrived
  kRejected = 2,  // a frame was not given to the odometer
  kDropped = 4,   // by the queue
  kStamp = 8,     // a stamp was replaced
  kRefused = 16,  // no shift to this frame
  kSegment = 32,  // the ground was lost
  kLost = 64,     // the source is silent
  kLight = 128,   // no shift, and the light is to blame
};

/// Between these two instants of the virtual clock something is wrong.
struct Episode {
  std::int64_t begin_ns = 0;
  std::int64_t end_ns = 0;
  bool must_be_told = true;  // otherwise it may be, and must do no harm
};

/// What one run of a stream amounted to.
struct Findings {
  std::int64_t exposures = 0;
  std::int64_t good_frames = 0;      // delivered, outside of episodes
  std::int64_t good_measured = 0;    // of these, with a shift
  std::int64_t faulty_frames = 0;    // measured within an episode
  std::int64_t faulty_accepted = 0;  // of these, with a shift called valid
  std::int64_t accepted = 0;         // shifts called valid
  std::int64_t silent_errors = 0;    // I2: valid, yet wrong by more than 5 sigma and 0.05 px
  std::int64_t lies = 0;             // I2 of the position: the same, while the ground was not lost
  std::int64_t unsound = 0;          // I1, I3
  std::int64_t false_alarms = 0;     // I6
  double largest_error_px = 0.0;     // of a valid shift
  double largest_error_sigmas = 0.0;
  double end_error_ratio = kUnknown;  // of the distance; unknown when the ground was lost
  std::int64_t segments = 0;          // times that the ground was lost
  std::int64_t episodes = 0;
  std::vector<double> latencies_frames;   // I4, of the episodes that were told
  std::vector<double> recoveries_frames;  // I5
  std::int64_t axes = 0, axes_in_1_sigma = 0, axes_in_196_sigma = 0;  // coverage
  HealthSnapshot health{};
  std::vector<SensorPosition> path;  // after every report
};

class Checker : public StreamSink {
 public:
  /// All must live as long as the checker. `episodes` in order, none overlaps the next. `alarms`:
  /// those that tell the fault.
  Checker(const Footage& footage, const std::vector<Delivery>& deliveries,
          const std::vector<Episode>& episodes, unsigned alarms, const VirtualClock& clock);

  void on_report(const StreamReport& report, Frame& frame) override;
  void on_event(const StreamEvent& event) override;
  void on_health(const HealthSnapshot&) override {}

  /// After every frame that was grabbed.
  void on_books(const HealthSnapshot& health);

  Findings finish(const HealthSnapshot& health);

 private:
  struct Told {
    std::int64_t at_ns;
    unsigned alarm;
  };
  struct Known {
    std::int64_t stamp_ns;
    std::int64_t exposure;
  };

  void tell(Alarm alarm);
  void check_shift(const StepReport& step, std::int64_t exposure);
  void check_position(const StepReport& step, std::int64_t exposure);
  void check_sound(const StepReport& step);
  bool is_excused(std::int64_t at_ns) const;
  const Episode* episode_before(std::int64_t at_ns) const;
  void judge_episodes();

  const Footage& footage_;
  const std::vector<Episode>& episodes_;
  const unsigned alarms_;
  const VirtualClock& clock_;
  const PixelScale scale_;
  std::map<std::int64_t, std::int64_t> exposure_by_arrival_;
  std::vector<Known> measured_;
  std::vector<Told> told_;
  std::vector<std::int64_t> accepted_ns_;
  HealthSnapshot last_books_{};
  std::int64_t last_segment_ = 0;
  std::int64_t first_exposure_ = -1;
  SensorPosition last_position_{};
  double end_error_px_ = 0.0;
  Findings findings_;
};

}  // namespace lsv::faults
