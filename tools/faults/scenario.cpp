// SPDX-License-Identifier: BSD-3-Clause
#include "tools/faults/scenario.h"

#include <algorithm>

namespace lsv::faults {
namespace {

constexpr std::int64_t kBegin_ns = 1'000'000'000;
constexpr std::int64_t kCameraAhead_ns = 77'000'000'000;  // its clock is its own
constexpr std::int64_t kWay_ns = 150'000;                 // from exposure to arrival

}  // namespace

Script::Script(const Footage& shot, std::uint64_t seed)
    : footage(shot),
      random_bits(seed),
      info{.description = "the simulated camera", .format = shot.format(), .period_ns = kPeriod_ns},
      faulty(static_cast<std::size_t>(shot.exposures())),
      lost_(faulty.size()),
      harmless_(faulty.size()) {
  for (std::int64_t k = 0; k < exposures(); ++k) {
    deliveries.push_back({.exposure = k,
                          .picture = k,
                          .label = {.camera_id = static_cast<std::uint64_t>(k + 1),
                                    .camera_ns = stamp_ns(k),
                                    .arrival_ns = arrival_ns(k)}});
  }
}

std::int64_t Script::arrival_ns(std::int64_t exposure) {
  return kBegin_ns + (exposure + 1) * kPeriod_ns;
}

std::int64_t Script::stamp_ns(std::int64_t exposure) {
  return arrival_ns(exposure) - kWay_ns + kCameraAhead_ns;
}

bool Script::chance(double probability) {
  return static_cast<double>(random_bits() >> 11) * 0x1p-53 < probability;
}

void Script::lose(std::int64_t exposure) {
  lost_[static_cast<std::size_t>(exposure)] = true;
  mark(exposure);
  ++missing;
}

void Script::close() {
  for (std::int64_t k = 0; k < exposures(); ++k) {
    if (!faulty[static_cast<std::size_t>(k)]) continue;
    const std::int64_t at_ns = arrival_ns(k);
    if (k == 0 || !faulty[static_cast<std::size_t>(k - 1)])
      episodes.push_back({at_ns, at_ns, false});
    episodes.back().end_ns = at_ns;
    if (!harmless_[static_cast<std::size_t>(k)]) episodes.back().must_be_told = true;
  }
  for (std::int64_t k = exposures() - 1; k >= 0; --k) {
    if (lost_[static_cast<std::size_t>(k)]) deliveries.erase(deliveries.begin() + k);
  }
  std::stable_sort(deliveries.begin(), deliveries.end(), [](const Delivery& a, const Delivery& b) {
    return a.label.arrival_ns < b.label.arrival_ns;
  });
}

}  // namespace lsv::faults
