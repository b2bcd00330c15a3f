// SPDX-License-Identifier: BSD-3-Clause
// A stream without its threads:
//
//   capture(): source -> intake -> queue of frames | work(): queue -> odometer -> report -> sinks
//
// and the books about both. Stream runs the two halves on two threads; the fault campaign runs them
// in turn, on a clock of its own. capture() belongs to one thread and work() to one; the rest is
// safe from any. Nothing is allocated per frame; an event, which is rare, may allocate.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lsv/core/config.h"
#include "lsv/core/health_snapshot.h"
#include "lsv/core/result.h"
#include "lsv/odometer.h"
#include "lsv/stream/frame_ring.h"
#include "lsv/stream/host_clock.h"
#include "lsv/stream/intake.h"
#include "lsv/stream/latency_histogram.h"
#include "lsv/stream/live_source.h"
#include "lsv/stream/report_queue.h"
#include "lsv/stream/stream_options.h"
#include "lsv/stream/stream_sink.h"
#include "lsv/stream/sync.h"
#include "lsv/stream/tally.h"

namespace lsv {

class StreamPipeline {
 public:
  /// For frames of `info`. The sinks are not owned and must live until work() has returned false.
  /// invalid_argument when a setting is out of range or does not fit the frames.
  static Result<std::unique_ptr<StreamPipeline>> create(const TrackConfig& config,
                                                        const LiveSourceInfo& info,
                                                        const StreamOptions& options,
                                                        std::vector<StreamSink*> sinks,
                                                        MonotonicClock clock = host_now_ns);

  /// Waits for one frame of `source`, always the same one, and deals with it. False: there will be
  /// no more, because the source has ended, is gone for good, or stop() was called.
  bool capture(LiveSource& source);

  /// Waits at most `timeout_ns` for something to do, and does it: events, one frame, the health.
  /// False: all is done that ever will be.
  bool work(std::int64_t timeout_ns);

  /// capture() takes no more frames. Those that wait are measured for 200 ms more, then dropped.
  void stop();

  /// Goes to the sinks from work().
  void announce(Severity severity, std::string name, std::string text);

  HealthSnapshot health() const;

  /// Null unless StreamOptions::queue_reports asks for it.
  ReportQueue* reports() { return reports_ ? &*reports_ : nullptr; }

 private:
  StreamPipeline(Odometer odometer, const LiveSourceInfo& info, const StreamOptions& options,
                 std::vector<StreamSink*> sinks, MonotonicClock clock);

  /// How many frames had come, and when.
  struct RateMark {
    std::int64_t host_ns = 0;
    std::int64_t received = 0;
  };

  // On the thread of capture().
  Result<Grab> grab(LiveSource& source);
  std::int64_t patience_ns(std::int64_t now_ns) const;
  void follow_restarts(LiveSource& source, std::int64_t now_ns);
  void admit(LiveSource& source, std::int64_t now_ns);
  void judge_formats(LiveSource& source, FrameRejection rejection);
  void heed_silence(std::int64_t now_ns);
  void heed_worker(std::int64_t now_ns);
  void announce_tallies(std::int64_t now_ns, bool is_last);
  void end_input(StreamState state);

  // On the thread of work().
  void measure();
  Result<StepReport> push();
  void report(const StepReport& step, std::int64_t now_ns);
  void tell_events();
  void tell_health(std::int64_t now_ns);
  template <typename Call>
  void tell(const Call& call);

  const LiveSourceInfo info_;
  const StreamOptions options_;
  const std::int64_t lost_after_ns_;
  const MonotonicClock clock_;
  std::optional<ReportQueue> reports_;
  std::vector<StreamSink*> sinks_;

  // Of capture().
  Intake intake_;
  QueuedFrame captured_;
  std::int64_t missing_so_far_ = 0;
  std::int64_t rejected_so_far_ = 0;
  std::int64_t heard_ns_;  // when the last frame came
  std::int64_t restarts_ = 0;
  std::int64_t losses_read_ns_ = 0;
  FrameFormat foreign_format_;  // of the last frame of another format, and how many of it in a row
  int foreign_run_ = 0;
  bool reopened_for_format_ = false;
  Tally missing_tally_, dropped_tally_, stamp_tally_;
  std::array<Tally, kAllFrameRejections.size()> rejected_tally_;

  // Of work().
  Odometer odometer_;
  QueuedFrame worked_;
  std::int64_t refused_so_far_ = 0;
  std::int64_t dropped_so_far_ = 0;
  std::int64_t reported_missing_ = 0, reported_rejected_ = 0, reported_dropped_ = 0;
  std::vector<StreamEvent> telling_;
  std::int64_t next_health_ns_;
  RateMark rate_since_;   // from which the frame rate is counted
  RateMark rate_before_;  // the one before, at least kShortestRate_ns older, or the start
  Tally refused_tally_, sink_tally_;

  LatencyHistogram latency_;

  // Of both, under the mutex. `book_` holds the counters; health() adds what follows from them.
  mutable PriorityMutex mutex_;
  Signal signal_;
  FrameRing ring_;
  HealthSnapshot book_;
  std::vector<StreamEvent> events_;
  std::int64_t events_dropped_ = 0;
  bool in_work_ = false;
  bool input_over_ = false;
  bool stopping_ = false;
  std::int64_t drain_until_ns_ = 0;
  std::int64_t progress_ns_ = 0;  // since when the worker owes a result
  bool stall_told_ = false;
  std::optional<std::int64_t> last_result_ns_, last_valid_ns_;
};

}  // namespace lsv
