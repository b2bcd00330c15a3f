// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/camera/genicam_source.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <chrono>
#include <cstring>
#include <future>
#include <optional>
#include <thread>
#include <utility>

#include "lsv/camera/genicam_setup.h"
#include "lsv/camera/glib_handles.h"
#include "lsv/camera/mono_format.h"
#include "lsv/stream/host_clock.h"

namespace lsv {
namespace {

/// GAsyncQueue cannot be woken, so that a wait is cut into pieces of this length; without frames
/// that is 50 looks a second.
constexpr std::int64_t kWaitPiece_ns = 20'000'000;
constexpr std::int64_t kMinRetention_ns = 4'000'000;
constexpr int kRetentionPeriods = 4;
constexpr int kGonePeriods = 5;
constexpr auto kCloseWithin = std::chrono::milliseconds(300);
/// The kernel gives what net.core.rmem_max allows.
constexpr int kSocketBuffer_bytes = 1 << 22;

std::int64_t wall_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

/// Aravis stamps the first packet with the wall clock, which may be set between then and now: an
/// age that cannot be is none.
std::int64_t arrival_ns(std::uint64_t first_packet_wall_ns) {
  constexpr std::int64_t kOldest_ns = 10 * kNsPerS;
  const std::int64_t age_ns = wall_ns() - static_cast<std::int64_t>(first_packet_wall_ns);
  return host_now_ns() - (age_ns >= 0 && age_ns <= kOldest_ns ? age_ns : 0);
}

/// How the pixels of a frame lie in the buffer of the driver, from its beginning.
struct ImageLayout {
  FrameFormat format{};
  std::size_t row_padding_bytes = 0;

  std::size_t row_bytes() const {
    return static_cast<std::size_t>(format.width_px) * bytes_per_pixel(format.type);
  }
  std::size_t step_bytes() const { return row_bytes() + row_padding_bytes; }
  std::size_t bytes() const {
    return step_bytes() * static_cast<std::size_t>(format.height_px - 1) + row_bytes();
  }
};

void copy_pixels(const std::byte* from, const ImageLayout& layout, Frame& to) {
  for (int y = 0; y < layout.format.height_px; ++y, from += layout.step_bytes()) {
    std::memcpy(to.row(y), from, layout.row_bytes());
    if (std::endian::native == std::endian::big && layout.format.type == PixelType::mono16) {
      for (int x = 0; x < layout.format.width_px; ++x) {
        std::uint16_t& pixel = to.row16(y)[x];
        pixel = static_cast<std::uint16_t>(pixel << 8 | pixel >> 8);
      }
    }
  }
}

void blank(const FrameFormat& format, Frame& out) {
  out.reset(format);
  const std::size_t row_bytes =
      static_cast<std::size_t>(format.width_px) * bytes_per_pixel(format.type);
  for (int y = 0; y < format.height_px; ++y) std::memset(out.row(y), 0, row_bytes);
}

/// What a running camera consists of, taken down in this order.
struct Session {
  ObjectPtr<ArvCamera> camera;
  ObjectPtr<ArvStream> stream;
  std::atomic<bool> control_lost{false};
  bool gone = false;

  ~Session() {
    if (camera == nullptr) return;
    if (!gone && !control_lost) arv_camera_stop_acquisition(camera.get(), nullptr);
    g_signal_handlers_disconnect_by_data(arv_camera_get_device(camera.get()), this);
  }
};

void note_control_lost(ArvDevice*, gpointer session) {
  static_cast<Session*>(session)->control_lost = true;
}

class GenicamSource : public LiveSource {
 public:
  static Result<std::unique_ptr<LiveSource>> start(GenicamSetup setup,
                                                   const CameraOptions& options) {
    std::unique_ptr<GenicamSource> source(new GenicamSource(setup, options));
    if (Result<void> started = source->start_stream(std::move(setup.camera), options); !started)
      return started.error();
    return std::unique_ptr<LiveSource>(std::move(source));
  }

  GenicamSource(const GenicamSource&) = delete;
  GenicamSource& operator=(const GenicamSource&) = delete;

  /// Aravis says farewell to a camera packet by packet, each repeated for 2.5 s when nobody
  /// answers. Nobody has to wait for that.
  ~GenicamSource() override {
    std::promise<void> closed;
    std::future<void> done = closed.get_future();
    std::thread([session = std::move(session_), closed = std::move(closed)]() mutable {
      session.reset();
      closed.set_value();
    }).detach();
    done.wait_for(kCloseWithin);
  }

  const LiveSourceInfo& info() const override { return info_; }

  Result<Grab> grab(Frame& out, FrameLabel& label, std::int64_t timeout_ns) override {
    std::int64_t now_ns = host_now_ns();
    const std::int64_t deadline_ns = now_ns + std::max<std::int64_t>(timeout_ns, 0);
    while (!stopped_) {
      ArvBuffer* const buffer = pop(std::min(deadline_ns - now_ns, kWaitPiece_ns));
      now_ns = host_now_ns();
      if (buffer != nullptr) {
        const bool delivered = take(buffer, out, label);
        recycle(buffer);
        if (!delivered) continue;
        last_frame_ns_ = now_ns;
        return Grab::frame;
      }
      if (session_->control_lost || now_ns - last_frame_ns_ > gone_after_ns_) return gone(now_ns);
      if (now_ns >= deadline_ns) break;
    }
    return Grab::nothing;
  }

  void stop() override { stopped_ = true; }

  std::int64_t transport_losses() const override {
    ArvStream* const stream = session_->stream.get();
    std::uint64_t completed = 0;
    std::uint64_t failures = 0;
    std::uint64_t underruns = 0;
    arv_stream_get_statistics(stream, &completed, &failures, &underruns);
    // On a GigE stream both count packets.
    const std::uint64_t lost = ARV_IS_GV_STREAM(stream)
                                   ? arv_stream_get_info_uint64_by_name(stream, "n_missing_packets")
                                   : failures;
    return static_cast<std::int64_t>(lost + underruns);
  }

 private:
  GenicamSource(const GenicamSetup& setup, const CameraOptions& options)
      : name_(setup.name),
        info_(setup.info),
        payload_bytes_(setup.payload_bytes),
        gone_after_ns_(std::max(options.gone_after_ns, kGonePeriods * setup.info.period_ns)) {}

  Result<void> start_stream(ObjectPtr<ArvCamera> camera, const CameraOptions& options) {
    session_->camera = std::move(camera);
    ArvCamera* const device = session_->camera.get();
    // Aravis' packet socket hands packets over up to 5 ms late, and stamps them after that.
    if (arv_camera_is_gv_device(device) == TRUE)
      arv_camera_gv_set_stream_options(device, ARV_GV_STREAM_OPTION_PACKET_SOCKET_DISABLED);
    GlibError error;
    session_->stream.reset(arv_camera_create_stream(device, nullptr, nullptr, error.out()));
    if (session_->stream == nullptr || error) return failure("the stream cannot be set up", error);
    ArvStream* const stream = session_->stream.get();
    if (ARV_IS_GV_STREAM(stream)) tune(stream, options);
    for (int i = 0; i < options.buffers; ++i)
      arv_stream_push_buffer(stream, arv_buffer_new(payload_bytes_, nullptr));
    g_signal_connect(arv_camera_get_device(device), "control-lost", G_CALLBACK(note_control_lost),
                     session_.get());
    arv_camera_start_acquisition(device, error.out());
    if (error) return failure("the acquisition does not start", error);
    last_frame_ns_ = host_now_ns();
    return {};
  }

  void tune(ArvStream* stream, const CameraOptions& options) const {
    const std::int64_t retention_ns = options.frame_retention_ns.value_or(
        std::max(kMinRetention_ns, kRetentionPeriods * info_.period_ns));
    const auto us = [](std::int64_t ns) { return static_cast<guint>(ns / 1000); };
    g_object_set(stream, "socket-buffer", ARV_GV_STREAM_SOCKET_BUFFER_FIXED, "socket-buffer-size",
                 kSocketBuffer_bytes, "packet-timeout", us(options.packet_timeout_ns),
                 "frame-retention", us(retention_ns), nullptr);
  }

  Error failure(const char* what, const GlibError& error) const {
    return {ErrorCode::bad_input, name_ + ": " + what + ": " + error.text()};
  }

  ArvBuffer* pop(std::int64_t wait_ns) {
    ArvStream* const stream = session_->stream.get();
    if (wait_ns < 1000) return arv_stream_try_pop_buffer(stream);
    return arv_stream_timeout_pop_buffer(stream, static_cast<guint64>(wait_ns / 1000));
  }

  void recycle(ArvBuffer* buffer) {
    // Or else a frame whose first packet is lost shows what the one before in this buffer declared.
    arv_buffer_set_timestamp(buffer, 0);
    arv_buffer_set_system_timestamp(buffer, 0);
    arv_stream_push_buffer(session_->stream.get(), buffer);
  }

  /// False for a buffer that the driver hands back empty, and for a frame whose first packet is
  /// lost: it has neither id nor stamp nor size, and is missed by those of its neighbours.
  bool take(ArvBuffer* buffer, Frame& out, FrameLabel& label) const {
    const ArvBufferStatus status = arv_buffer_get_status(buffer);
    if (status == ARV_BUFFER_STATUS_ABORTED || status == ARV_BUFFER_STATUS_CLEARED) return false;
    if (arv_buffer_get_system_timestamp(buffer) == 0) return false;
    const bool whole = status == ARV_BUFFER_STATUS_SUCCESS;
    label = {};
    label.damaged = !copy_image(buffer, whole, out) || !whole;
    label.camera_id = arv_buffer_get_frame_id(buffer);
    label.arrival_ns = arrival_ns(arv_buffer_get_system_timestamp(buffer));
    const std::uint64_t camera_ns = arv_buffer_get_timestamp(buffer);
    if (camera_ns != 0) label.camera_ns = static_cast<std::int64_t>(camera_ns);
    return true;
  }

  /// The image that the frame declares, or else a blank one and false.
  bool copy_image(ArvBuffer* buffer, bool whole, Frame& out) const {
    const std::byte* const pixels =
        static_cast<const std::byte*>(arv_buffer_get_data(buffer, nullptr));
    // Aravis tells the layout of whole frames only.
    const std::optional<ImageLayout> layout =
        whole ? declared_layout(buffer) : ImageLayout{info_.format, 0};
    if (pixels == nullptr || !layout || layout->bytes() > payload_bytes_) {
      blank(info_.format, out);
      return false;
    }
    out.reset(layout->format);
    copy_pixels(pixels, *layout, out);
    return true;
  }

  static std::optional<ImageLayout> declared_layout(ArvBuffer* buffer) {
    const ArvBufferPayloadType type = arv_buffer_get_payload_type(buffer);
    if (type != ARV_BUFFER_PAYLOAD_TYPE_IMAGE &&
        type != ARV_BUFFER_PAYLOAD_TYPE_EXTENDED_CHUNK_DATA)
      return std::nullopt;
    const auto mono =
        mono_format(static_cast<std::uint32_t>(arv_buffer_get_image_pixel_format(buffer)));
    if (!mono) return std::nullopt;
    const FrameFormat format{.width_px = arv_buffer_get_image_width(buffer),
                             .height_px = arv_buffer_get_image_height(buffer),
                             .type = mono->type,
                             .bit_depth = mono->bit_depth};
    int padding_x_bytes = 0;
    int padding_y_bytes = 0;
    arv_buffer_get_image_padding(buffer, &padding_x_bytes, &padding_y_bytes);
    if (!is_possible(format) || padding_x_bytes < 0) return std::nullopt;
    return ImageLayout{format, static_cast<std::size_t>(padding_x_bytes)};
  }

  Error gone(std::int64_t now_ns) {
    session_->gone = true;
    return {ErrorCode::bad_input,
            name_ + ": the camera has sent nothing for " +
                std::to_string((now_ns - last_frame_ns_) / 1'000'000) +
                " ms and has to be opened anew; check its cable and its power"};
  }

  std::string name_;
  LiveSourceInfo info_;
  std::size_t payload_bytes_;
  std::int64_t gone_after_ns_;
  std::unique_ptr<Session> session_ = std::make_unique<Session>();
  std::int64_t last_frame_ns_ = 0;
  std::atomic<bool> stopped_{false};
};

}  // namespace

Result<std::unique_ptr<LiveSource>> open_genicam(const std::string& name,
                                                 const CameraOptions& options) {
  Result<GenicamSetup> setup = set_up_genicam(name, options);
  if (!setup) return setup.error();
  return GenicamSource::start(std::move(setup).value(), options);
}

}  // namespace lsv
