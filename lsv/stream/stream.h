// SPDX-License-Identifier: BSD-3-Clause
// A camera, the odometer and whoever listens, joined by two threads:
//
//   capture thread: source -> intake -> queue of frames | worker: odometer -> report -> listeners
//
// The queue drops its oldest frame when measuring does not keep up, and counts it; every report
// says what was dropped, missing or rejected before it (stream_sink.h), and health() says it in
// total. Results are handed to sinks and callbacks on the worker thread, or fetched with next().
//
//   auto stream = lsv::Stream::start(std::move(camera), config, {.queue_reports = 64});
//   while (const auto report = stream.value()->next()) ...
//
// Time is the host's monotonic clock; frames carry the camera's stamps (intake.h). Every method is
// safe from any thread.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "lsv/core/config.h"
#include "lsv/core/health_snapshot.h"
#include "lsv/core/result.h"
#include "lsv/stream/live_source.h"
#include "lsv/stream/stream_options.h"
#include "lsv/stream/stream_pipeline.h"
#include "lsv/stream/stream_sink.h"

namespace lsv {

inline constexpr std::int64_t kForever_ns = std::numeric_limits<std::int64_t>::max() / 2;

class Stream {
 public:
  /// The source is open and delivers. `sinks` are not owned and must live until stop() has
  /// returned. What the system refuses of real time is an event, not an error. invalid_argument
  /// when a setting is out of range or does not fit the frames, or no thread can be started.
  static Result<std::unique_ptr<Stream>> start(std::unique_ptr<LiveSource> source,
                                               const TrackConfig& config,
                                               const StreamOptions& options = {},
                                               std::vector<StreamSink*> sinks = {});
  ~Stream();
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;

  /// The next report, waiting for it at most `timeout_ns`; needs StreamOptions::queue_reports.
  /// Empty: none came in time, or none will come any more.
  std::optional<StreamReport> next(std::int64_t timeout_ns = kForever_ns);

  /// Whether all is over: the source has ended or failed, or stop() was called, and every frame was
  /// dealt with. Reports may still wait for next().
  bool finished() const;

  HealthSnapshot health() const { return pipeline_->health(); }

  /// Ends it within 500 ms, unless a listener or the source blocks for longer. Frames that wait are
  /// measured for 200 ms more, then dropped and counted. After it no listener is called. Again:
  /// nothing. From a listener: returns at once, and the stream ends soon.
  void stop();

 private:
  Stream(std::unique_ptr<LiveSource> source, std::unique_ptr<StreamPipeline> pipeline);
  void begin(const StreamOptions& options);

  std::unique_ptr<LiveSource> source_;
  std::unique_ptr<StreamPipeline> pipeline_;
  std::atomic<bool> finished_{false};
  std::atomic<std::thread::id> worker_id_{}, capture_id_{};
  std::mutex joining_;
  std::thread worker_;
  std::thread capture_;
};

/// A function as a listener; called on the worker thread, so it must be quick.
class CallbackSink : public StreamSink {
 public:
  explicit CallbackSink(std::function<void(const StreamReport&)> call) : call_(std::move(call)) {}
  void on_report(const StreamReport& report, Frame&) override { call_(report); }
  void on_event(const StreamEvent&) override {}
  void on_health(const HealthSnapshot&) override {}

 private:
  std::function<void(const StreamReport&)> call_;
};

}  // namespace lsv
