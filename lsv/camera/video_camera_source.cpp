// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/camera/video_camera_source.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <functional>
#include <future>
#include <opencv2/videoio.hpp>
#include <optional>
#include <thread>
#include <utility>

#include "lsv/camera/frame_mailbox.h"
#include "lsv/stream/host_clock.h"

namespace lsv {
namespace {

constexpr auto kCloseWithin = std::chrono::milliseconds(300);
constexpr std::int64_t kFirstFrameWithin_ns = 5 * kNsPerS;
constexpr int kGonePeriods = 5;
constexpr double kRateTolerance_ratio = 0.01;

/// What is special about one kind of camera.
struct Kind {
  std::string name;         // for messages: "v4l:/dev/video0"
  std::string description;  // "Video4Linux camera /dev/video0"
  std::function<bool(cv::VideoCapture&)> open;
  bool driver_stamps = false;
  bool ends = false;  // rather than having to be opened anew
};

/// Of the thread that waits for OpenCV, which may be stuck there when the source is long gone.
struct Capture {
  explicit Capture(std::size_t places) : mailbox(places) {}

  cv::VideoCapture video;
  FrameMailbox mailbox;
  std::promise<double> opened;  // the rate that is told, 0 when none is; an exception: not opened
  std::atomic<std::int64_t> lost{0};
  std::atomic<bool> stop{false};
};

void capture_frames(Capture& capture, bool driver_stamps) {
  for (std::uint64_t id = 0; !capture.stop && capture.video.grab(); ++id) {
    const std::int64_t arrival_ns = host_now_ns();
    MailedImage* const place = capture.mailbox.free_place();
    if (place == nullptr) {
      ++capture.lost;
      continue;
    }
    place->label = {.camera_id = id, .camera_ns = arrival_ns, .arrival_ns = arrival_ns};
    if (driver_stamps) {
      const double stamp_ms = capture.video.get(cv::CAP_PROP_POS_MSEC);
      if (stamp_ms > 0.0) place->label.camera_ns = std::llround(stamp_ms * 1e6);
    }
    place->label.damaged = !capture.video.retrieve(place->image);
    capture.mailbox.post();
  }
}

void run_capture(const std::shared_ptr<Capture>& capture, const Kind& kind) {
  try {
    if (!kind.open(capture->video)) throw std::runtime_error("it cannot be opened");
    capture->opened.set_value(capture->video.get(cv::CAP_PROP_FPS));
  } catch (...) {
    capture->opened.set_exception(std::current_exception());
    return;
  }
  try {
    capture_frames(*capture, kind.driver_stamps);
  } catch (const std::exception&) {
    // The stream has broken off; the reader sees the end.
  }
  capture->mailbox.close();
}

std::optional<FrameFormat> format_of(const cv::Mat& image) {
  if (image.empty() || image.channels() != 1) return std::nullopt;
  const FrameFormat size{.width_px = image.cols, .height_px = image.rows};
  if (image.depth() == CV_8U) return size;
  if (image.depth() != CV_16U) return std::nullopt;
  return FrameFormat{size.width_px, size.height_px, PixelType::mono16, 16};
}

void copy_pixels(const cv::Mat& from, const FrameFormat& format, Frame& to) {
  to.reset(format);
  const std::size_t row_bytes =
      static_cast<std::size_t>(format.width_px) * bytes_per_pixel(format.type);
  for (int y = 0; y < format.height_px; ++y) std::memcpy(to.row(y), from.ptr(y), row_bytes);
}

class VideoCameraSource : public LiveSource {
 public:
  static Result<std::unique_ptr<LiveSource>> open(const Kind& kind, const CameraOptions& options) {
    if (options.buffers < 2 || options.buffers > 4096)
      return Error{ErrorCode::invalid_argument, kind.name + ": the number of buffers is " +
                                                    std::to_string(options.buffers) +
                                                    " but must be in [2, 4096]"};
    std::unique_ptr<VideoCameraSource> source(new VideoCameraSource(kind, options));
    if (Result<void> opened = source->await_opening(options); !opened) return opened.error();
    if (Result<void> first = source->await_first_frame(options); !first) return first.error();
    return std::unique_ptr<LiveSource>(std::move(source));
  }

  VideoCameraSource(const VideoCameraSource&) = delete;
  VideoCameraSource& operator=(const VideoCameraSource&) = delete;

  ~VideoCameraSource() override {
    capture_->stop = true;
    if (finished_.wait_for(kCloseWithin) == std::future_status::ready) {
      thread_.join();
    } else {
      thread_.detach();
    }
  }

  const LiveSourceInfo& info() const override { return info_; }

  Result<Grab> grab(Frame& out, FrameLabel& label, std::int64_t timeout_ns) override {
    const MailedImage* const mail = capture_->mailbox.wait(std::max<std::int64_t>(timeout_ns, 0));
    const std::int64_t now_ns = host_now_ns();
    if (mail == nullptr) return without_frame(now_ns);
    last_frame_ns_ = now_ns;
    label = mail->label;
    if (const std::optional<FrameFormat> format = format_of(mail->image)) {
      copy_pixels(mail->image, *format, out);
    } else {
      label.damaged = true;
      out.reset(info_.format);
    }
    capture_->mailbox.done();
    return Grab::frame;
  }

  void stop() override { capture_->mailbox.wake(); }

  std::int64_t transport_losses() const override { return capture_->lost; }

 private:
  VideoCameraSource(const Kind& kind, const CameraOptions& options)
      : kind_(kind),
        capture_(std::make_shared<Capture>(static_cast<std::size_t>(options.buffers))) {
    std::promise<void> finished;
    finished_ = finished.get_future();
    thread_ = std::thread([capture = capture_, kind, finished = std::move(finished)]() mutable {
      run_capture(capture, kind);
      finished.set_value();
    });
  }

  Error failure(ErrorCode code, const std::string& why) const {
    return {code, kind_.name + ": " + why};
  }

  Result<void> await_opening(const CameraOptions& options) {
    std::future<double> opened = capture_->opened.get_future();
    if (opened.wait_for(std::chrono::nanoseconds(kFirstFrameWithin_ns)) !=
        std::future_status::ready)
      return failure(ErrorCode::bad_input, "it does not open within 5 s");
    double rate_hz = 0.0;
    try {
      rate_hz = opened.get();
    } catch (const std::exception& error) {
      return failure(ErrorCode::bad_input, error.what());
    }
    if (!(rate_hz > 0.0)) rate_hz = options.rate_hz.value_or(0.0);
    if (!(rate_hz >= 1e-3 && rate_hz <= 1e6))
      return failure(ErrorCode::invalid_argument,
                     "it does not tell its frame rate; give the one it runs at");
    info_.period_ns = std::llround(static_cast<double>(kNsPerS) / rate_hz);
    if (kind_.driver_stamps && options.rate_hz &&
        !(std::abs(rate_hz - *options.rate_hz) <= kRateTolerance_ratio * *options.rate_hz)) {
      return failure(ErrorCode::invalid_argument,
                     "it runs at " + std::to_string(rate_hz) + " Hz where " +
                         std::to_string(*options.rate_hz) + " Hz was asked for");
    }
    gone_after_ns_ = std::max(options.gone_after_ns, kGonePeriods * info_.period_ns);
    return {};
  }

  /// OpenCV tells the format of the pixels only with the pixels.
  Result<void> await_first_frame(const CameraOptions& options) {
    const MailedImage* const first = capture_->mailbox.wait(kFirstFrameWithin_ns);
    if (first == nullptr) return failure(ErrorCode::bad_input, "no frame has come within 5 s");
    const std::optional<FrameFormat> format = format_of(first->image);
    if (!format) {
      return failure(ErrorCode::unsupported,
                     "the frames are not grey; ask for the pixel format Mono8, or end a GStreamer "
                     "pipeline in videoconvert ! video/x-raw,format=GRAY8");
    }
    info_.description = kind_.description;
    info_.format = *format;
    const Roi asked =
        options.region.value_or(Roi{.width_px = format->width_px, .height_px = format->height_px});
    if (asked.width_px != format->width_px || asked.height_px != format->height_px) {
      return failure(ErrorCode::invalid_argument,
                     "the frames have " + std::to_string(format->width_px) + "x" +
                         std::to_string(format->height_px) + " px where " +
                         std::to_string(asked.width_px) + "x" + std::to_string(asked.height_px) +
                         " were asked for");
    }
    last_frame_ns_ = host_now_ns();
    return {};
  }

  Result<Grab> without_frame(std::int64_t now_ns) {
    if (capture_->mailbox.is_over()) {
      if (kind_.ends) return Grab::ended;
      return failure(ErrorCode::bad_input, "the camera has stopped and has to be opened anew");
    }
    if (now_ns - last_frame_ns_ <= gone_after_ns_) return Grab::nothing;
    return failure(ErrorCode::bad_input, "nothing has come for " +
                                             std::to_string((now_ns - last_frame_ns_) / 1'000'000) +
                                             " ms; it has to be opened anew");
  }

  Kind kind_;
  LiveSourceInfo info_;
  std::shared_ptr<Capture> capture_;
  std::future<void> finished_;
  std::thread thread_;
  std::int64_t last_frame_ns_ = 0;
  std::int64_t gone_after_ns_ = 0;
};

Error refused(const std::string& name, const std::string& why) {
  return {ErrorCode::invalid_argument, name + ": " + why};
}

/// Sets what was asked for; what did not take is seen by the frames and the rate that come.
bool open_device(cv::VideoCapture& video, const std::string& device, const CameraOptions& options) {
  if (!video.open(device, cv::CAP_V4L2)) return false;
  if (options.pixel_format == "Mono8")
    video.set(cv::CAP_PROP_FOURCC, cv::VideoWriter::fourcc('G', 'R', 'E', 'Y'));
  if (options.pixel_format == "Mono16")
    video.set(cv::CAP_PROP_FOURCC, cv::VideoWriter::fourcc('Y', '1', '6', ' '));
  if (!options.pixel_format.empty()) video.set(cv::CAP_PROP_CONVERT_RGB, 0.0);
  if (options.region) {
    video.set(cv::CAP_PROP_FRAME_WIDTH, options.region->width_px);
    video.set(cv::CAP_PROP_FRAME_HEIGHT, options.region->height_px);
  }
  if (options.rate_hz) video.set(cv::CAP_PROP_FPS, *options.rate_hz);
  return true;
}

}  // namespace

Result<std::unique_ptr<LiveSource>> open_v4l(const std::string& device,
                                             const CameraOptions& options) {
  const std::string name = "v4l:" + device;
  if (options.exposure_s)
    return refused(name, "set the exposure with v4l2-ctl; only GenICam cameras take it here");
  if (options.region && (options.region->x_px != 0 || options.region->y_px != 0))
    return refused(name, "a region must begin at (0, 0); only GenICam cameras move it");
  if (!options.pixel_format.empty() && options.pixel_format != "Mono8" &&
      options.pixel_format != "Mono16")
    return refused(name, "the pixel format must be Mono8 or Mono16");
  return VideoCameraSource::open(
      {.name = name,
       .description = "Video4Linux camera " + device,
       .open = [device,
                options](cv::VideoCapture& video) { return open_device(video, device, options); },
       .driver_stamps = true},
      options);
}

Result<std::unique_ptr<LiveSource>> open_gstreamer(const std::string& pipeline,
                                                   const CameraOptions& options) {
  const std::string name = "gst:" + pipeline;
  if (options.exposure_s || options.region || !options.pixel_format.empty()) {
    return refused(name,
                   "the pipeline itself says exposure, region and pixel format, as in "
                   "video/x-raw,format=GRAY8,width=128,height=128");
  }
  const bool has_sink = pipeline.find("appsink") != std::string::npos;
  const std::string complete = has_sink ? pipeline : pipeline + " ! appsink";
  return VideoCameraSource::open(
      {.name = name,
       .description = "GStreamer pipeline " + pipeline,
       .open =
           [complete](cv::VideoCapture& video) { return video.open(complete, cv::CAP_GSTREAMER); },
       .ends = true},
      options);
}

}  // namespace lsv
