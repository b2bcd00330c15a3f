// SPDX-License-Identifier: BSD-3-Clause
#include "tools/health_json.h"

#include <cmath>
#include <nlohmann/json.hpp>

namespace lsv::cli {
namespace {

using Json = nlohmann::ordered_json;

Json or_null(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

}  // namespace

std::string health_json(const HealthSnapshot& h) {
  Json rejected = Json::object();
  for (std::size_t i = 0; i < kAllFrameRejections.size(); ++i)
    rejected[std::string(word(kAllFrameRejections[i]))] = h.rejected[i];
  const Json json = {{"schema", "lsv.health/1"},
                     {"state", word(h.state)},
                     {"received", h.received},
                     {"processed", h.processed},
                     {"rejected", rejected},
                     {"dropped", h.dropped},
                     {"queued", h.queued},
                     {"missing", h.missing},
                     {"gaps", h.gaps},
                     {"bad_stamps", h.bad_stamps},
                     {"shifts_ok", h.shifts_ok},
                     {"shifts_refused", h.shifts_refused},
                     {"deadline_misses", h.deadline_misses},
                     {"worker_stalls", h.worker_stalls},
                     {"reports_dropped", h.reports_dropped},
                     {"log_dropped", h.log_dropped},
                     {"restarts", h.restarts},
                     {"transport_losses", h.transport_losses},
                     {"frame_rate_hz", or_null(h.frame_rate_hz)},
                     {"latency_count", h.latency.count},
                     {"latency_p50_s", or_null(h.latency.p50_s)},
                     {"latency_p99_s", or_null(h.latency.p99_s)},
                     {"latency_p999_s", or_null(h.latency.p999_s)},
                     {"latency_max_s", or_null(h.latency.max_s)},
                     {"queue_age_max_s", or_null(h.queue_age_max_s)},
                     {"since_valid_shift_s", or_null(h.since_valid_shift_s)},
                     {"since_result_s", or_null(h.since_result_s)}};
  return json.dump(2) + "\n";
}

}  // namespace lsv::cli
