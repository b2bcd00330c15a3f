// SPDX-License-Identifier: BSD-3-Clause
#include "tools/live_events.h"

#include <utility>

namespace lsv::cli {
namespace {
/// A reader that hangs does not make the program grow.
constexpr std::size_t kMostEvents = 1000;
}  // namespace

void LiveEvents::on_event(const StreamEvent& event) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (events_.size() < kMostEvents) events_.push_back(event);
}

std::vector<StreamEvent> LiveEvents::take() {
  const std::lock_guard<std::mutex> lock(mutex_);
  return std::exchange(events_, {});
}

}  // namespace lsv::cli
