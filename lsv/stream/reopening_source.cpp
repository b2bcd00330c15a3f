// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/stream/reopening_source.h"

#include <algorithm>
#include <optional>
#include <system_error>
#include <thread>
#include <utility>

#include "lsv/stream/host_clock.h"
#include "lsv/stream/sync.h"

namespace lsv {
namespace {

// What a camera that is being opened is waited for when nobody wants it any more.
constexpr std::int64_t kFarewell_ns = 200'000'000;

Error as_error(const std::exception& error) {
  return {ErrorCode::bad_input, std::string("stopped by: ") + error.what()};
}

}  // namespace

/// Shared with the thread that opens, which may outlive the source.
struct ReopeningSource::Attempt {
  PriorityMutex mutex;
  Signal signal;
  bool abandoned = false;
  bool done = false;
  std::optional<Result<std::unique_ptr<LiveSource>>> outcome;

  /// False when abandoned.
  bool wait_until(std::int64_t until_ns) {
    const std::lock_guard lock(mutex);
    while (!abandoned && host_now_ns() < until_ns) signal.wait_until(mutex, until_ns);
    return !abandoned;
  }

  /// False when it is not done by then.
  bool wait_done(std::int64_t until_ns) {
    const std::lock_guard lock(mutex);
    while (!done && !abandoned && host_now_ns() < until_ns) signal.wait_until(mutex, until_ns);
    return done;
  }

  void finish(std::optional<Result<std::unique_ptr<LiveSource>>> result) {
    const std::lock_guard lock(mutex);
    outcome = std::move(result);
    done = true;
    signal.notify();
  }

  void abandon() {
    const std::lock_guard lock(mutex);
    abandoned = true;
    signal.notify();
  }
};

Result<std::unique_ptr<LiveSource>> ReopeningSource::open(Factory factory,
                                                          const ReopenPolicy& policy) {
  Result<std::unique_ptr<LiveSource>> source = factory();
  if (!source) return source.error();
  return std::unique_ptr<LiveSource>(
      new ReopeningSource(std::move(factory), policy, std::move(source).value()));
}

ReopeningSource::ReopeningSource(Factory factory, const ReopenPolicy& policy,
                                 std::unique_ptr<LiveSource> source)
    : factory_(std::move(factory)),
      policy_(policy),
      info_(source->info()),
      heard_ns_(host_now_ns()),
      source_(std::move(source)) {}

ReopeningSource::~ReopeningSource() {
  if (!attempt_) return;
  attempt_->abandon();
  const std::int64_t until_ns = host_now_ns() + kFarewell_ns;
  const std::lock_guard lock(attempt_->mutex);
  while (!attempt_->done && host_now_ns() < until_ns)
    attempt_->signal.wait_until(attempt_->mutex, until_ns);
}

Result<Grab> ReopeningSource::grab(Frame& out, FrameLabel& label, std::int64_t timeout_ns) {
  if (!attempt_) return grab_open(out, label, timeout_ns);
  if (is_stopped()) return Grab::nothing;
  return await_attempt(timeout_ns);
}

Result<Grab> ReopeningSource::grab_open(Frame& out, FrameLabel& label, std::int64_t timeout_ns) {
  Result<Grab> grabbed = source_->grab(out, label, timeout_ns);
  if (grabbed && grabbed.value() == Grab::ended) return grabbed;
  const std::int64_t now_ns = host_now_ns();
  if (grabbed && grabbed.value() == Grab::frame) {
    heard_ns_ = now_ns;
    has_frames_ = true;
    attempts_ = 0;
    return grabbed;
  }
  if (!grabbed)
    last_failure_ = grabbed.error().message;
  else if (now_ns - heard_ns_ >= (has_frames_ ? policy_.silence_ns : policy_.first_frame_ns))
    last_failure_ = info_.description + " sends no frames";
  else
    return grabbed;
  if (attempts_ >= policy_.attempts) {
    return Error{ErrorCode::bad_input, "given up after " + std::to_string(attempts_) +
                                           " attempts to open it anew: " + last_failure_};
  }
  begin_attempt();
  return Grab::nothing;
}

Result<Grab> ReopeningSource::await_attempt(std::int64_t timeout_ns) {
  if (!attempt_->wait_done(host_now_ns() + timeout_ns)) return Grab::nothing;
  std::optional<Result<std::unique_ptr<LiveSource>>> outcome;
  {
    const std::lock_guard lock(attempt_->mutex);
    outcome = std::move(attempt_->outcome);
  }
  attempt_.reset();
  if (outcome && *outcome) {
    info_ = outcome->value()->info();
    ++restarts_;
    heard_ns_ = host_now_ns();
    has_frames_ = false;
    const std::lock_guard lock(mutex_);
    source_ = std::move(*outcome).value();
    if (stopped_) source_->stop();
    return Grab::nothing;
  }
  if (outcome) last_failure_ = outcome->error().message;
  if (attempts_ >= policy_.attempts) {
    return Error{ErrorCode::bad_input, "given up after " + std::to_string(attempts_) +
                                           " attempts to open it anew: " + last_failure_};
  }
  begin_attempt();
  return Grab::nothing;
}

void ReopeningSource::begin_attempt() {
  const std::int64_t not_before_ns = host_now_ns() + pause_ns();
  ++attempts_;
  losses_before_ = transport_losses();
  std::unique_ptr<LiveSource> old;
  {
    const std::lock_guard lock(mutex_);
    old = std::move(source_);
  }
  attempt_ = std::make_shared<Attempt>();
  try {
    std::thread([attempt = attempt_, factory = factory_, old = std::move(old),
                 not_before_ns]() mutable {
      old.reset();
      std::optional<Result<std::unique_ptr<LiveSource>>> outcome;
      if (attempt->wait_until(not_before_ns)) {
        try {
          outcome.emplace(factory());
        } catch (const std::exception& error) {
          outcome.emplace(as_error(error));
        }
      }
      attempt->finish(std::move(outcome));
    }).detach();
  } catch (const std::system_error& error) {
    attempt_->finish(Result<std::unique_ptr<LiveSource>>(as_error(error)));
  }
}

std::int64_t ReopeningSource::pause_ns() const {
  if (attempts_ == 0) return 0;
  std::int64_t pause_ns = policy_.first_pause_ns;
  for (int i = 1; i < attempts_ && pause_ns < policy_.longest_pause_ns; ++i) pause_ns *= 2;
  return std::min(pause_ns, policy_.longest_pause_ns);
}

bool ReopeningSource::reopen() {
  if (!attempt_) begin_attempt();
  return true;
}

void ReopeningSource::stop() {
  const std::lock_guard lock(mutex_);
  stopped_ = true;
  if (source_) source_->stop();
}

bool ReopeningSource::is_stopped() {
  const std::lock_guard lock(mutex_);
  return stopped_;
}

std::int64_t ReopeningSource::transport_losses() const {
  return losses_before_ + (source_ ? source_->transport_losses() : 0);
}

}  // namespace lsv
