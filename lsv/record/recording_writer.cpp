// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/record/recording_writer.h"

#include <cstdio>
#include <random>
#include <string>
#include <utility>

#include "lsv/mcap/sealed.h"

namespace lsv {
namespace {

/// Definitions, heads, note, step and odometry, generously.
constexpr std::size_t kBesidePixels_bytes = std::size_t{32} << 10;

std::string new_recording_id() {
  std::random_device random;
  char text[40];
  std::snprintf(text, sizeof text, "%08x%08x", random(), random());
  return text;
}

mcap::FrameNote note_of(const StreamReport& report, const FrameView& frame) {
  const FrameLabel& label = report.label;
  return {.index = frame.index,
          .stamp_ns = frame.stamp.ns,
          .bit_depth = frame.format.bit_depth,
          .camera_id = label.camera_id,
          .has_camera_ns = label.camera_ns.has_value(),
          .camera_ns = label.camera_ns.value_or(0),
          .arrival_ns = label.arrival_ns,
          .damaged = label.damaged,
          .missing_before = report.missing_before,
          .dropped_before = report.dropped_before,
          .rejected_before = report.rejected_before,
          .stamp_replaced = report.stamp_replaced,
          .latency_ns = report.latency_ns};
}

mcap::Severity severity_of(Severity severity) {
  if (severity == Severity::error) return mcap::Severity::error;
  if (severity == Severity::warning) return mcap::Severity::warning;
  return mcap::Severity::info;
}

}  // namespace

std::size_t RecordingWriter::frame_bytes(const FrameFormat& format) {
  return kBesidePixels_bytes + static_cast<std::size_t>(format.width_px) *
                                   static_cast<std::size_t>(format.height_px) *
                                   bytes_per_pixel(format.type);
}

RecordingWriter::RecordingWriter(mcap::Writer writer, std::int64_t wall_ns)
    : writer_(std::move(writer)), wall_ns_(wall_ns) {}

Result<RecordingWriter> RecordingWriter::create(const RecorderOptions& options,
                                                std::int64_t wall_ns,
                                                std::unique_ptr<mcap::ByteSink> sink,
                                                std::unique_ptr<mcap::ChunkMemory> chunk) {
  Result<mcap::Writer> writer =
      mcap::Writer::create(std::move(sink), std::move(chunk),
                           {.library = options.program, .compression = options.compression});
  if (!writer) return writer.error();
  RecordingWriter out(std::move(writer).value(), wall_ns);
  const std::string recording_id = new_recording_id();
  if (Result<void> added = out.add_settings(options, recording_id); !added) return added.error();
  if (Result<void> added = out.add_channels(recording_id); !added) return added.error();
  return out;
}

Result<void> RecordingWriter::add_channels(const std::string& recording_id) {
  const std::pair<mcap::ChannelId*, std::pair<std::string_view, std::string_view>> wanted[] = {
      {&channels_.frame, {mcap::kFrameTopic, mcap::kFrameType}},
      {&channels_.image, {mcap::kImageTopic, mcap::kImageType}},
      {&channels_.step, {mcap::kStepTopic, mcap::kStepType}},
      {&channels_.odometry, {mcap::kOdometryTopic, mcap::kOdometryType}},
      {&channels_.health, {mcap::kHealthTopic, mcap::kHealthType}},
      {&channels_.event, {mcap::kEventTopic, mcap::kEventType}},
      {&channels_.dropout, {mcap::kDropoutTopic, mcap::kDropoutType}}};
  for (const auto& [id, topic_and_type] : wanted) {
    const auto& [topic, type] = topic_and_type;
    // With the id, so that no chunk of another recording is ever taken for one of this.
    const Result<mcap::ChannelId> added =
        writer_.add_channel({.topic = std::string(topic),
                             .message_encoding = "cdr",
                             .metadata = {{"recording_id", recording_id}},
                             .schema = mcap::schema_of(type)});
    if (!added) return added.error();
    *id = added.value();
  }
  return {};
}

Result<void> RecordingWriter::add_settings(const RecorderOptions& options,
                                           const std::string& recording_id) {
  const mcap::Metadata settings[] = {
      {.name = std::string(mcap::kRecordingMetadata),
       .entries = {{"id", recording_id},
                   {"program", options.program},
                   {"source", options.source},
                   {"wall_minus_monotonic_ns", std::to_string(wall_ns_)}}},
      {.name = std::string(mcap::kConfigMetadata),
       .entries = {{std::string(mcap::kConfigEntry), options.config_toml}}},
      {.name = std::string(mcap::kCalibrationMetadata),
       .entries = {{std::string(mcap::kCalibrationEntry), options.calibration_toml}}}};
  for (const mcap::Metadata& each : settings) {
    if (Result<void> added = writer_.add_metadata(mcap::sealed(each)); !added) return added;
  }
  if (options.sensor_maps_tiff.empty()) return {};
  return writer_.add_attachment({.name = std::string(mcap::kSensorMapsAttachment),
                                 .media_type = "image/tiff",
                                 .data = options.sensor_maps_tiff});
}

Result<void> RecordingWriter::add_frame(const FrameToRecord& frame) {
  const StepReport& step = frame.report.step;
  const bool has_odometry = step.shift.status == ShiftStatus::ok;
  mcap::encode(note_of(frame.report, frame.frame.view()), note_);
  mcap::encode_image(frame.frame.view(), image_);
  mcap::encode(step, step_);
  odometry_.clear();
  if (has_odometry) mcap::encode_odometry(step, odometry_);
  const std::size_t size_bytes = note_.size() + image_.size() + step_.size() + odometry_.size();
  if (Result<void> room = writer_.make_room(4, size_bytes); !room) return room;

  mcap::MessageHead head{.sequence = static_cast<std::uint32_t>(frame.ordinal),
                         .log_time_ns = frame.report.label.arrival_ns + wall_ns_};
  head.publish_time_ns = head.log_time_ns;
  const auto write = [&](mcap::ChannelId channel, const mcap::Bytes& message) {
    head.channel = channel;
    return writer_.write(head, message);
  };
  // The label first, so that whoever reads an image knows whose it is.
  for (const auto& [channel, message] :
       {std::pair(channels_.frame, &note_), std::pair(channels_.image, &image_),
        std::pair(channels_.step, &step_)}) {
    if (Result<void> written = write(channel, *message); !written) return written;
  }
  if (has_odometry) {
    if (Result<void> written = write(channels_.odometry, odometry_); !written) return written;
  }
  writer_.commit();
  return {};
}

bool RecordingWriter::has_room_for_dropout() const {
  return writer_.has_room(1, kBesidePixels_bytes / 64);
}

Result<void> RecordingWriter::add_dropout(const mcap::Dropout& dropout) {
  mcap::encode(dropout, note_);
  return add(channels_.dropout, dropout.last_ns);
}

Result<void> RecordingWriter::add_event(const StreamEvent& event) {
  mcap::encode(mcap::Event{.stamp_ns = event.host_ns + wall_ns_,
                           .severity = severity_of(event.severity),
                           .name = event.name,
                           .text = event.text},
               note_);
  return add(channels_.event, event.host_ns);
}

Result<void> RecordingWriter::add_health(const HealthSnapshot& health, std::int64_t host_ns) {
  mcap::encode(health, note_);
  return add(channels_.health, host_ns);
}

Result<void> RecordingWriter::add(mcap::ChannelId channel, std::int64_t host_ns) {
  const std::int64_t log_time_ns = host_ns + wall_ns_;
  if (Result<void> written = writer_.write({.channel = channel,
                                            .sequence = note_count_,
                                            .log_time_ns = log_time_ns,
                                            .publish_time_ns = log_time_ns},
                                           note_);
      !written)
    return written;
  ++note_count_;
  writer_.commit();
  return {};
}

}  // namespace lsv
