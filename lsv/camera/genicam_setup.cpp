// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/camera/genicam_setup.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <utility>
#include <vector>

#include "lsv/camera/genicam_list.h"
#include "lsv/camera/gige_probe.h"
#include "lsv/camera/mono_format.h"

namespace lsv {
namespace {

constexpr double kRateTolerance_ratio = 0.01;
constexpr double kMinRate_hz = 1e-3;
constexpr double kMaxRate_hz = 1e6;

Error refused(const std::string& name, const std::string& why) {
  return {ErrorCode::invalid_argument, name + ": " + why};
}

Error unreachable(const std::string& name, const std::string& why) {
  return {ErrorCode::bad_input, name + ": " + why};
}

std::string number(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

std::string region_text(const Roi& region) {
  return std::to_string(region.width_px) + "x" + std::to_string(region.height_px) + " at (" +
         std::to_string(region.x_px) + ", " + std::to_string(region.y_px) + ")";
}

/// What to give to Aravis: an address where there is one, because by address it opens in
/// milliseconds and by identity it looks for all cameras, which takes a second.
Result<std::string> find_camera(const std::string& wanted, const std::string& name) {
  const std::vector<GenicamCamera> cameras = list_genicam_cameras();
  std::string known;
  for (const GenicamCamera& camera : cameras) {
    if (wanted.empty() || wanted == camera.id || wanted == camera.serial)
      return camera.protocol == "GigEVision" ? camera.address : camera.id;
    known += (known.empty() ? "" : ", ") + camera.id + " at " + camera.address;
  }
  return unreachable(
      name, "there is no such camera; " + (known.empty() ? std::string("no GenICam camera answers")
                                                         : "these answer: " + known));
}

Result<ObjectPtr<ArvCamera>> take_control(const std::string& where, const std::string& name) {
  const Error held = unreachable(
      name, "another program controls this camera; close it, or wait 3 s if it has crashed");
  switch (probe_gige(where)) {
    case GigeAnswer::silent:
      return unreachable(
          name, "no camera answers at " + where + "; check its cable, its power and the address");
    case GigeAnswer::controlled:
      return held;
    case GigeAnswer::free:
    case GigeAnswer::no_address:
      break;
  }
  GlibError error;
  ObjectPtr<ArvCamera> camera(arv_camera_new(where.c_str(), error.out()));
  if (camera == nullptr || error)
    return unreachable(name, "the camera cannot be opened: " + error.text());
  // Aravis opens a camera that it does not control, too, and lets every later call fail.
  ArvDevice* const device = arv_camera_get_device(camera.get());
  if (ARV_IS_GV_DEVICE(device) && arv_gv_device_is_controller(ARV_GV_DEVICE(device)) == FALSE)
    return held;
  return camera;
}

Result<void> set_region(ArvCamera* camera, const std::string& name, const Roi& region) {
  if (region.x_px < 0 || region.y_px < 0 || region.width_px < 1 || region.height_px < 1)
    return refused(name, "the region " + region_text(region) + " is not possible");
  GlibError error;
  int sensor_width_px = 0;
  int sensor_height_px = 0;
  arv_camera_get_sensor_size(camera, &sensor_width_px, &sensor_height_px, error.out());
  const FrameFormat sensor{.width_px = sensor_width_px, .height_px = sensor_height_px};
  if (!error && !contains(sensor, region)) {
    return refused(name, "the region " + region_text(region) + " is not inside the sensor of " +
                             std::to_string(sensor_width_px) + "x" +
                             std::to_string(sensor_height_px) + " px");
  }
  arv_camera_set_region(camera, region.x_px, region.y_px, region.width_px, region.height_px,
                        error.out());
  if (error) return refused(name, "the region cannot be set: " + error.text());
  Roi got;
  arv_camera_get_region(camera, &got.x_px, &got.y_px, &got.width_px, &got.height_px, error.out());
  if (error) return unreachable(name, "the region cannot be read: " + error.text());
  if (!(got == region)) {
    return refused(name, "the camera makes the region " + region_text(got) + " of " +
                             region_text(region) + "; ask for one that fits its steps");
  }
  return {};
}

Result<void> set_rate(ArvCamera* camera, const std::string& name, double rate_hz) {
  if (!(rate_hz >= kMinRate_hz && rate_hz <= kMaxRate_hz))
    return refused(name, "the rate is " + number(rate_hz) + " Hz but must be in [0.001, 1e6]");
  GlibError error;
  arv_camera_set_frame_rate(camera, rate_hz, error.out());
  if (error)
    return refused(
        name, "AcquisitionFrameRate cannot be set to " + number(rate_hz) + " Hz: " + error.text());
  const double got_hz = arv_camera_get_frame_rate(camera, error.out());
  if (error) return unreachable(name, "AcquisitionFrameRate cannot be read: " + error.text());
  if (!(std::abs(got_hz - rate_hz) <= kRateTolerance_ratio * rate_hz)) {
    return refused(name, "AcquisitionFrameRate is " + number(got_hz) + " Hz where " +
                             number(rate_hz) +
                             " Hz was asked for; a smaller region or a shorter exposure may help");
  }
  return {};
}

Result<void> set_exposure(ArvCamera* camera, const std::string& name, double exposure_s) {
  if (!(exposure_s > 0.0 && exposure_s <= 60.0))
    return refused(name, "the exposure is " + number(exposure_s) + " s but must be in (0, 60]");
  GlibError error;
  if (arv_camera_is_exposure_auto_available(camera, nullptr) == TRUE)
    arv_camera_set_exposure_time_auto(camera, ARV_AUTO_OFF, error.out());
  if (error) return refused(name, "ExposureAuto cannot be switched off: " + error.text());
  arv_camera_set_exposure_time(camera, exposure_s * 1e6, error.out());
  if (error)
    return refused(
        name, "ExposureTime cannot be set to " + number(exposure_s * 1e6) + " us: " + error.text());
  return {};
}

Result<void> set_features(ArvCamera* camera, const std::string& name,
                          const CameraOptions& options) {
  GlibError error;
  if (options.region) {
    if (Result<void> done = set_region(camera, name, *options.region); !done) return done;
  }
  if (!options.pixel_format.empty()) {
    if (!mono_format(options.pixel_format)) {
      return refused(name, "the pixel format is " + options.pixel_format + " but lsv reads " +
                               mono_format_names());
    }
    arv_camera_set_pixel_format_from_string(camera, options.pixel_format.c_str(), error.out());
    if (error)
      return refused(name,
                     "PixelFormat cannot be set to " + options.pixel_format + ": " + error.text());
  }
  // The exposure first: it may bound the rate.
  if (options.exposure_s) {
    if (Result<void> done = set_exposure(camera, name, *options.exposure_s); !done) return done;
  }
  if (options.rate_hz) {
    if (Result<void> done = set_rate(camera, name, *options.rate_hz); !done) return done;
  }
  arv_camera_set_acquisition_mode(camera, ARV_ACQUISITION_MODE_CONTINUOUS, error.out());
  if (error) return refused(name, "AcquisitionMode cannot be set to Continuous: " + error.text());
  if (options.packet_size_bytes && arv_camera_is_gv_device(camera) == TRUE) {
    arv_camera_gv_set_packet_size(camera, *options.packet_size_bytes, error.out());
    if (error)
      return refused(name, "GevSCPSPacketSize cannot be set to " +
                               std::to_string(*options.packet_size_bytes) + ": " + error.text());
  }
  return {};
}

/// The ids of GigE Vision have 16 bits and skip 0, unless the camera counts in 64.
void describe_ids(ArvCamera* camera, LiveSourceInfo& info) {
  if (arv_camera_is_gv_device(camera) == FALSE) return;
  info.id_skips_zero = true;
  info.id_bits = 16;
  constexpr const char* kExtended = "GevGVSPExtendedIDMode";
  if (arv_camera_is_feature_available(camera, kExtended, nullptr) == FALSE) return;
  const char* const mode = arv_camera_get_string(camera, kExtended, nullptr);
  if (mode != nullptr && std::string(mode) == "On") info.id_bits = 64;
}

Result<FrameFormat> read_format(ArvCamera* camera, const std::string& name) {
  GlibError error;
  const char* const pixels = arv_camera_get_pixel_format_as_string(camera, error.out());
  if (error || pixels == nullptr)
    return unreachable(name, "PixelFormat cannot be read: " + error.text());
  const std::optional<MonoFormat> mono = mono_format(std::string_view(pixels));
  if (!mono) {
    return Error{ErrorCode::unsupported, name + ": the camera sends " + pixels + " but lsv reads " +
                                             mono_format_names() + "; ask for one of them"};
  }
  Roi region;
  arv_camera_get_region(camera, &region.x_px, &region.y_px, &region.width_px, &region.height_px,
                        error.out());
  if (error) return unreachable(name, "the region cannot be read: " + error.text());
  return FrameFormat{.width_px = region.width_px,
                     .height_px = region.height_px,
                     .type = mono->type,
                     .bit_depth = mono->bit_depth};
}

Result<std::int64_t> read_period_ns(ArvCamera* camera, const std::string& name,
                                    const CameraOptions& options) {
  const double rate_hz = arv_camera_get_frame_rate(camera, nullptr);
  const double known_hz = rate_hz > 0.0 ? rate_hz : options.rate_hz.value_or(0.0);
  if (!(known_hz >= kMinRate_hz && known_hz <= kMaxRate_hz))
    return refused(name, "the camera does not tell its frame rate; give the one it runs at");
  return std::llround(static_cast<double>(kNsPerS) / known_hz);
}

Result<void> read_back(GenicamSetup& setup, const CameraOptions& options) {
  ArvCamera* const camera = setup.camera.get();
  Result<FrameFormat> format = read_format(camera, setup.name);
  if (!format) return format.error();
  Result<std::int64_t> period_ns = read_period_ns(camera, setup.name, options);
  if (!period_ns) return period_ns.error();
  GlibError error;
  setup.payload_bytes = arv_camera_get_payload(camera, error.out());
  if (error) return unreachable(setup.name, "PayloadSize cannot be read: " + error.text());
  const auto text = [](const char* from) { return std::string(from != nullptr ? from : "?"); };
  setup.info.description = "GenICam camera " + text(arv_camera_get_vendor_name(camera, nullptr)) +
                           " " + text(arv_camera_get_model_name(camera, nullptr)) + " " +
                           text(arv_camera_get_device_serial_number(camera, nullptr));
  setup.info.format = format.value();
  setup.info.period_ns = period_ns.value();
  describe_ids(camera, setup.info);
  return {};
}

Result<void> validate(const std::string& name, const CameraOptions& options) {
  if (options.buffers < 2 || options.buffers > 4096)
    return refused(name, "the number of buffers is " + std::to_string(options.buffers) +
                             " but must be in [2, 4096]");
  if (options.packet_size_bytes &&
      (*options.packet_size_bytes < 220 || *options.packet_size_bytes > 16000))
    return refused(name, "the packet size is " + std::to_string(*options.packet_size_bytes) +
                             " but must be in [220, 16000]");
  constexpr std::int64_t kMaxWait_ns = 10 * kNsPerS;
  // Below 1 ms Aravis would wait for 0 ms, which is to spin.
  if (options.packet_timeout_ns < kNsPerS / 1000 || options.packet_timeout_ns > kMaxWait_ns)
    return refused(name, "the packet time-out must be between 1 ms and 10 s");
  if (options.frame_retention_ns &&
      (*options.frame_retention_ns < kNsPerS / 1000 || *options.frame_retention_ns > kMaxWait_ns))
    return refused(name, "the frame retention must be between 1 ms and 10 s");
  return {};
}

}  // namespace

Result<GenicamSetup> set_up_genicam(const std::string& name, const CameraOptions& options) {
  GenicamSetup setup;
  setup.name = "genicam:" + name;
  if (Result<void> valid = validate(setup.name, options); !valid) return valid.error();
  std::string where = name;
  if (probe_gige(name) == GigeAnswer::no_address) {
    Result<std::string> found = find_camera(name, setup.name);
    if (!found) return found.error();
    where = found.value();
  }
  Result<ObjectPtr<ArvCamera>> camera = take_control(where, setup.name);
  if (!camera) return camera.error();
  setup.camera = std::move(camera).value();
  if (Result<void> done = set_features(setup.camera.get(), setup.name, options); !done)
    return done.error();
  if (Result<void> done = read_back(setup, options); !done) return done.error();
  setup.info.description += " at " + where;
  return setup;
}

}  // namespace lsv
