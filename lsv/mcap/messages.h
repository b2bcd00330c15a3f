// SPDX-License-Identifier: BSD-3-Clause
// What a recording of lsv says, as ROS 2 messages (CDR), and the definitions that travel with it.
//
//   /camera/frame   lsv_msgs/msg/Frame        where the next image comes from; before its image
//   /camera/image   sensor_msgs/msg/Image     the pixels as the odometer got them
//   /lsv/step       lsv_msgs/msg/Step         what the odometer answered, bit for bit
//   /odom           nav_msgs/msg/Odometry     the same for other programs, accepted shifts only
//   /lsv/health     lsv_msgs/msg/Health       about once a second
//   /lsv/events     rcl_interfaces/msg/Log    source lost, frames missing, disk full ...
//   /lsv/dropouts   lsv_msgs/msg/Dropout      frames that the recording lacks
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "lsv/core/frame.h"
#include "lsv/core/health_snapshot.h"
#include "lsv/core/step_report.h"
#include "lsv/mcap/bytes.h"
#include "lsv/mcap/records.h"

namespace lsv::mcap {

inline constexpr std::string_view kFrameTopic = "/camera/frame";
inline constexpr std::string_view kImageTopic = "/camera/image";
inline constexpr std::string_view kStepTopic = "/lsv/step";
inline constexpr std::string_view kOdometryTopic = "/odom";
inline constexpr std::string_view kHealthTopic = "/lsv/health";
inline constexpr std::string_view kEventTopic = "/lsv/events";
inline constexpr std::string_view kDropoutTopic = "/lsv/dropouts";

inline constexpr std::string_view kFrameType = "lsv_msgs/msg/Frame";
inline constexpr std::string_view kImageType = "sensor_msgs/msg/Image";
inline constexpr std::string_view kStepType = "lsv_msgs/msg/Step";
inline constexpr std::string_view kOdometryType = "nav_msgs/msg/Odometry";
inline constexpr std::string_view kHealthType = "lsv_msgs/msg/Health";
inline constexpr std::string_view kEventType = "rcl_interfaces/msg/Log";
inline constexpr std::string_view kDropoutType = "lsv_msgs/msg/Dropout";

/// Metadata by name with their entries, sealed (sealed.h), and the one attachment: the settings
/// with which a recording can be replayed by itself.
inline constexpr std::string_view kRecordingMetadata = "lsv.recording";  // id, program, source
inline constexpr std::string_view kConfigMetadata = "lsv.config";
inline constexpr std::string_view kConfigEntry = "config.toml";
inline constexpr std::string_view kCalibrationMetadata = "lsv.calibration";
inline constexpr std::string_view kCalibrationEntry = "calibration.toml";
inline constexpr std::string_view kSensorMapsAttachment = "sensor_maps.tif";

/// Where a frame comes from and what happened on the way.
struct FrameNote {
  std::int64_t index = 0;  // as given to the odometer
  std::int64_t stamp_ns = 0;
  int bit_depth = 8;
  std::uint64_t camera_id = 0;
  bool has_camera_ns = false;
  std::int64_t camera_ns = 0;   // the camera's own clock; 0 when unknown
  std::int64_t arrival_ns = 0;  // the host's monotonic clock
  bool damaged = false;
  std::int64_t missing_before = 0;
  std::int64_t dropped_before = 0;
  std::int64_t rejected_before = 0;
  bool stamp_replaced = false;
  std::int64_t latency_ns = 0;
};

enum class Severity { info, warning, error };

struct Event {
  std::int64_t stamp_ns = 0;  // wall clock: a label
  Severity severity = Severity::info;
  std::string name;
  std::string text;
};

/// Frames between two recorded ones that the odometer got and the recording did not.
struct Dropout {
  std::int64_t frames = 0;
  std::int64_t first_frame = 0;  // indices
  std::int64_t last_frame = 0;
  std::int64_t first_ns = 0;  // their arrival on the host's monotonic clock
  std::int64_t last_ns = 0;
};

/// An image of any recording; `data` points into the message.
struct ImageMessage {
  std::int64_t stamp_ns = 0;
  std::uint32_t height_px = 0;
  std::uint32_t width_px = 0;
  std::string_view encoding;
  bool big_endian = false;
  std::uint32_t step_bytes = 0;  // from row to row
  ByteView data;
};

/// Empty unless `type` is one of those above.
Schema schema_of(std::string_view type);

// Each overwrites `out`, whose memory is kept.
void encode(const FrameNote& note, Bytes& out);
void encode(const StepReport& step, Bytes& out);
void encode(const HealthSnapshot& health, Bytes& out);
void encode(const Dropout& dropout, Bytes& out);
void encode(const Event& event, Bytes& out);
void encode_image(const FrameView& frame, Bytes& out);
/// `step` must hold an accepted shift.
void encode_odometry(const StepReport& step, Bytes& out);

/// FrameNote, StepReport, HealthSnapshot, Dropout or Event; empty when the message is malformed.
template <typename Message>
std::optional<Message> decode(ByteView message);
std::optional<ImageMessage> decode_image(ByteView message);

/// The first field that is not the same bit for bit, with both values; empty when all are. An
/// unknown number equals another.
std::string first_difference(const StepReport& recorded, const StepReport& replayed);

}  // namespace lsv::mcap
