// SPDX-License-Identifier: BSD-3-Clause
// What of a stream goes into a recording, and how: channels, settings, frames.
// Internal to lsv/record: use recorder.h.
#pragma once

#include <cstdint>
#include <memory>
#include <string_view>

#include "lsv/core/result.h"
#include "lsv/mcap/messages.h"
#include "lsv/mcap/writer.h"
#include "lsv/record/frame_queue.h"
#include "lsv/record/recorder.h"

namespace lsv {

class RecordingWriter {
 public:
  /// The most that one frame with all that is said about it takes in a chunk.
  static std::size_t frame_bytes(const FrameFormat& format);

  /// Writes the settings. `wall_ns` is what to add to the host's monotonic clock to get wall time.
  static Result<RecordingWriter> create(const RecorderOptions& options, std::int64_t wall_ns,
                                        std::unique_ptr<mcap::ByteSink> sink,
                                        std::unique_ptr<mcap::ChunkMemory> chunk);

  // Each is written whole or not at all, and outlives the process where the chunk does.
  Result<void> add_frame(const FrameToRecord& frame);
  Result<void> add_dropout(const mcap::Dropout& dropout);
  Result<void> add_event(const StreamEvent& event);
  Result<void> add_health(const HealthSnapshot& health, std::int64_t host_ns);

  Result<void> flush() { return writer_.flush(); }
  Result<void> sync() { return writer_.sync(); }
  Result<void> finish() { return writer_.finish(); }
  bool has_open_messages() const { return writer_.has_open_messages(); }
  /// Whether add_dropout() would be kept without the file.
  bool has_room_for_dropout() const;

 private:
  struct Channels {
    mcap::ChannelId frame = 0;
    mcap::ChannelId image = 0;
    mcap::ChannelId step = 0;
    mcap::ChannelId odometry = 0;
    mcap::ChannelId health = 0;
    mcap::ChannelId event = 0;
    mcap::ChannelId dropout = 0;
  };

  RecordingWriter(mcap::Writer writer, std::int64_t wall_ns);
  Result<void> add_channels(const std::string& recording_id);
  Result<void> add_settings(const RecorderOptions& options, const std::string& recording_id);
  Result<void> add(mcap::ChannelId channel, std::int64_t host_ns);

  mcap::Writer writer_;
  std::int64_t wall_ns_;
  Channels channels_;
  std::uint32_t note_count_ = 0;  // of messages that are not about a frame
  mcap::Bytes note_;              // the message at hand, and so on
  mcap::Bytes image_;
  mcap::Bytes step_;
  mcap::Bytes odometry_;
};

}  // namespace lsv
