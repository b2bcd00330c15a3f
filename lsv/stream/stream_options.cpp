// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/stream/stream_options.h"

#include <string>

namespace lsv {
namespace {

Error out_of_range(const char* name, std::int64_t value, const char* range) {
  return {ErrorCode::invalid_argument,
          std::string(name) + " is " + std::to_string(value) + " but must be " + range};
}

}  // namespace

Result<void> validate(const StreamOptions& options) {
  if (options.queue_frames < 1 || options.queue_frames > 65'536)
    return out_of_range("queue_frames", options.queue_frames, "1 to 65536");
  if (options.queue_reports < 0 || options.queue_reports > 1'000'000)
    return out_of_range("queue_reports", options.queue_reports, "0 to 1000000");
  if (options.lost_after_ns <= 0)
    return out_of_range("lost_after_ns", options.lost_after_ns, "above 0");
  if (options.health_every_ns <= 0)
    return out_of_range("health_every_ns", options.health_every_ns, "above 0");
  if (options.fifo_priority < 0 || options.fifo_priority > 98)
    return out_of_range("fifo_priority", options.fifo_priority, "0 to 98");
  return {};
}

}  // namespace lsv
