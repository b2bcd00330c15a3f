// SPDX-License-Identifier: BSD-3-Clause
// The events of a stream, on their way from its worker to the thread that prints them.
#pragma once

#include <mutex>
#include <vector>

#include "lsv/stream/stream_sink.h"

namespace lsv::cli {

class LiveEvents : public StreamSink {
 public:
  void on_report(const StreamReport&, Frame&) override {}
  void on_event(const StreamEvent& event) override;
  void on_health(const HealthSnapshot&) override {}

  /// What came since the call before. Any thread.
  std::vector<StreamEvent> take();

 private:
  std::mutex mutex_;
  std::vector<StreamEvent> events_;
};

}  // namespace lsv::cli
