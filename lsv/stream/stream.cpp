// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/stream/stream.h"

#include <string>
#include <system_error>
#include <utility>

#include "lsv/stream/realtime.h"

namespace lsv {
namespace {
constexpr std::int64_t kWorkerWait_ns = kNsPerS;
}  // namespace

Result<std::unique_ptr<Stream>> Stream::start(std::unique_ptr<LiveSource> source,
                                              const TrackConfig& config,
                                              const StreamOptions& options,
                                              std::vector<StreamSink*> sinks) {
  auto pipeline = StreamPipeline::create(config, source->info(), options, std::move(sinks));
  if (!pipeline) return pipeline.error();
  std::unique_ptr<Stream> out(new Stream(std::move(source), std::move(pipeline).value()));
  try {
    out->begin(options);
  } catch (const std::system_error& error) {
    out->pipeline_->stop();
    out->pipeline_->capture(*out->source_);  // ends the input in place of the thread
    return Error{ErrorCode::invalid_argument,
                 std::string("no thread can be started: ") + error.what()};
  }
  return out;
}

Stream::Stream(std::unique_ptr<LiveSource> source, std::unique_ptr<StreamPipeline> pipeline)
    : source_(std::move(source)), pipeline_(std::move(pipeline)) {}

void Stream::begin(const StreamOptions& options) {
  worker_ = std::thread([this] {
    worker_id_ = std::this_thread::get_id();
    while (pipeline_->work(kWorkerWait_ns)) {
    }
    finished_ = true;
  });
  capture_ = std::thread([this] {
    capture_id_ = std::this_thread::get_id();
    while (pipeline_->capture(*source_)) {
    }
  });
  const auto warn = [this](const char* name, const Result<void>& done) {
    if (!done) pipeline_->announce(Severity::warning, name, done.error().message);
  };
  if (options.fifo_priority > 0) {
    // Taking frames in is the shorter and the more urgent work.
    const Result<void> raised =
        set_fifo_priority(capture_.native_handle(), options.fifo_priority + 1);
    warn("no_realtime",
         raised ? set_fifo_priority(worker_.native_handle(), options.fifo_priority) : raised);
  }
  if (options.lock_memory) warn("memory_not_locked", lock_memory());
}

Stream::~Stream() { stop(); }

std::optional<StreamReport> Stream::next(std::int64_t timeout_ns) {
  ReportQueue* const reports = pipeline_->reports();
  return reports == nullptr ? std::nullopt : reports->next(timeout_ns);
}

bool Stream::finished() const { return finished_; }

void Stream::stop() {
  pipeline_->stop();
  source_->stop();
  const std::thread::id self = std::this_thread::get_id();
  if (self == worker_id_ || self == capture_id_) return;
  const std::lock_guard lock(joining_);
  if (capture_.joinable()) capture_.join();
  if (worker_.joinable()) worker_.join();
}

}  // namespace lsv
