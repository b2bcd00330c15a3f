// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/record/recorder.h"

#include <semaphore.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <ctime>
#include <deque>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>
#include <variant>

#include "lsv/mcap/tail.h"
#include "lsv/record/frame_queue.h"
#include "lsv/record/recording_writer.h"

namespace lsv {
namespace {

/// Events and health wait in a queue of their own, which a dead disk must not let grow for ever.
constexpr std::size_t kMaxWaiting = 1000;

std::int64_t now_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

std::int64_t wall_minus_monotonic_ns() {
  const auto wall = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::nanoseconds>(wall).count() - now_ns();
}

std::size_t chunk_bytes(const RecorderOptions& options) {
  return std::max(options.chunk_bytes, RecordingWriter::frame_bytes(options.format));
}

Result<std::unique_ptr<mcap::TailFile>> make_tail(const RecorderOptions& options) {
  return mcap::TailFile::create(mcap::tail_path(options.path), chunk_bytes(options));
}

std::size_t queue_frames(const RecorderOptions& options) {
  if (options.queue_frames > 0) return options.queue_frames;
  constexpr std::size_t kQueue_bytes = std::size_t{64} << 20;
  return std::clamp<std::size_t>(kQueue_bytes / RecordingWriter::frame_bytes(options.format), 8,
                                 1024);
}

void add(mcap::Dropout& sum, const mcap::Dropout& more) {
  if (more.frames == 0) return;
  if (sum.frames == 0) {
    sum = more;
    return;
  }
  sum.frames += more.frames;
  sum.last_frame = more.last_frame;
  sum.last_ns = more.last_ns;
}

void add(mcap::Dropout& sum, const StreamReport& report) {
  const std::int64_t index = report.step.frame;
  const std::int64_t arrival_ns = report.label.arrival_ns;
  add(sum, {.frames = 1,
            .first_frame = index,
            .last_frame = index,
            .first_ns = arrival_ns,
            .last_ns = arrival_ns});
}

/// Counts what there is to do. Unlike a condition variable it never makes the side that has work
/// wait for a lock.
class Wakeup {
 public:
  Wakeup() { ::sem_init(&semaphore_, 0, 0); }
  Wakeup(const Wakeup&) = delete;
  Wakeup& operator=(const Wakeup&) = delete;
  ~Wakeup() { ::sem_destroy(&semaphore_); }

  void post() { ::sem_post(&semaphore_); }
  void wait_until(std::int64_t deadline_ns) {
    const timespec deadline{.tv_sec = deadline_ns / kNsPerS, .tv_nsec = deadline_ns % kNsPerS};
    while (::sem_clockwait(&semaphore_, CLOCK_MONOTONIC, &deadline) != 0 && errno == EINTR) {
    }
  }

 private:
  sem_t semaphore_{};
};

}  // namespace

class Recorder::Worker {
 public:
  Worker(const RecorderOptions& options, RecordingWriter writer, mcap::TailFile* tail)
      : options_(options),
        writer_(std::move(writer)),
        tail_(tail),
        queue_(queue_frames(options), options.format),
        flush_at_ns_(now_ns() + options.flush_ns),
        sync_at_ns_(now_ns() + options.sync_ns),
        thread_([this] { run(); }) {}

  ~Worker() { static_cast<void>(close()); }
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  void push(const StreamReport& report, Frame& frame) {
    if (queue_.push(report, frame, ordinal_++, queue_lost_)) {
      queue_lost_ = {};
      wakeup_.post();
    } else {
      add(queue_lost_, report);
      dropped_.fetch_add(1, std::memory_order_relaxed);
    }
  }

  void push(std::variant<StreamEvent, HealthSnapshot> note) {
    {
      const std::lock_guard lock(notes_mutex_);
      if (notes_.size() < kMaxWaiting)
        notes_.push_back({now_ns(), std::move(note)});
      else
        ++notes_lost_;
    }
    wakeup_.post();
  }

  std::int64_t dropped() const { return dropped_.load(std::memory_order_relaxed); }

  Result<void> close() {
    if (thread_.joinable()) {
      closing_.store(true, std::memory_order_release);
      wakeup_.post();
      thread_.join();
    }
    return end_;
  }

 private:
  struct Note {
    std::int64_t host_ns = 0;
    std::variant<StreamEvent, HealthSnapshot> what;
  };

  void run() {
    for (;;) {
      const bool last_round = closing_.load(std::memory_order_acquire);
      write_notes();
      while (const FrameToRecord* frame = queue_.front()) {
        record(*frame);
        queue_.pop();
        do_what_is_due();
      }
      if (last_round) break;
      do_what_is_due();
      wakeup_.wait_until(failing_ ? retry_at_ns_ : std::min(flush_at_ns_, sync_at_ns_));
    }
    end_ = finish();
  }

  void record(const FrameToRecord& frame) {
    add(lost_, frame.lost_before);
    // While frames are missing none is added before the disk has taken what waits for it.
    const bool may_write = lost_.frames == 0 || (!failing_ && write_dropout());
    if (may_write) {
      const Result<void> written = writer_.add_frame(frame);
      if (written) return;
      fail(written.error());
    }
    add(lost_, frame.report);
    dropped_.fetch_add(1, std::memory_order_relaxed);
  }

  bool write_dropout() {
    const Result<void> written = writer_.add_dropout(lost_);
    if (written)
      lost_ = {};
    else
      fail(written.error());
    return written.ok();
  }

  void write_notes() {
    if (failing_) return;
    std::deque<Note> notes;
    {
      const std::lock_guard lock(notes_mutex_);
      notes.swap(notes_);
      if (const std::int64_t lost = std::exchange(notes_lost_, 0); lost > 0) {
        notes.push_back({now_ns(), StreamEvent{.host_ns = now_ns(),
                                               .severity = Severity::warning,
                                               .name = "notes_lost",
                                               .text = std::to_string(lost) +
                                                       " events or health messages are not in "
                                                       "the recording"}});
      }
    }
    while (!notes.empty()) {
      const Note& note = notes.front();
      const auto* const event = std::get_if<StreamEvent>(&note.what);
      const Result<void> written =
          event ? writer_.add_event(*event)
                : writer_.add_health(std::get<HealthSnapshot>(note.what), note.host_ns);
      if (!written) {
        fail(written.error());
        break;
      }
      notes.pop_front();
    }
    const std::lock_guard lock(notes_mutex_);
    notes_.insert(notes_.begin(), std::make_move_iterator(notes.begin()),
                  std::make_move_iterator(notes.end()));
  }

  void do_what_is_due() {
    const std::int64_t now = now_ns();
    if (failing_) {
      if (now >= retry_at_ns_) retry();
      return;
    }
    const bool sync_is_due = now >= sync_at_ns_;
    if (now < flush_at_ns_ && !sync_is_due) return;
    flush_at_ns_ = now + options_.flush_ns;
    if (sync_is_due) sync_at_ns_ = now + options_.sync_ns;
    Result<void> done = writer_.flush();
    if (done && sync_is_due) done = writer_.sync();
    if (!done) fail(done.error());
  }

  /// The first failure is told; from then on the disk is tried again from time to time.
  void fail(const Error& error) {
    retry_at_ns_ = now_ns() + options_.retry_ns;
    if (std::exchange(failing_, true)) return;
    tell(Severity::error, "recording_failing",
         error.message + "; measuring goes on, and recording when this ends");
  }

  void retry() {
    Result<void> done = writer_.flush();
    if (done) done = writer_.sync();
    if (!done) {
      fail(done.error());
      return;
    }
    failing_ = false;
    std::string text = "the recording goes on, without a frame missing";
    if (lost_.frames > 0) {
      text = "the recording goes on; it lacks " + std::to_string(lost_.frames) + " frames, from " +
             std::to_string(lost_.first_frame) + " to " + std::to_string(lost_.last_frame) +
             ", of " + std::to_string((lost_.last_ns - lost_.first_ns) / 1'000'000) + " ms";
      if (!write_dropout()) return;
    }
    tell(Severity::info, "recording_resumed", std::move(text));
    write_notes();
  }

  void tell(Severity severity, const char* name, std::string text) {
    const StreamEvent event{
        .host_ns = now_ns(), .severity = severity, .name = name, .text = std::move(text)};
    push(event);
    if (options_.alarm) options_.alarm(event);
  }

  Result<void> finish() {
    add(lost_, queue_lost_);
    if (failing_) retry();
    if (!failing_) {
      if (lost_.frames > 0) write_dropout();
      write_notes();
    }
    Result<void> finished = writer_.finish();
    if (finished) {
      if (tail_) tail_->remove();
    } else if (lost_.frames > 0 && writer_.has_room_for_dropout()) {
      static_cast<void>(writer_.add_dropout(lost_));  // into the tail, for lsv recover
    }
    return finished;
  }

  const RecorderOptions options_;
  RecordingWriter writer_;  // of the worker's thread, like all that is not named otherwise
  mcap::TailFile* tail_;    // owned by the writer; null without one
  FrameQueue queue_;        // both threads
  Wakeup wakeup_;           // both threads

  std::uint64_t ordinal_ = 0;   // of the stream's thread, and the next
  mcap::Dropout queue_lost_{};  // since the last frame that fitted; the worker's at the end
  std::atomic<std::int64_t> dropped_{0};
  std::atomic<bool> closing_{false};

  std::mutex notes_mutex_;
  std::deque<Note> notes_;  // under the mutex, as is the next
  std::int64_t notes_lost_ = 0;

  bool failing_ = false;
  mcap::Dropout lost_{};  // frames since the last that was written
  std::int64_t flush_at_ns_;
  std::int64_t sync_at_ns_;
  std::int64_t retry_at_ns_ = 0;
  Result<void> end_{};
  std::thread thread_;  // last: it uses all others
};

Recorder::Recorder(std::unique_ptr<Worker> worker) : worker_(std::move(worker)) {}
Recorder::~Recorder() = default;

Result<std::unique_ptr<Recorder>> Recorder::create(const RecorderOptions& options) {
  // The tail first: one that is left from a recording of this name must not be lost.
  auto tail = make_tail(options);
  if (!tail) return tail.error();
  auto sink = mcap::create_file(options.path);
  if (!sink) {
    tail.value()->remove();
    return sink.error();
  }
  mcap::TailFile* const kept = tail.value().get();
  auto recorder = create(options, std::move(sink).value(), std::move(tail).value(), kept);
  if (!recorder) {
    ::unlink(mcap::tail_path(options.path).c_str());
    ::unlink(options.path.c_str());
  }
  return recorder;
}

Result<std::unique_ptr<Recorder>> Recorder::create(const RecorderOptions& options,
                                                   std::unique_ptr<mcap::ByteSink> sink) {
  return create(options, std::move(sink), std::make_unique<mcap::HeapChunk>(chunk_bytes(options)),
                nullptr);
}

Result<std::unique_ptr<Recorder>> Recorder::create(const RecorderOptions& options,
                                                   std::unique_ptr<mcap::ByteSink> sink,
                                                   std::unique_ptr<mcap::ChunkMemory> chunk,
                                                   mcap::TailFile* tail) {
  Result<RecordingWriter> writer = RecordingWriter::create(options, wall_minus_monotonic_ns(),
                                                           std::move(sink), std::move(chunk));
  if (!writer) return writer.error();
  return std::unique_ptr<Recorder>(
      new Recorder(std::make_unique<Worker>(options, std::move(writer).value(), tail)));
}

void Recorder::on_report(const StreamReport& report, Frame& frame) { worker_->push(report, frame); }
void Recorder::on_event(const StreamEvent& event) { worker_->push(event); }
void Recorder::on_health(const HealthSnapshot& health) { worker_->push(health); }
std::int64_t Recorder::frames_dropped() const { return worker_->dropped(); }
Result<void> Recorder::close() { return worker_->close(); }

}  // namespace lsv
