// SPDX-License-Identifier: BSD-3-Clause
// A made-up stream for a recorder, and the recording read back.
#pragma once

#include <algorithm>
#include <condition_variable>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "lsv/mcap/messages.h"
#include "lsv/mcap/reader.h"
#include "lsv/record/recorder.h"

namespace lsv::test {

inline constexpr FrameFormat kSmallFormat{
    .width_px = 9, .height_px = 5, .type = PixelType::mono8, .bit_depth = 8};

inline std::uint8_t pixel(std::int64_t index, int x, int y) {
  return static_cast<std::uint8_t>(index * 31 + x * 7 + y * 3);
}

/// Frame `index` of the made-up stream, told as a whole number of milliseconds.
inline void fill(std::int64_t index, Frame& frame, StreamReport& report) {
  frame.reset(kSmallFormat);
  frame.index = index;
  frame.stamp.ns = 1'000'000 * index;
  for (int y = 0; y < kSmallFormat.height_px; ++y) {
    for (int x = 0; x < kSmallFormat.width_px; ++x) frame.row8(y)[x] = pixel(index, x, y);
  }
  report = {};
  report.step.frame = index;
  report.step.stamp = frame.stamp;
  report.step.shift.status = index % 4 == 3 ? ShiftStatus::dark : ShiftStatus::ok;
  report.step.shift.dx_px = 0.1 * static_cast<double>(index);
  report.step.position = {.x_m = 1e-6 * static_cast<double>(index), .y_m = -1e-6};
  report.label = {.camera_id = static_cast<std::uint64_t>(index + 1),
                  .camera_ns = 500 + 1'000'000 * index,
                  .arrival_ns = 700 + 1'000'000 * index};
  report.missing_before = index % 3;
  report.dropped_before = index % 2;
  report.rejected_before = index % 5;
  report.latency_ns = 200'000;
}

inline void push(Recorder& recorder, std::int64_t index, Frame& frame) {
  StreamReport report;
  fill(index, frame, report);
  recorder.on_report(report, frame);
}

inline RecorderOptions recorder_options(const std::string& path) {
  return {.path = path,
          .format = kSmallFormat,
          .program = "lsv test",
          .source = "made up",
          .config_toml = "preset = \"precise\"\n",
          .calibration_toml = "schema = \"x\"\n",
          .sensor_maps_tiff = mcap::Bytes(11, std::byte{3})};
}

inline StreamEvent some_event() {
  return {.host_ns = 5, .severity = Severity::warning, .name = "frames_missing", .text = "Two."};
}

inline HealthSnapshot some_health() {
  HealthSnapshot health;
  health.state = StreamState::running;
  health.missing = 2;
  health.rejected[3] = 7;
  health.latency.p99_s = 0.25;
  return health;
}

struct RecordedFrame {
  std::uint32_t ordinal = 0;
  mcap::FrameNote note{};
  std::vector<std::byte> pixels{};
  StepReport step{};
};

/// A recording, decoded.
struct Recorded {
  std::string error;
  mcap::FileCondition condition;
  std::map<std::string, mcap::Metadata> metadata;
  std::vector<mcap::Attachment> attachments;
  std::vector<RecordedFrame> frames;
  std::vector<mcap::Dropout> dropouts;
  std::vector<mcap::Event> events;
  std::vector<HealthSnapshot> health;
  int odometry = 0;

  std::int64_t frames_lost() const {
    std::int64_t sum = 0;
    for (const mcap::Dropout& dropout : dropouts) sum += dropout.frames;
    return sum;
  }
  /// Of events by that name.
  std::int64_t count(const std::string& name) const {
    return std::ranges::count(events, name, &mcap::Event::name);
  }
};

inline void take(const mcap::Message& message, Recorded& out) {
  const std::string& topic = message.channel->topic;
  if (topic == mcap::kFrameTopic) {
    out.frames.push_back({.ordinal = message.sequence,
                          .note = mcap::decode<mcap::FrameNote>(message.payload).value()});
  } else if (topic == mcap::kImageTopic) {
    const mcap::ByteView data = mcap::decode_image(message.payload).value().data;
    out.frames.back().pixels.assign(data.begin(), data.end());
  } else if (topic == mcap::kStepTopic) {
    out.frames.back().step = mcap::decode<StepReport>(message.payload).value();
  } else if (topic == mcap::kDropoutTopic) {
    out.dropouts.push_back(mcap::decode<mcap::Dropout>(message.payload).value());
  } else if (topic == mcap::kEventTopic) {
    out.events.push_back(mcap::decode<mcap::Event>(message.payload).value());
  } else if (topic == mcap::kHealthTopic) {
    out.health.push_back(mcap::decode<HealthSnapshot>(message.payload).value());
  } else if (topic == mcap::kOdometryTopic) {
    ++out.odometry;
  }
}

inline Recorded read_recording(std::unique_ptr<mcap::ByteSource> source) {
  Recorded out;
  Result<mcap::Reader> reader = mcap::Reader::open(std::move(source), mcap::Damage::refuse);
  if (!reader) {
    out.error = reader.error().message;
    return out;
  }
  for (;;) {
    const Result<mcap::Item> item = reader.value().next();
    if (!item) {
      out.error = item.error().message;
      return out;
    }
    if (item.value() == mcap::Item::end) break;
    if (item.value() == mcap::Item::message) take(reader.value().message(), out);
    if (item.value() == mcap::Item::attachment)
      out.attachments.push_back(reader.value().attachment());
    if (item.value() == mcap::Item::metadata)
      out.metadata[reader.value().metadata().name] = reader.value().metadata();
  }
  out.condition = reader.value().condition();
  return out;
}

/// A disk that another thread can fill, free and stop.
class Disk {
 public:
  std::unique_ptr<mcap::ByteSink> sink();

  void set_capacity(std::size_t bytes) {
    const std::lock_guard lock(mutex_);
    capacity_bytes_ = bytes;
  }
  /// While stopped, writes wait.
  void stop(bool stopped) {
    const std::lock_guard lock(mutex_);
    stopped_ = stopped;
    changed_.notify_all();
  }
  /// Until a write waits.
  void wait_for_a_write() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return waiting_; });
  }
  mcap::Bytes bytes() const {
    const std::lock_guard lock(mutex_);
    return bytes_;
  }
  int syncs() const {
    const std::lock_guard lock(mutex_);
    return syncs_;
  }

 private:
  class Sink;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  mcap::Bytes bytes_;
  std::size_t capacity_bytes_ = std::size_t{1} << 30;
  bool stopped_ = false;
  bool waiting_ = false;
  int syncs_ = 0;
};

class Disk::Sink : public mcap::ByteSink {
 public:
  explicit Sink(Disk& disk) : disk_(disk) {}
  const std::string& name() const override { return name_; }

  Result<void> append(mcap::ByteView bytes) override {
    std::unique_lock lock(disk_.mutex_);
    if (disk_.stopped_) {
      disk_.waiting_ = true;
      disk_.changed_.notify_all();
      disk_.changed_.wait(lock, [this] { return !disk_.stopped_; });
      disk_.waiting_ = false;
    }
    const std::size_t used = std::min(disk_.bytes_.size(), disk_.capacity_bytes_);
    const mcap::ByteView kept = bytes.first(std::min(disk_.capacity_bytes_ - used, bytes.size()));
    disk_.bytes_.insert(disk_.bytes_.end(), kept.begin(), kept.end());
    if (kept.size() == bytes.size()) return {};
    return Error{ErrorCode::output_failed, "cannot write rec.mcap: the disk is full"};
  }
  Result<void> truncate(std::int64_t size_bytes) override {
    const std::lock_guard lock(disk_.mutex_);
    disk_.bytes_.resize(static_cast<std::size_t>(size_bytes));
    return {};
  }
  Result<void> sync() override {
    const std::lock_guard lock(disk_.mutex_);
    ++disk_.syncs_;
    return {};
  }

 private:
  Disk& disk_;
  std::string name_ = "rec.mcap";
};

inline std::unique_ptr<mcap::ByteSink> Disk::sink() { return std::make_unique<Sink>(*this); }

}  // namespace lsv::test
