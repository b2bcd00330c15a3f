// SPDX-License-Identifier: BSD-3-Clause
// A recording (MCAP) frame by frame: one of lsv with everything that belongs to a frame, or that of
// another program with messages sensor_msgs/msg/Image (mono8, mono16; CDR). Of several image topics
// the first that appears is read.
// One thread at a time.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lsv/core/frame.h"
#include "lsv/core/result.h"
#include "lsv/core/step_report.h"
#include "lsv/mcap/messages.h"
#include "lsv/mcap/reader.h"

namespace lsv {

/// By its extension, upper or lower case.
bool is_recording_path(std::string_view path);

struct RecordedFrame {
  /// Index and stamp as the odometer had them. In recordings of others the index counts the images,
  /// and the stamp is that of the image, or the time of recording where images have none.
  Frame frame{};
  std::uint32_t ordinal = 0;  // of all frames that were measured; a hole is a dropout
  bool has_note = false;
  mcap::FrameNote note{};
  std::optional<StepReport> step{};  // what the odometer said
};

/// What the recording said so far, besides its frames.
struct RecordingNotes {
  std::string program{};
  std::string source{};
  std::optional<std::string> config_toml{};
  std::optional<std::string> calibration_toml{};
  mcap::Bytes sensor_maps_tiff{};  // empty without maps
  struct Topic {
    std::string type{};
    std::int64_t messages = 0;
  };
  std::map<std::string, Topic> topics{};
  std::string image_topic{};  // that is read
  std::int64_t frames_dropped = 0;
  std::int64_t dropouts = 0;
  std::deque<mcap::Event> events{};  // the last kMaxEvents
  std::int64_t event_count = 0;
  std::optional<HealthSnapshot> last_health{};
};

struct RecordingOptions {
  mcap::Damage damage = mcap::Damage::refuse;
  std::int64_t max_pixels = 0;     // a declared width * height above this is refused
  std::optional<int> bit_depth{};  // of mono16 images without a note; unset: 16
};

class RecordingReader {
 public:
  static constexpr std::size_t kMaxEvents = 100;

  static Result<RecordingReader> open(const std::string& path, const RecordingOptions& options);

  /// Fills `out`, whose memory is reused, or returns false at the end. After an error the reader is
  /// finished.
  Result<bool> next(RecordedFrame& out);

  const RecordingNotes& notes() const { return notes_; }
  /// Complete once the end was reached.
  const mcap::FileCondition& condition() const { return reader_.condition(); }

 private:
  RecordingReader(std::string path, mcap::Reader reader, const RecordingOptions& options);
  Result<bool> find_image(RecordedFrame& out);
  Result<void> find_step(RecordedFrame& out);
  Result<bool> take_message();
  Result<void> take_image(RecordedFrame& out);
  Result<void> take_metadata(const mcap::Metadata& metadata);
  Result<FrameFormat> format_of(const mcap::ImageMessage& image) const;
  Error wrong(const std::string& what) const;

  std::string path_;
  mcap::Reader reader_;
  RecordingOptions options_;
  RecordingNotes notes_;
  std::optional<mcap::FrameNote> next_note_;  // of the image to come
  bool at_message_ = false;  // the reader stands at a message that was not taken yet
  std::int64_t images_ = 0;
  std::optional<bool> images_have_stamps_;
};

}  // namespace lsv
