// SPDX-License-Identifier: BSD-3-Clause
#include "tools/camera_simulator/gige_camera.h"

#include <arv.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <mutex>
#include <thread>
#include <utility>

#include "tools/camera_simulator/pixel_checksum.h"

namespace lsv::cli {
namespace {

constexpr std::size_t kNotesAhead = 4096;

std::int64_t read_register(ArvFakeCamera* camera, guint32 address) {
  guint32 value = 0;
  arv_fake_camera_read_register(camera, address, &value);
  return value;
}

Roi region_of(ArvFakeCamera* camera) {
  const auto px = [camera](guint32 address) {
    return static_cast<int>(read_register(camera, address));
  };
  return {.x_px = px(ARV_FAKE_CAMERA_REGISTER_X_OFFSET),
          .y_px = px(ARV_FAKE_CAMERA_REGISTER_Y_OFFSET),
          .width_px = px(ARV_FAKE_CAMERA_REGISTER_WIDTH),
          .height_px = px(ARV_FAKE_CAMERA_REGISTER_HEIGHT)};
}

guint32 wire_format(const FrameFormat& format) {
  return format.type == PixelType::mono8 ? ARV_PIXEL_FORMAT_MONO_8 : ARV_PIXEL_FORMAT_MONO_16;
}

}  // namespace

struct GigeCamera::Body {
  Body(const GigeCameraConfig& with, const Exposures& of) : config(with), exposures(of) {
    notes.reserve(kNotesAhead);
  }

  GigeCameraConfig config;
  const Exposures& exposures;
  ArvGvFakeCamera* camera = nullptr;

  // of the camera's thread
  std::int64_t first_slot = -1;
  std::int64_t last_slot = -1;

  std::mutex notes_mutex;
  std::vector<SentFrame> notes;

  /// The number of the exposure that is due now, and its time on the grid.
  struct Due {
    std::int64_t exposure;
    std::int64_t grid_ns;
  };
  Due due(ArvFakeCamera* fake) {
    const std::int64_t period_us = std::max<std::int64_t>(
        1, read_register(fake, ARV_FAKE_CAMERA_REGISTER_ACQUISITION_FRAME_PERIOD_US));
    // Never the same slot twice, also when the wall clock is set back.
    const std::int64_t slot = std::max(last_slot + 1, g_get_real_time() / period_us);
    last_slot = slot;
    if (first_slot < 0) first_slot = slot;
    return {slot - first_slot, slot * period_us * 1000};
  }

  void expose(ArvBuffer* buffer, ArvPixelFormat format) {
    ArvFakeCamera* const fake = arv_gv_fake_camera_get_fake_camera(camera);
    const Due now = due(fake);
    const std::int64_t delay_ns = exposures.delay_ns(now.exposure);
    if (delay_ns > 0) std::this_thread::sleep_for(std::chrono::nanoseconds(delay_ns));

    const FrameView frame = exposures.frame(now.exposure);
    const TrueShift at = exposures.position(now.exposure);
    SentFrame sent{.camera_id = static_cast<std::int64_t>(arv_buffer_get_frame_id(buffer)),
                   .stamp_ns = now.grid_ns + delay_ns,
                   .exposure = now.exposure,
                   .x_px = at.dx_px,
                   .y_px = at.dy_px};
    arv_buffer_set_timestamp(buffer, static_cast<guint64>(sent.stamp_ns));
    // The size that Aravis tells here is 0; the memory is that of the region in this format.
    auto* const pixels =
        static_cast<std::byte*>(const_cast<void*>(arv_buffer_get_data(buffer, nullptr)));
    const Roi region = region_of(fake);
    if (format == wire_format(frame.format) && contains(frame.format, region)) {
      const FrameView sent_frame = write_pixels(crop(frame, region), pixels);
      disturb_one_pixel(now.exposure, sent_frame.format, pixels);
      sent.checksum = pixel_checksum(sent_frame);
    }
    const std::lock_guard<std::mutex> lock(notes_mutex);
    notes.push_back(sent);
  }

  /// The frame as it now lies at `out`, without gaps.
  static FrameView write_pixels(const FrameView& frame, std::byte* out) {
    const std::size_t row_bytes =
        static_cast<std::size_t>(frame.width_px()) * bytes_per_pixel(frame.format.type);
    FrameView written = frame;
    written.data = out;
    written.stride_bytes = static_cast<std::ptrdiff_t>(row_bytes);
    for (int y = 0; y < frame.height_px(); ++y, out += row_bytes)
      std::memcpy(out, frame.data + y * frame.stride_bytes, row_bytes);
    return written;
  }

  /// The rendered frames come again and again, but a camera with noise never sends the same frame
  /// twice, and one that does counts as frozen.
  static void disturb_one_pixel(std::int64_t exposure, const FrameFormat& format,
                                std::byte* pixels) {
    const std::int64_t count = std::int64_t{format.width_px} * format.height_px;
    const auto low_byte = static_cast<std::size_t>(exposure % count) * bytes_per_pixel(format.type);
    pixels[low_byte] ^= std::byte{1};
  }

  static void fill(ArvBuffer* buffer, void* body, guint32 /*exposure_time_us*/, guint32 /*gain*/,
                   ArvPixelFormat format) {
    static_cast<Body*>(body)->expose(buffer, format);
  }

  void set_registers() {
    ArvFakeCamera* const fake = arv_gv_fake_camera_get_fake_camera(camera);
    const FrameFormat& format = exposures.format();
    const std::pair<guint32, guint32> registers[] = {
        {ARV_FAKE_CAMERA_REGISTER_SENSOR_WIDTH, static_cast<guint32>(format.width_px)},
        {ARV_FAKE_CAMERA_REGISTER_SENSOR_HEIGHT, static_cast<guint32>(format.height_px)},
        {ARV_FAKE_CAMERA_REGISTER_WIDTH, static_cast<guint32>(format.width_px)},
        {ARV_FAKE_CAMERA_REGISTER_HEIGHT, static_cast<guint32>(format.height_px)},
        {ARV_FAKE_CAMERA_REGISTER_PIXEL_FORMAT, wire_format(format)},
        {ARV_FAKE_CAMERA_REGISTER_ACQUISITION_FRAME_PERIOD_US,
         static_cast<guint32>(std::lround(1e6 / config.rate_hz))}};
    for (const auto& [address, value] : registers)
      arv_fake_camera_write_register(fake, address, value);
    arv_fake_camera_set_fill_pattern(fake, &Body::fill, this);
  }
};

GigeCamera::GigeCamera(const GigeCameraConfig& config, const Exposures& exposures)
    : body_(std::make_unique<Body>(config, exposures)) {}

GigeCamera::~GigeCamera() { unplug(); }

Result<void> GigeCamera::plug_in() {
  unplug();
  const GigeCameraConfig& config = body_->config;
  body_->camera = static_cast<ArvGvFakeCamera*>(g_object_new(
      ARV_TYPE_GV_FAKE_CAMERA, "interface-name", config.address.c_str(), "serial-number",
      config.serial.c_str(), "gvsp-lost-ratio", config.packet_loss_ratio, nullptr));
  if (arv_gv_fake_camera_is_running(body_->camera) == FALSE) {
    unplug();
    return Error{ErrorCode::invalid_argument,
                 "no camera can be at " + config.address +
                     ": another one is there (UDP port 3956 is taken), or no network interface has "
                     "this address; `ip addr add " +
                     config.address + "/8 dev lo`, as root, gives it to the loopback"};
  }
  body_->set_registers();
  return {};
}

void GigeCamera::unplug() {
  if (body_->camera == nullptr) return;
  g_object_unref(body_->camera);
  body_->camera = nullptr;
}

std::vector<SentFrame> GigeCamera::take_sent() {
  std::vector<SentFrame> next;
  next.reserve(kNotesAhead);
  const std::lock_guard<std::mutex> lock(body_->notes_mutex);
  std::swap(next, body_->notes);
  return next;
}

}  // namespace lsv::cli
