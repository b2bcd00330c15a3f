// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/mcap/messages.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdio>
#include <limits>
#include <type_traits>
#include <utility>

#include "lsv/mcap/cdr.h"
#include "lsv/mcap/message_fields.h"

namespace lsv::mcap {
namespace {

/// Variance of what is not measured, as users of nav_msgs/Odometry expect it: large, so that a
/// filter gives it no weight.
constexpr double kNotMeasured = 1e6;

constexpr std::array<std::pair<Severity, std::uint8_t>, 3> kLogLevels = {
    {{Severity::info, 20}, {Severity::warning, 30}, {Severity::error, 40}}};

void put_time(CdrWriter& out, std::int64_t ns) {
  std::int64_t seconds = ns / kNsPerS;
  std::int64_t rest_ns = ns % kNsPerS;
  if (rest_ns < 0) {
    rest_ns += kNsPerS;
    --seconds;
  }
  using Limits = std::numeric_limits<std::int32_t>;
  out.number(
      static_cast<std::int32_t>(std::clamp<std::int64_t>(seconds, Limits::min(), Limits::max())));
  out.number(static_cast<std::uint32_t>(rest_ns));
}

std::int64_t read_time(CdrReader& in) {
  const auto seconds = in.number<std::int32_t>();
  return seconds * kNsPerS + in.number<std::uint32_t>();
}

void put_header(CdrWriter& out, std::int64_t stamp_ns, std::string_view frame_id) {
  put_time(out, stamp_ns);
  out.text(frame_id);
}

template <typename Message>
void encode_fields(const Message& message, Bytes& out) {
  CdrWriter cdr(out);
  visit_fields(message, [&cdr](std::string_view, const auto& value) {
    using Value = std::remove_cvref_t<decltype(value)>;
    if constexpr (std::is_enum_v<Value>)
      cdr.text(word(value));
    else
      cdr.number(value);
  });
}

template <typename Message>
std::optional<Message> decode_fields(ByteView message) {
  CdrReader cdr(message);
  Message out;
  bool known = true;
  visit_fields(out, [&](std::string_view, auto& value) {
    using Value = std::remove_cvref_t<decltype(value)>;
    if constexpr (std::is_enum_v<Value>) {
      const std::optional<Value> read = value_of<Value>(cdr.text());
      known = known && read;
      value = read.value_or(Value{});
    } else if constexpr (std::is_same_v<Value, bool>) {
      value = cdr.boolean();
    } else {
      value = cdr.number<Value>();
    }
  });
  if (!cdr.ok() || !known) return std::nullopt;
  return out;
}

template <typename Value>
constexpr std::string_view type_name() {
  if constexpr (std::is_enum_v<Value>) return "string";
  if constexpr (std::is_same_v<Value, bool>) return "bool";
  if constexpr (std::is_same_v<Value, double>) return "float64";
  if constexpr (std::is_same_v<Value, std::int32_t>) return "int32";
  if constexpr (std::is_same_v<Value, std::int64_t>) return "int64";
  if constexpr (std::is_same_v<Value, std::uint64_t>) return "uint64";
}

template <typename Message>
Schema schema_of_fields(std::string_view type, std::string_view comment) {
  Schema schema{.name = std::string(type), .encoding = "ros2msg", .text = "# "};
  schema.text += comment;
  schema.text += '\n';
  const Message message{};
  visit_fields(message, [&schema](std::string_view name, const auto& value) {
    schema.text += type_name<std::remove_cvref_t<decltype(value)>>();
    schema.text += ' ';
    schema.text += name;
    schema.text += '\n';
  });
  return schema;
}

#define LSV_MSG \
  "================================================================================\nMSG: "
#define LSV_MSG_TIME LSV_MSG "builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n"
#define LSV_MSG_HEADER \
  LSV_MSG "std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n" LSV_MSG_TIME

constexpr const char* kImageText =
    "std_msgs/Header header\n"
    "uint32 height\n"
    "uint32 width\n"
    "string encoding\n"
    "uint8 is_bigendian\n"
    "uint32 step\n"
    "uint8[] data\n" LSV_MSG_HEADER;

constexpr const char* kOdometryText =
    "std_msgs/Header header\n"
    "string child_frame_id\n"
    "geometry_msgs/PoseWithCovariance pose\n"
    "geometry_msgs/TwistWithCovariance twist\n" LSV_MSG_HEADER LSV_MSG
    "geometry_msgs/PoseWithCovariance\n"
    "geometry_msgs/Pose pose\n"
    "float64[36] covariance\n" LSV_MSG
    "geometry_msgs/Pose\n"
    "geometry_msgs/Point position\n"
    "geometry_msgs/Quaternion orientation\n" LSV_MSG
    "geometry_msgs/Point\nfloat64 x\nfloat64 y\nfloat64 z\n" LSV_MSG
    "geometry_msgs/Quaternion\nfloat64 x\nfloat64 y\nfloat64 z\nfloat64 w\n" LSV_MSG
    "geometry_msgs/TwistWithCovariance\n"
    "geometry_msgs/Twist twist\n"
    "float64[36] covariance\n" LSV_MSG
    "geometry_msgs/Twist\n"
    "geometry_msgs/Vector3 linear\n"
    "geometry_msgs/Vector3 angular\n" LSV_MSG
    "geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n";

constexpr const char* kEventText =
    "byte DEBUG=10\n"
    "byte INFO=20\n"
    "byte WARN=30\n"
    "byte ERROR=40\n"
    "byte FATAL=50\n"
    "builtin_interfaces/Time stamp\n"
    "uint8 level\n"
    "string name\n"
    "string msg\n"
    "string file\n"
    "string function\n"
    "uint32 line\n" LSV_MSG_TIME;

#undef LSV_MSG
#undef LSV_MSG_TIME
#undef LSV_MSG_HEADER

Schema ros_schema(std::string_view type, const char* text) {
  return {.name = std::string(type), .encoding = "ros2msg", .text = text};
}

void put_covariance(CdrWriter& out, double sigma_x, double sigma_y) {
  for (int row = 0; row < 6; ++row) {
    for (int column = 0; column < 6; ++column) {
      double variance = row == column ? kNotMeasured : 0.0;
      if (row == 0 && column == 0) variance = sigma_x * sigma_x;
      if (row == 1 && column == 1) variance = sigma_y * sigma_y;
      out.number(variance);
    }
  }
}

template <typename Value>
std::string text_of_value(const Value& value) {
  if constexpr (std::is_enum_v<Value>) {
    return std::string(word(value));
  } else if constexpr (std::is_same_v<Value, double>) {
    char text[40];
    std::snprintf(text, sizeof text, "%.17g", value);
    return text;
  } else {
    return std::to_string(value);
  }
}

template <typename Value>
bool same_bits(const Value& a, const Value& b) {
  if constexpr (std::is_same_v<Value, double>) {
    return (std::isnan(a) && std::isnan(b)) ||
           std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
  } else {
    return a == b;
  }
}

/// Walks through the fields of one step while another walk stands still at the same place.
template <typename Visit>
void visit_field(const StepReport& step, int wanted, Visit&& visit) {
  int at = 0;
  visit_fields(step, [&](std::string_view, const auto& value) {
    if (at++ == wanted) visit(value);
  });
}

}  // namespace

Schema schema_of(std::string_view type) {
  if (type == kImageType) return ros_schema(type, kImageText);
  if (type == kOdometryType) return ros_schema(type, kOdometryText);
  if (type == kEventType) return ros_schema(type, kEventText);
  if (type == kFrameType)
    return schema_of_fields<FrameNote>(type,
                                       "Where the next image comes from. index and stamp_ns "
                                       "are what the odometer got, arrival_ns is on the "
                                       "host's monotonic clock.");
  if (type == kStepType)
    return schema_of_fields<StepReport>(type,
                                        "What the odometer said about a frame. Unknown "
                                        "numbers are NaN.");
  if (type == kHealthType)
    return schema_of_fields<HealthSnapshot>(type,
                                            "Counters since the start of the stream. Unknown "
                                            "durations are NaN.");
  if (type == kDropoutType)
    return schema_of_fields<Dropout>(type,
                                     "Frames that were measured but are not in the "
                                     "recording, by index and arrival.");
  return {};
}

void encode(const FrameNote& note, Bytes& out) { encode_fields(note, out); }
void encode(const StepReport& step, Bytes& out) { encode_fields(step, out); }
void encode(const HealthSnapshot& health, Bytes& out) { encode_fields(health, out); }
void encode(const Dropout& dropout, Bytes& out) { encode_fields(dropout, out); }

void encode(const Event& event, Bytes& out) {
  CdrWriter cdr(out);
  put_time(cdr, event.stamp_ns);
  for (const auto& [severity, level] : kLogLevels) {
    if (severity == event.severity) cdr.number(level);
  }
  cdr.text(event.name);
  cdr.text(event.text);
  cdr.text("");  // no place in the code
  cdr.text("");
  cdr.number(std::uint32_t{0});
}

void encode_image(const FrameView& frame, Bytes& out) {
  const std::size_t row_bytes =
      static_cast<std::size_t>(frame.width_px()) * bytes_per_pixel(frame.format.type);
  CdrWriter cdr(out);
  put_header(cdr, frame.stamp.ns, "lsv_camera");
  cdr.number(static_cast<std::uint32_t>(frame.height_px()));
  cdr.number(static_cast<std::uint32_t>(frame.width_px()));
  cdr.text(frame.format.type == PixelType::mono8 ? "mono8" : "mono16");
  cdr.number(std::uint8_t{0});
  cdr.number(static_cast<std::uint32_t>(row_bytes));
  cdr.number(static_cast<std::uint32_t>(row_bytes * static_cast<std::size_t>(frame.height_px())));
  for (int y = 0; y < frame.height_px(); ++y)
    cdr.raw({frame.data + y * frame.stride_bytes, row_bytes});
}

void encode_odometry(const StepReport& step, Bytes& out) {
  const SensorPosition& position = step.position;
  const SensorVelocity& velocity = step.velocity;
  CdrWriter cdr(out);
  put_header(cdr, step.stamp.ns, "lsv_odom");
  cdr.text("lsv_sensor");
  for (const double each : {position.x_m, position.y_m, 0.0}) cdr.number(each);
  for (const double each : {0.0, 0.0, 0.0, 1.0}) cdr.number(each);  // no rotation
  put_covariance(cdr, position.sigma_x_m, position.sigma_y_m);
  for (const double each : {velocity.vx_m_s, velocity.vy_m_s, 0.0}) cdr.number(each);
  for (const double each : {0.0, 0.0, 0.0}) cdr.number(each);
  put_covariance(cdr, velocity.sigma_vx_m_s, velocity.sigma_vy_m_s);
}

template <>
std::optional<FrameNote> decode(ByteView message) {
  return decode_fields<FrameNote>(message);
}
template <>
std::optional<StepReport> decode(ByteView message) {
  return decode_fields<StepReport>(message);
}
template <>
std::optional<HealthSnapshot> decode(ByteView message) {
  return decode_fields<HealthSnapshot>(message);
}
template <>
std::optional<Dropout> decode(ByteView message) {
  return decode_fields<Dropout>(message);
}

template <>
std::optional<Event> decode(ByteView message) {
  CdrReader cdr(message);
  Event event;
  event.stamp_ns = read_time(cdr);
  const auto level = cdr.number<std::uint8_t>();
  event.name = cdr.text();
  event.text = cdr.text();
  if (!cdr.ok()) return std::nullopt;
  for (const auto& [severity, its_level] : kLogLevels) {
    if (level >= its_level) event.severity = severity;
  }
  return event;
}

std::optional<ImageMessage> decode_image(ByteView message) {
  CdrReader cdr(message);
  ImageMessage image;
  image.stamp_ns = read_time(cdr);
  cdr.text();
  image.height_px = cdr.number<std::uint32_t>();
  image.width_px = cdr.number<std::uint32_t>();
  image.encoding = cdr.text();
  image.big_endian = cdr.boolean();
  image.step_bytes = cdr.number<std::uint32_t>();
  image.data = cdr.raw(cdr.number<std::uint32_t>());
  if (!cdr.ok()) return std::nullopt;
  return image;
}

std::string first_difference(const StepReport& recorded, const StepReport& replayed) {
  std::string difference;
  int field = 0;
  visit_fields(recorded, [&](std::string_view name, const auto& value) {
    visit_field(replayed, field++, [&](const auto& other) {
      if constexpr (std::is_same_v<decltype(value), decltype(other)>) {
        if (!difference.empty() || same_bits(value, other)) return;
        difference = name;
        difference +=
            ": " + text_of_value(value) + " recorded, " + text_of_value(other) + " replayed";
      }
    });
  });
  return difference;
}

}  // namespace lsv::mcap
