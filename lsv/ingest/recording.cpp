// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/ingest/recording.h"

#include <algorithm>
#include <bit>
#include <cctype>
#include <cstring>
#include <utility>

#include "lsv/mcap/byte_source.h"
#include "lsv/mcap/sealed.h"

namespace lsv {
namespace {

using mcap::Item;

void swap_bytes(std::uint16_t* row, int width_px) {
  for (int x = 0; x < width_px; ++x)
    row[x] = static_cast<std::uint16_t>((row[x] << 8U) | (row[x] >> 8U));
}

void copy_pixels(const mcap::ImageMessage& image, const FrameFormat& format, Frame& out) {
  out.reset(format);
  const std::size_t row_bytes =
      static_cast<std::size_t>(format.width_px) * bytes_per_pixel(format.type);
  for (int y = 0; y < format.height_px; ++y) {
    const std::size_t at = static_cast<std::size_t>(y) * image.step_bytes;
    std::memcpy(out.row(y), image.data.data() + at, row_bytes);
    if (format.type == PixelType::mono16 && image.big_endian)
      swap_bytes(out.row16(y), format.width_px);
  }
}

}  // namespace

bool is_recording_path(std::string_view path) {
  constexpr std::string_view kExtension = ".mcap";
  if (path.size() < kExtension.size()) return false;
  return std::ranges::equal(path.substr(path.size() - kExtension.size()), kExtension,
                            [](unsigned char a, char b) { return std::tolower(a) == b; });
}

RecordingReader::RecordingReader(std::string path, mcap::Reader reader,
                                 const RecordingOptions& options)
    : path_(std::move(path)), reader_(std::move(reader)), options_(options) {}

Result<RecordingReader> RecordingReader::open(const std::string& path,
                                              const RecordingOptions& options) {
  auto source = mcap::open_file(path);
  if (!source) return source.error();
  Result<mcap::Reader> reader = mcap::Reader::open(std::move(source).value(), options.damage);
  if (!reader) return reader.error();
  return RecordingReader(path, std::move(reader).value(), options);
}

Error RecordingReader::wrong(const std::string& what) const {
  return {ErrorCode::bad_input, path_ + ", image " + std::to_string(images_) + ": " + what};
}

Result<bool> RecordingReader::next(RecordedFrame& out) {
  Result<bool> found = find_image(out);
  if (!found || !found.value()) return found;
  if (!out.has_note) return true;
  if (Result<void> done = find_step(out); !done) return done.error();
  return true;
}

Result<bool> RecordingReader::find_image(RecordedFrame& out) {
  for (;;) {
    if (!std::exchange(at_message_, false)) {
      const Result<Item> item = reader_.next();
      if (!item) return item.error();
      if (item.value() == Item::end) return false;
      if (item.value() == Item::metadata) {
        if (Result<void> taken = take_metadata(reader_.metadata()); !taken) return taken.error();
        continue;
      }
      if (item.value() == Item::attachment) {
        if (reader_.attachment().name == mcap::kSensorMapsAttachment)
          notes_.sensor_maps_tiff = reader_.attachment().data;
        continue;
      }
    }
    const Result<bool> is_image = take_message();
    if (!is_image) return is_image.error();
    if (!is_image.value()) continue;
    if (Result<void> taken = take_image(out); !taken) return taken.error();
    return true;
  }
}

/// Up to the step that belongs to the image, if there is one.
Result<void> RecordingReader::find_step(RecordedFrame& out) {
  out.step.reset();
  for (;;) {
    const Result<Item> item = reader_.next();
    if (!item) return item.error();
    if (item.value() == Item::end) return {};
    if (item.value() != Item::message) continue;
    const mcap::Message& message = reader_.message();
    const std::string& topic = message.channel->topic;
    if (topic == mcap::kFrameTopic || topic == mcap::kImageTopic) {
      at_message_ = true;
      return {};
    }
    if (topic != mcap::kStepTopic || message.sequence != out.ordinal) {
      if (Result<bool> taken = take_message(); !taken) return taken.error();
      continue;
    }
    ++notes_.topics[topic].messages;
    notes_.topics[topic].type = message.channel->schema.name;
    out.step = mcap::decode<StepReport>(message.payload);
    if (!out.step) return wrong("what the odometer said is malformed");
    return {};
  }
}

/// Whether the message is an image of the topic that is read.
Result<bool> RecordingReader::take_message() {
  const mcap::Message& message = reader_.message();
  const mcap::Channel& channel = *message.channel;
  RecordingNotes::Topic& topic = notes_.topics[channel.topic];
  topic.type = channel.schema.name;
  ++topic.messages;
  if (channel.message_encoding != "cdr") return false;
  if (channel.schema.name == mcap::kImageType) {
    if (notes_.image_topic.empty()) notes_.image_topic = channel.topic;
    return notes_.image_topic == channel.topic;
  }
  if (channel.schema.name == mcap::kFrameType) {
    next_note_ = mcap::decode<mcap::FrameNote>(message.payload);
    if (!next_note_) return wrong("the label of a frame is malformed");
  } else if (channel.schema.name == mcap::kDropoutType) {
    const auto dropout = mcap::decode<mcap::Dropout>(message.payload);
    if (!dropout) return wrong("a dropout is malformed");
    ++notes_.dropouts;
    notes_.frames_dropped += dropout->frames;
  } else if (channel.topic == mcap::kEventTopic && channel.schema.name == mcap::kEventType) {
    const auto event = mcap::decode<mcap::Event>(message.payload);
    if (!event) return wrong("an event is malformed");
    ++notes_.event_count;
    notes_.events.push_back(*event);
    if (notes_.events.size() > kMaxEvents) notes_.events.pop_front();
  } else if (channel.schema.name == mcap::kHealthType) {
    notes_.last_health = mcap::decode<HealthSnapshot>(message.payload);
    if (!notes_.last_health) return wrong("a health message is malformed");
  }
  return false;
}

Result<FrameFormat> RecordingReader::format_of(const mcap::ImageMessage& image) const {
  FrameFormat format;
  if (image.encoding == "mono8" || image.encoding == "8UC1") {
    format.type = PixelType::mono8;
    format.bit_depth = 8;
  } else if (image.encoding == "mono16" || image.encoding == "16UC1") {
    format.type = PixelType::mono16;
    format.bit_depth = options_.bit_depth.value_or(16);
  } else {
    return Error{ErrorCode::unsupported,
                 wrong("its encoding is " + std::string(image.encoding.substr(0, 30)) +
                       ", but lsv reads mono8 and mono16")
                     .message};
  }
  if (image.width_px == 0 || image.height_px == 0) return wrong("it has no pixels");
  const std::uint64_t pixels = std::uint64_t{image.width_px} * image.height_px;
  if (pixels > static_cast<std::uint64_t>(options_.max_pixels))
    return wrong("its " + std::to_string(image.width_px) + " x " + std::to_string(image.height_px) +
                 " px are more than lsv reads");
  const std::uint64_t row_bytes = std::uint64_t{image.width_px} * bytes_per_pixel(format.type);
  if (image.step_bytes < row_bytes ||
      image.data.size() < std::uint64_t{image.step_bytes} * (image.height_px - 1) + row_bytes)
    return wrong("it has fewer pixels than it says");
  format.width_px = static_cast<int>(image.width_px);
  format.height_px = static_cast<int>(image.height_px);
  return format;
}

Result<void> RecordingReader::take_image(RecordedFrame& out) {
  const mcap::Message& message = reader_.message();
  const std::optional<mcap::ImageMessage> image = mcap::decode_image(message.payload);
  if (!image) return wrong("it is malformed");
  Result<FrameFormat> format = format_of(*image);
  if (!format) return format.error();
  const std::optional<mcap::FrameNote> note = std::exchange(next_note_, std::nullopt);
  if (note) {
    format.value().bit_depth = note->bit_depth;
    if (!is_possible(format.value()))
      return wrong("its label says " + std::to_string(note->bit_depth) + " bit, which cannot be");
  }
  copy_pixels(*image, format.value(), out.frame);
  out.ordinal = message.sequence;
  out.has_note = note.has_value();
  out.note = note.value_or(mcap::FrameNote{});
  out.step.reset();
  if (!images_have_stamps_) images_have_stamps_ = image->stamp_ns != 0;
  out.frame.index = note ? note->index : images_;
  out.frame.stamp.ns = note                   ? note->stamp_ns
                       : *images_have_stamps_ ? image->stamp_ns
                                              : message.log_time_ns;
  ++images_;
  return {};
}

Result<void> RecordingReader::take_metadata(const mcap::Metadata& metadata) {
  const bool is_ours = metadata.name == mcap::kRecordingMetadata ||
                       metadata.name == mcap::kConfigMetadata ||
                       metadata.name == mcap::kCalibrationMetadata;
  if (!is_ours) return {};
  if (!mcap::is_sealed(metadata)) {
    if (options_.damage == mcap::Damage::skip) return {};
    return Error{ErrorCode::bad_input, path_ + ": the metadata " + metadata.name + " are damaged"};
  }
  const auto entry = [&metadata](std::string_view key) {
    const auto found = metadata.entries.find(key);
    return found == metadata.entries.end() ? std::string() : found->second;
  };
  if (metadata.name == mcap::kRecordingMetadata) {
    notes_.program = entry("program");
    notes_.source = entry("source");
  } else if (metadata.name == mcap::kConfigMetadata) {
    notes_.config_toml = entry(mcap::kConfigEntry);
  } else {
    notes_.calibration_toml = entry(mcap::kCalibrationEntry);
  }
  return {};
}

}  // namespace lsv
