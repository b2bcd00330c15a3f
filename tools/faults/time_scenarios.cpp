// SPDX-License-Identifier: BSD-3-Clause
// Faults of time and counters: T1 to T4.
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "tools/faults/scenario.h"

namespace lsv::faults {
namespace {

constexpr double kAsGoodAsClean = 0.001;

std::optional<std::int64_t> nonsense(Script& script, std::int64_t good_ns) {
  switch (script.random(8)) {
    case 0:
      return std::nullopt;
    case 1:
      return 0;
    case 2:
      return -good_ns;
    case 3:
      return good_ns - kPeriod_ns;  // that of the frame before
    case 4:
      return good_ns - 40 * kPeriod_ns;
    case 5:
      return good_ns + 3600 * kNsPerS;
    case 6:
      return std::numeric_limits<std::int64_t>::max();
    default:
      return std::numeric_limits<std::int64_t>::min();
  }
}

void spoil_stamps(Script& script) {
  for (std::int64_t k = 1; k + 1 < script.exposures(); ++k) {
    if (!script.chance(0.05)) continue;
    FrameLabel& label = script.at(k).label;
    label.camera_ns = nonsense(script, *label.camera_ns);
    script.mark(k);
    ++script.bad_stamps;
  }
}

/// 2 s at most, and half of the footage.
void suspend(Script& script) {
  const std::int64_t length = std::min<std::int64_t>(2000, script.exposures() / 2);
  const std::int64_t from = script.exposures() / 4;
  for (std::int64_t k = from; k < from + length; ++k) script.lose(k);
}

Scenario pace(std::string id, std::string fault, double rate_error, std::int64_t jitter_ns) {
  return {.id = "T3 " + std::move(id),
          .fault = std::move(fault),
          .inject =
              [=](Script& script) {
                for (std::int64_t k = 0; k < script.exposures(); ++k) {
                  FrameLabel& label = script.at(k).label;
                  const auto drift_ns =
                      std::llround(rate_error * static_cast<double>(k * kPeriod_ns));
                  const std::int64_t off_ns =
                      jitter_ns == 0 ? 0 : script.random(2 * jitter_ns + 1) - jitter_ns;
                  label.camera_ns = *label.camera_ns + drift_ns + off_ns;
                  label.arrival_ns += drift_ns + jitter_ns;
                }
              },
          .limits = {.end_error_ratio = kAsGoodAsClean}};
}

/// The counter ends half-way through the run.
Scenario id_wrap(const std::string& id, int bits, bool skips_zero) {
  return {.id = "T4 " + id,
          .fault = "frame ids wrap at " + std::to_string(bits) + " bit" +
                   (skips_zero ? " and skip 0" : ""),
          .inject =
              [=](Script& script) {
                script.info.id_bits = bits;
                script.info.id_skips_zero = skips_zero;
                const std::uint64_t turn = (std::uint64_t{1} << bits) - (skips_zero ? 1 : 0);
                const std::uint64_t begin =
                    turn - static_cast<std::uint64_t>(script.exposures() / 2);
                for (Delivery& delivery : script.deliveries)
                  delivery.label.camera_id =
                      (begin + delivery.label.camera_id) % turn + (skips_zero ? 1 : 0);
              },
          .same_as = [](Script&) {}};
}

Scenario clock_wrap(std::string id, std::string fault, std::int64_t unit_ns) {
  return {.id = "T4 " + std::move(id),
          .fault = std::move(fault),
          .inject =
              [=](Script& script) {
                script.info.clock_wraps_ns = (std::int64_t{1} << 32) * unit_ns;
                // Between two frames, because 0 is no stamp.
                const std::int64_t begin_ns = script.info.clock_wraps_ns -
                                              script.exposures() / 2 * kPeriod_ns -
                                              *script.at(0).label.camera_ns + kPeriod_ns / 2;
                for (Delivery& delivery : script.deliveries) {
                  delivery.label.camera_ns =
                      (*delivery.label.camera_ns + begin_ns) % script.info.clock_wraps_ns;
                }
              },
          .same_as = [](Script&) {}};
}

}  // namespace

std::vector<Scenario> time_scenarios() {
  std::vector<Scenario> out;
  out.push_back({.id = "T1",
                 .fault = "5 % of the stamps absent, 0, negative, equal, backwards, an hour ahead, "
                          "largest or least",
                 .alarms = kStamp,
                 .inject = spoil_stamps,
                 .limits = {.latency_frames = 0.0},
                 .same_as = [](Script&) {}});
  out.push_back({.id = "T2 suspend",
                 .fault = "2 s without the process",
                 .alarms = kMissing | kLost,
                 .inject = suspend,
                 .limits = {.latency_frames = 91.0}});
  out.push_back(pace("slow", "camera 0.1 % slow", 0.001, 0));
  out.push_back(pace("fast", "camera 0.1 % fast", -0.001, 0));
  out.push_back(pace("jitter", "stamps off by up to 200 us", 0.0, 200'000));
  out.push_back(id_wrap("id 16", 16, true));
  out.push_back(id_wrap("id 32", 32, false));
  out.push_back(clock_wrap("us 32", "camera clock of 32 bit, us, wraps", 1'000));
  out.push_back(clock_wrap("ms 32", "camera clock of 32 bit, ms, wraps", 1'000'000));
  return out;
}

}  // namespace lsv::faults
