// SPDX-License-Identifier: BSD-3-Clause
// A camera, as the stream sees it: whole frames with everything the camera says about them, right
// or wrong. Judging ids and stamps is the work of intake.h, not of a source.
// A source belongs to one thread, except stop(), which any thread may call.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "lsv/core/frame.h"
#include "lsv/core/result.h"

namespace lsv {

struct LiveSourceInfo {
  std::string description;          // e.g. "GenICam camera LSV-01 at 127.0.0.1"
  FrameFormat format;               // of the frames to come
  std::int64_t period_ns = 0;       // between exposures, as the camera is set; > 0
  int id_bits = 64;                 // ids wrap after 2^id_bits - 1 ...
  bool id_skips_zero = false;       // ... to 1 (GigE Vision) instead of 0
  std::int64_t clock_wraps_ns = 0;  // the camera's clock starts again at 0 after this; 0: never
};

/// What came with one frame, unjudged.
struct FrameLabel {
  std::uint64_t camera_id = 0;
  std::optional<std::int64_t> camera_ns{};  // exposure on the camera's own clock; may be nonsense
  std::int64_t arrival_ns = 0;              // on the host's monotonic clock
  bool damaged = false;                     // the transport lost a part
};

enum class Grab {
  frame,    // one frame, possibly damaged
  nothing,  // none within the time-out
  ended,    // there will be no more; a camera that can be re-opened says `nothing` instead
};

class LiveSource {
 public:
  virtual ~LiveSource() = default;

  virtual const LiveSourceInfo& info() const = 0;

  /// Waits for at most `timeout_ns` without spinning and fills `out` and `label`. Allocates
  /// nothing once `out` has held a frame of this size. The pixels of a frame of another size or
  /// format than announced are delivered as they are. An error means that the source is gone and
  /// has to be opened anew.
  virtual Result<Grab> grab(Frame& out, FrameLabel& label, std::int64_t timeout_ns) = 0;

  /// Ends a wait in grab() soon. Thread-safe.
  virtual void stop() = 0;

  /// Times that the camera was opened anew behind this interface: ids and its clock may have begun
  /// again, and info() may be another.
  virtual std::int64_t restarts() const { return 0; }

  /// Asks for the camera to be opened anew, because what it sends is no use. False: cannot be done.
  virtual bool reopen() { return false; }

  /// Packets or frames that the driver counted as lost so far.
  virtual std::int64_t transport_losses() const { return 0; }
};

}  // namespace lsv
