// SPDX-License-Identifier: BSD-3-Clause
// A camera that is opened anew when it is gone: unplugged, powered off, or silent for too long.
// While it is, grab() says `nothing` and the stream says `lost`. The first attempt is made at once,
// each further one after twice the pause, up to a longest. Ten attempts in a row after which no
// frame came (about 8 s) are the budget; then grab() returns an error, and the stream is degraded.
// Every frame refills the budget, so a loose cable is followed for ever, and a dead camera is not.
//
// The old camera is closed and the new one opened on a thread of its own, because either may block
// for seconds: grab() and stop() never do.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>

#include "lsv/stream/live_source.h"

namespace lsv {

struct ReopenPolicy {
  int attempts = 10;                          // in a row that bring no frame, >= 1
  std::int64_t first_pause_ns = 100'000'000;  // after the first attempt that failed
  std::int64_t longest_pause_ns = 1'000'000'000;
  std::int64_t silence_ns = 500'000'000;        // without a frame: it is gone
  std::int64_t first_frame_ns = 2'000'000'000;  // the same after it was opened
};

class ReopeningSource : public LiveSource {
 public:
  /// Opens the camera, or says why not. Copied, and called on other threads, one at a time; one
  /// last call may still be under way after the source is destroyed.
  using Factory = std::function<Result<std::unique_ptr<LiveSource>>()>;

  /// Opens it for the first time, here and now.
  static Result<std::unique_ptr<LiveSource>> open(Factory factory, const ReopenPolicy& policy = {});
  ~ReopeningSource() override;

  const LiveSourceInfo& info() const override { return info_; }
  Result<Grab> grab(Frame& out, FrameLabel& label, std::int64_t timeout_ns) override;
  void stop() override;
  std::int64_t restarts() const override { return restarts_; }
  bool reopen() override;
  std::int64_t transport_losses() const override;

 private:
  struct Attempt;

  ReopeningSource(Factory factory, const ReopenPolicy& policy, std::unique_ptr<LiveSource> source);
  Result<Grab> grab_open(Frame& out, FrameLabel& label, std::int64_t timeout_ns);
  Result<Grab> await_attempt(std::int64_t timeout_ns);
  void begin_attempt();
  std::int64_t pause_ns() const;
  bool is_stopped();

  const Factory factory_;
  const ReopenPolicy policy_;
  LiveSourceInfo info_;
  std::shared_ptr<Attempt> attempt_;  // under way; else the camera is open
  int attempts_ = 0;                  // since the last frame
  std::string last_failure_;
  std::int64_t heard_ns_ = 0;  // last frame
  bool has_frames_ = false;    // since it was opened
  std::int64_t restarts_ = 0;
  std::int64_t losses_before_ = 0;  // of the cameras closed

  std::mutex mutex_;  // stop() comes from another thread
  std::unique_ptr<LiveSource> source_;
  bool stopped_ = false;
};

}  // namespace lsv
