// SPDX-License-Identifier: BSD-3-Clause
// One fault of the campaign: how it gets into the frames, which alarms must tell it, and what must
// hold all the same. The list of them is the campaign.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "lsv/core/config.h"
#include "lsv/stream/stream_options.h"
#include "tools/faults/checker.h"
#include "tools/faults/footage.h"
#include "tools/faults/virtual_camera.h"

namespace lsv::faults {

/// The deliveries of a run while a fault is worked into them.
class Script {
 public:
  Script(const Footage& footage, std::uint64_t seed);

  std::int64_t exposures() const { return footage.exposures(); }
  /// When the frame of an exposure arrives if nothing is wrong.
  static std::int64_t arrival_ns(std::int64_t exposure);
  /// By the camera's own clock.
  static std::int64_t stamp_ns(std::int64_t exposure);
  /// In [0, below).
  std::int64_t random(std::int64_t below) {
    return static_cast<std::int64_t>(random_bits() % static_cast<std::uint64_t>(below));
  }
  bool chance(double probability);

  /// The frame of an exposure does not arrive; or is another than it should be.
  void lose(std::int64_t exposure);
  void mark(std::int64_t exposure) { faulty[static_cast<std::size_t>(exposure)] = true; }
  /// Another than it should be, by less than matters: it need not be told, and must do no harm.
  void mark_harmless(std::int64_t exposure) {
    mark(exposure);
    harmless_[static_cast<std::size_t>(exposure)] = true;
  }
  Delivery& at(std::int64_t exposure) { return deliveries[static_cast<std::size_t>(exposure)]; }

  /// What is lost is taken out, the rest put in order of arrival.
  void close();

  const Footage& footage;
  std::mt19937_64 random_bits;
  LiveSourceInfo info;
  std::vector<Delivery> deliveries;  // by exposure until close(); extra ones behind
  std::vector<bool> faulty;          // by exposure
  std::vector<Episode> episodes;     // made by close() of what is faulty
  std::int64_t missing = 0;          // exposures that will never arrive in their turn
  std::int64_t bad_stamps = 0;
  std::map<FrameRejection, std::int64_t> rejected;

 private:
  std::vector<bool> lost_;
  std::vector<bool> harmless_;
};

/// What must hold beyond the invariants, which always must.
struct Limits {
  double detected_ratio = 1.0;  // of the episodes, at least
  double latency_frames = 5.0;  // at most
  double recovery_frames = 20.0;
  double good_measured_ratio = 1.0;               // of the frames without a fault, at least
  std::optional<double> faulty_accepted_ratio{};  // of the frames with one, at most
  std::optional<double> end_error_ratio{};        // of the distance, at most
  std::optional<double> queue_age_s{};
  bool may_drop = false;        // the queue
  bool exact_stamps = true;     // as many stamps replaced as were spoilt
  bool quiet_otherwise = true;  // no alarm without a fault
  bool coverage = false;        // 68 +- 5 % of the errors within 1 sigma, 95 +- 3 % within 1.96
};

struct Scenario {
  std::string id;
  std::string fault;
  Scene scene = Scene::drive;
  unsigned alarms = 0;  // that tell it; 0: it must do no harm
  std::function<void(Script&)> inject{};
  Limits limits{};
  /// Another script that must give the same positions to the bit.
  std::function<void(Script&)> same_as{};
  StreamOptions stream{};
  int work_every = 1;  // frames taken in for one that is measured; 1: the worker keeps up
};

std::vector<Scenario> frame_scenarios();
std::vector<Scenario> time_scenarios();
std::vector<Scenario> resource_scenarios();

}  // namespace lsv::faults
