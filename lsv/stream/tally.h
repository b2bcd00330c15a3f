// SPDX-License-Identifier: BSD-3-Clause
// For what can happen at every frame and still deserves a line in a log: the first time at once,
// then at most once a second how often. A plain value, no threads.
#pragma once

#include <cstdint>
#include <optional>

#include "lsv/core/stamp.h"

namespace lsv {

class Tally {
 public:
  void add(std::int64_t count) { count_ += count; }

  /// What to announce now; 0: nothing. `is_last`: there will be no later occasion.
  std::int64_t take(std::int64_t now_ns, bool is_last) {
    const bool is_due = is_last || !announced_ns_ || now_ns - *announced_ns_ >= kNsPerS;
    if (count_ == 0 || !is_due) return 0;
    const std::int64_t out = count_;
    count_ = 0;
    announced_ns_ = now_ns;
    return out;
  }

 private:
  std::int64_t count_ = 0;
  std::optional<std::int64_t> announced_ns_;
};

}  // namespace lsv
