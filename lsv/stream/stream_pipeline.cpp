// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/stream/stream_pipeline.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <mutex>
#include <new>
#include <utility>

namespace lsv {
namespace {

constexpr std::int64_t kNsPerMs = 1'000'000;
// stop() is to work within this and the time to spare.
constexpr std::int64_t kLongestGrab_ns = 50 * kNsPerMs;
constexpr std::int64_t kShortestGrab_ns = 1 * kNsPerMs;
constexpr std::int64_t kDrain_ns = 200 * kNsPerMs;
// A camera may take long to send its first frame.
constexpr std::int64_t kFirstFrame_ns = 2'000 * kNsPerMs;
constexpr std::int64_t kWorkerStall_ns = 500 * kNsPerMs;
constexpr std::int64_t kReadLossesEvery_ns = 100 * kNsPerMs;
constexpr std::int64_t kShortestRate_ns = kNsPerS;
constexpr int kForeignFramesThatReopen = 10;
constexpr std::size_t kEventsKept = 256;

double seconds(std::int64_t duration_ns) {
  return static_cast<double>(duration_ns) / static_cast<double>(kNsPerS);
}

std::size_t place_of(FrameRejection rejection) {
  return static_cast<std::size_t>(
      std::find(kAllFrameRejections.begin(), kAllFrameRejections.end(), rejection) -
      kAllFrameRejections.begin());
}

std::string count_text(std::int64_t count, const std::string& things) {
  return std::to_string(count) + " " + things + (count == 1 ? "" : "s");
}

std::string format_text(const FrameFormat& format) {
  return std::to_string(format.width_px) + " x " + std::to_string(format.height_px) + " px, " +
         std::to_string(format.bit_depth) + " bit";
}

}  // namespace

Result<std::unique_ptr<StreamPipeline>> StreamPipeline::create(const TrackConfig& config,
                                                               const LiveSourceInfo& info,
                                                               const StreamOptions& options,
                                                               std::vector<StreamSink*> sinks,
                                                               MonotonicClock clock) {
  if (const Result<void> valid = validate(options); !valid) return valid.error();
  if (info.period_ns <= 0 || info.id_bits < 1 || info.id_bits > 64) {
    return Error{ErrorCode::invalid_argument,
                 info.description + " says that a frame comes every " +
                     std::to_string(info.period_ns) + " ns with an id of " +
                     std::to_string(info.id_bits) + " bit, which cannot be"};
  }
  Result<Odometer> odometer = Odometer::create(config, info.format);
  if (!odometer) return odometer.error();
  try {
    return std::unique_ptr<StreamPipeline>(new StreamPipeline(
        std::move(odometer).value(), info, options, std::move(sinks), std::move(clock)));
  } catch (const std::bad_alloc&) {
    return Error{ErrorCode::invalid_argument,
                 "there is not enough memory for " + std::to_string(options.queue_frames) +
                     " frames of " + format_text(info.format) + ": use a smaller queue"};
  }
}

StreamPipeline::StreamPipeline(Odometer odometer, const LiveSourceInfo& info,
                               const StreamOptions& options, std::vector<StreamSink*> sinks,
                               MonotonicClock clock)
    : info_(info),
      options_(options),
      lost_after_ns_(std::max(options.lost_after_ns, 3 * info.period_ns)),
      clock_(std::move(clock)),
      sinks_(std::move(sinks)),
      intake_(info),
      heard_ns_(clock_()),
      odometer_(std::move(odometer)),
      next_health_ns_(heard_ns_ + options.health_every_ns),
      rate_since_{.host_ns = heard_ns_},
      rate_before_(rate_since_),
      ring_(static_cast<std::size_t>(options.queue_frames), info.format) {
  if (options.queue_reports > 0) {
    reports_.emplace(static_cast<std::size_t>(options.queue_reports));
    sinks_.push_back(&*reports_);
  }
  captured_.frame = touched_frame(info.format);
  worked_.frame = touched_frame(info.format);
  events_.reserve(kEventsKept);
  telling_.reserve(kEventsKept);
}

bool StreamPipeline::capture(LiveSource& source) {
  bool stopping = false;
  {
    const std::lock_guard lock(mutex_);
    stopping = stopping_;
  }
  if (stopping) {
    end_input(StreamState::ended);
    return false;
  }
  const Result<Grab> grabbed = grab(source);
  const std::int64_t now_ns = clock_();
  if (!grabbed) {
    announce(Severity::error, "source_failed",
             info_.description + ": " + grabbed.error().message + "; no more frames will come");
    end_input(StreamState::degraded);
    return false;
  }
  follow_restarts(source, now_ns);
  if (grabbed.value() == Grab::frame)
    admit(source, now_ns);
  else if (grabbed.value() == Grab::nothing)
    heed_silence(now_ns);
  heed_worker(now_ns);
  announce_tallies(now_ns, false);
  if (grabbed.value() != Grab::ended) return true;
  end_input(StreamState::ended);
  return false;
}

Result<Grab> StreamPipeline::grab(LiveSource& source) {
  try {
    return source.grab(captured_.frame, captured_.label, patience_ns(clock_()));
  } catch (const std::exception& error) {
    return Error{ErrorCode::bad_input, std::string("stopped by: ") + error.what()};
  }
}

/// Until silence means that the source is lost.
std::int64_t StreamPipeline::patience_ns(std::int64_t now_ns) const {
  const std::int64_t left_ns = heard_ns_ + lost_after_ns_ - now_ns;
  return left_ns <= 0 ? kLongestGrab_ns : std::clamp(left_ns, kShortestGrab_ns, kLongestGrab_ns);
}

void StreamPipeline::follow_restarts(LiveSource& source, std::int64_t now_ns) {
  const std::int64_t restarts = source.restarts();
  const bool restarted = restarts != restarts_;
  const bool reads_losses = restarted || now_ns - losses_read_ns_ >= kReadLossesEvery_ns;
  if (!reads_losses) return;
  losses_read_ns_ = now_ns;
  const std::int64_t losses = source.transport_losses();
  {
    const std::lock_guard lock(mutex_);
    book_.transport_losses = losses;
    book_.restarts = restarts;
  }
  if (!restarted) return;
  restarts_ = restarts;
  intake_.restart(source.info());
  announce(Severity::info, "source_reopened", info_.description + " was opened anew");
}

void StreamPipeline::admit(LiveSource& source, std::int64_t now_ns) {
  const Admission admission = intake_.judge(captured_.frame, captured_.label);
  const bool taken = admission.rejection == FrameRejection::none;
  heard_ns_ = now_ns;
  missing_so_far_ += admission.missing_before;
  missing_tally_.add(admission.missing_before);
  if (taken) {
    stamp_tally_.add(admission.stamp_replaced ? 1 : 0);
    captured_.stamp_replaced = admission.stamp_replaced;
    captured_.missing_so_far = missing_so_far_;
    captured_.rejected_so_far = rejected_so_far_;
  } else {
    ++rejected_so_far_;
    rejected_tally_[place_of(admission.rejection)].add(1);
  }
  bool is_back = false;
  {
    const std::lock_guard lock(mutex_);
    ++book_.received;
    book_.missing += admission.missing_before;
    book_.gaps += admission.missing_before > 0 ? 1 : 0;
    // A source of frames that are no use stays what it is.
    is_back = book_.state == StreamState::lost || (taken && book_.state == StreamState::degraded);
    if (is_back || book_.state == StreamState::starting) book_.state = StreamState::running;
    if (taken) {
      book_.bad_stamps += admission.stamp_replaced ? 1 : 0;
      if (ring_.size() == 0 && !in_work_) progress_ns_ = now_ns;
      dropped_tally_.add(ring_.push(captured_) ? 1 : 0);
      signal_.notify();
    } else {
      ++book_.rejected[place_of(admission.rejection)];
    }
  }
  if (is_back) announce(Severity::info, "source_back", info_.description + " sends frames again");
  judge_formats(source, admission.rejection);
}

/// A camera that was set to something else meanwhile: opened anew once, then given up.
void StreamPipeline::judge_formats(LiveSource& source, FrameRejection rejection) {
  if (rejection == FrameRejection::none) {
    foreign_run_ = 0;
    reopened_for_format_ = false;
  }
  if (rejection != FrameRejection::wrong_format) return;
  const FrameFormat format = captured_.frame.view().format;
  foreign_run_ = format == foreign_format_ ? foreign_run_ + 1 : 1;
  foreign_format_ = format;
  if (foreign_run_ != kForeignFramesThatReopen) return;
  const std::string what = info_.description + " sends frames of " + format_text(format) +
                           " instead of " + format_text(info_.format);
  if (!reopened_for_format_ && source.reopen()) {
    reopened_for_format_ = true;
    foreign_run_ = 0;
    announce(Severity::warning, "source_reopening", what + ": it will be opened anew");
    return;
  }
  {
    const std::lock_guard lock(mutex_);
    book_.state = StreamState::degraded;
  }
  announce(Severity::error, "wrong_format", what + ": set the camera, or start the stream again");
}

void StreamPipeline::heed_silence(std::int64_t now_ns) {
  const std::int64_t silence_ns = now_ns - heard_ns_;
  {
    const std::lock_guard lock(mutex_);
    const bool is_lost = (book_.state == StreamState::running && silence_ns >= lost_after_ns_) ||
                         (book_.state == StreamState::starting &&
                          silence_ns >= std::max(kFirstFrame_ns, lost_after_ns_));
    if (!is_lost) return;
    book_.state = StreamState::lost;
  }
  announce(Severity::error, "source_lost",
           "no frame from " + info_.description + " for " + std::to_string(silence_ns / kNsPerMs) +
               " ms");
}

void StreamPipeline::heed_worker(std::int64_t now_ns) {
  {
    const std::lock_guard lock(mutex_);
    const bool owes = in_work_ || ring_.size() > 0;
    const bool stalls = owes && now_ns - progress_ns_ >= kWorkerStall_ns;
    if (!stalls) {
      stall_told_ = false;
      return;
    }
    if (stall_told_) return;
    stall_told_ = true;
    ++book_.worker_stalls;
  }
  announce(Severity::error, "worker_stalled",
           "no frame was measured for half a second although some wait: a callback or sink blocks, "
           "or the machine is overloaded");
}

void StreamPipeline::announce_tallies(std::int64_t now_ns, bool is_last) {
  if (const std::int64_t n = missing_tally_.take(now_ns, is_last); n > 0)
    announce(Severity::warning, "frames_missing", count_text(n, "exposure") + " never arrived");
  if (const std::int64_t n = dropped_tally_.take(now_ns, is_last); n > 0) {
    announce(Severity::warning, "frames_dropped",
             count_text(n, "frame") + " dropped: measuring does not keep up");
  }
  if (const std::int64_t n = stamp_tally_.take(now_ns, is_last); n > 0) {
    announce(Severity::warning, "stamps_replaced",
             count_text(n, "time stamp") + " of the camera made no sense");
  }
  for (std::size_t i = 0; i < rejected_tally_.size(); ++i) {
    const std::int64_t n = rejected_tally_[i].take(now_ns, is_last);
    if (n == 0) continue;
    announce(Severity::warning, "frames_rejected",
             count_text(n, "frame") + " rejected: " + std::string(word(kAllFrameRejections[i])));
  }
}

void StreamPipeline::end_input(StreamState state) {
  announce_tallies(clock_(), true);
  const std::lock_guard lock(mutex_);
  // What was given up stays given up.
  if (book_.state != StreamState::degraded) book_.state = state;
  input_over_ = true;
  signal_.notify();
}

void StreamPipeline::stop() {
  const std::int64_t now_ns = clock_();
  const std::lock_guard lock(mutex_);
  if (stopping_) return;
  stopping_ = true;
  drain_until_ns_ = now_ns + kDrain_ns;
  signal_.notify();
}

void StreamPipeline::announce(Severity severity, std::string name, std::string text) {
  StreamEvent event{
      .host_ns = clock_(), .severity = severity, .name = std::move(name), .text = std::move(text)};
  const std::lock_guard lock(mutex_);
  if (events_.size() < kEventsKept)
    events_.push_back(std::move(event));
  else
    ++events_dropped_;
  signal_.notify();
}

bool StreamPipeline::work(std::int64_t timeout_ns) {
  bool has_frame = false;
  bool is_over = false;
  {
    const std::lock_guard lock(mutex_);
    const std::int64_t until_ns = std::min(clock_() + timeout_ns, next_health_ns_);
    while (ring_.size() == 0 && events_.empty() && !input_over_ && clock_() < until_ns)
      signal_.wait_until(mutex_, until_ns);
    const std::int64_t now_ns = clock_();
    if (stopping_ && now_ns >= drain_until_ns_) ring_.clear();
    std::swap(events_, telling_);
    has_frame = ring_.pop(worked_);
    in_work_ = has_frame;
    progress_ns_ = now_ns;
    is_over = input_over_ && !has_frame;
    dropped_so_far_ = ring_.dropped();
  }
  tell_events();
  if (has_frame) measure();
  const std::int64_t now_ns = clock_();
  if (now_ns >= next_health_ns_ || is_over) tell_health(now_ns);
  if (is_over && reports_) reports_->close();
  return !is_over;
}

void StreamPipeline::measure() {
  const std::int64_t begin_ns = clock_();
  const Result<StepReport> pushed = push();
  const std::int64_t now_ns = clock_();
  if (!pushed) {
    ++refused_so_far_;
    refused_tally_.add(1);
  } else {
    latency_.add(now_ns - worked_.label.arrival_ns);
  }
  {
    const std::lock_guard lock(mutex_);
    in_work_ = false;
    progress_ns_ = now_ns;
    const double age_s = seconds(std::max(std::int64_t{0}, begin_ns - worked_.label.arrival_ns));
    book_.queue_age_max_s = std::fmax(book_.queue_age_max_s, age_s);
    if (!pushed) {
      ++book_.rejected[place_of(FrameRejection::refused)];
    } else {
      const ShiftStatus status = pushed.value().shift.status;
      ++book_.processed;
      if (status == ShiftStatus::ok) {
        ++book_.shifts_ok;
        last_valid_ns_ = now_ns;
      } else if (status != ShiftStatus::first_frame) {
        ++book_.shifts_refused;
      }
      last_result_ns_ = now_ns;
      book_.deadline_misses += now_ns - worked_.label.arrival_ns > info_.period_ns ? 1 : 0;
    }
  }
  if (pushed) {
    report(pushed.value(), now_ns);
  } else if (const std::int64_t n = refused_tally_.take(now_ns, false); n > 0) {
    announce(Severity::warning, "frames_rejected",
             count_text(n, "frame") + " refused by the odometer: " + pushed.error().message);
  }
}

/// Whatever one frame does to the odometer, the next one has its chance.
Result<StepReport> StreamPipeline::push() {
  try {
    return odometer_.push(worked_.frame.view());
  } catch (const std::exception& error) {
    return Error{ErrorCode::bad_input, error.what()};
  }
}

void StreamPipeline::report(const StepReport& step, std::int64_t now_ns) {
  const std::int64_t rejected = worked_.rejected_so_far + refused_so_far_;
  const StreamReport out{.step = step,
                         .label = worked_.label,
                         .missing_before = worked_.missing_so_far - reported_missing_,
                         .dropped_before = dropped_so_far_ - reported_dropped_,
                         .rejected_before = rejected - reported_rejected_,
                         .stamp_replaced = worked_.stamp_replaced,
                         .latency_ns = now_ns - worked_.label.arrival_ns};
  reported_missing_ = worked_.missing_so_far;
  reported_dropped_ = dropped_so_far_;
  reported_rejected_ = rejected;
  tell([&](StreamSink& sink) { sink.on_report(out, worked_.frame); });
}

void StreamPipeline::tell_events() {
  for (const StreamEvent& event : telling_) tell([&](StreamSink& sink) { sink.on_event(event); });
  telling_.clear();
  std::int64_t dropped = 0;
  {
    const std::lock_guard lock(mutex_);
    std::swap(dropped, events_dropped_);
  }
  if (dropped > 0) {
    announce(Severity::warning, "events_dropped",
             count_text(dropped, "event") + " dropped: a callback or sink blocked too long");
  }
}

void StreamPipeline::tell_health(std::int64_t now_ns) {
  next_health_ns_ += options_.health_every_ns;
  if (next_health_ns_ <= now_ns) next_health_ns_ = now_ns + options_.health_every_ns;
  {
    const std::lock_guard lock(mutex_);
    const RateMark now_mark{.host_ns = now_ns, .received = book_.received};
    // The last snapshot may follow closely on one before: over so little time a rate says nothing.
    const bool is_long = now_ns - rate_since_.host_ns >= kShortestRate_ns;
    const RateMark since = is_long ? rate_since_ : rate_before_;
    if (now_ns > since.host_ns) {
      book_.frame_rate_hz =
          static_cast<double>(now_mark.received - since.received) / seconds(now_ns - since.host_ns);
    }
    if (is_long) rate_before_ = std::exchange(rate_since_, now_mark);
  }
  const HealthSnapshot now = health();
  tell([&](StreamSink& sink) { sink.on_health(now); });
}

/// A sink that throws loses what it was told, not the stream.
template <typename Call>
void StreamPipeline::tell(const Call& call) {
  for (StreamSink* const sink : sinks_) {
    try {
      call(*sink);
    } catch (const std::exception& error) {
      sink_tally_.add(1);
      if (const std::int64_t n = sink_tally_.take(clock_(), false); n > 0)
        announce(Severity::error, "sink_failed", std::string("a sink failed: ") + error.what());
    }
  }
}

HealthSnapshot StreamPipeline::health() const {
  HealthSnapshot out;
  std::optional<std::int64_t> result_ns;
  std::optional<std::int64_t> valid_ns;
  {
    const std::lock_guard lock(mutex_);
    out = book_;
    out.queued = ring_.size() + (in_work_ ? 1 : 0);
    out.dropped = ring_.dropped();
    result_ns = last_result_ns_;
    valid_ns = last_valid_ns_;
  }
  const std::int64_t now_ns = clock_();
  if (result_ns) out.since_result_s = seconds(std::max(std::int64_t{0}, now_ns - *result_ns));
  if (valid_ns) out.since_valid_shift_s = seconds(std::max(std::int64_t{0}, now_ns - *valid_ns));
  out.latency = latency_.summary();
  if (reports_) out.reports_dropped = reports_->dropped();
  for (const StreamSink* const sink : sinks_) out.log_dropped += sink->frames_dropped();
  return out;
}

}  // namespace lsv
