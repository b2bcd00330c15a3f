// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/ingest/video_source.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <opencv2/videoio.hpp>
#include <string_view>
#include <utility>

#include "lsv/ingest/decoders.h"
#include "lsv/ingest/input_file.h"

namespace lsv {
namespace {

constexpr std::array<std::string_view, 4> kExtensions = {".avi", ".mkv", ".mp4", ".mov"};
/// Codecs that keep grey values exactly.
constexpr std::array<std::string_view, 8> kLossless = {"FFV1", "HFYU", "FFVH", "GREY",
                                                       "Y800", "Y8  ", "png ", "MPNG"};

/// FFmpeg picks a demuxer by content, and some (playlists) open further files: only the real
/// containers are let through.
bool looks_like_container(std::span<const std::uint8_t> head) {
  const auto has = [&](std::size_t at, std::string_view magic) {
    return head.size() >= at + magic.size() &&
           std::memcmp(head.data() + at, magic.data(), magic.size()) == 0;
  };
  const bool avi = has(0, "RIFF") && has(8, "AVI ");
  const bool matroska = has(0, "\x1A\x45\xDF\xA3");
  const bool quicktime = has(4, "ftyp") || has(4, "moov") || has(4, "mdat") || has(4, "wide") ||
                         has(4, "free") || has(4, "skip");
  return avi || matroska || quicktime;
}

/// Four characters of an OpenCV code; "" when there is none.
std::string four_characters(double code) {
  if (!(code > 0.0) || code > 4294967295.0) return {};
  const auto bits = static_cast<std::uint32_t>(code);
  std::string text;
  for (int shift = 0; shift < 32; shift += 8) text += static_cast<char>(bits >> shift & 0xFFU);
  return text;
}

/// FFmpeg tags deep pixel formats with their number of bits, e.g. 'Y' '1' 0 16 for grey 16.
bool deeper_than_8_bit(const std::string& pixel_format) {
  return std::any_of(pixel_format.begin(), pixel_format.end(),
                     [](char c) { return c > 8 && c <= 16; });
}

std::string printable(std::string text) {
  for (char& c : text) {
    if (std::isprint(static_cast<unsigned char>(c)) == 0) c = '?';
  }
  return text;
}

class VideoSource : public FrameStream {
 public:
  VideoSource(std::string path, const cv::VideoCapture& video, std::int64_t max_pixels)
      : path_(std::move(path)),
        video_(video),
        max_pixels_(max_pixels),
        declared_count_(video_.get(cv::CAP_PROP_FRAME_COUNT)) {
    const std::string codec = four_characters(video_.get(cv::CAP_PROP_FOURCC));
    codec_ = printable(codec);
    lossless_ = std::find(kLossless.begin(), kLossless.end(), codec) != kLossless.end();
  }

  std::string description() const override { return "video (" + codec_ + ")"; }
  std::string last_name() const override {
    return path_ + ", frame " + std::to_string(std::max<std::int64_t>(next_ - 1, 0));
  }
  std::int64_t next_index() const override { return next_; }

  Result<bool> read(Frame& out) override {
    auto there = skip();
    if (!there || !there.value()) return there;
    try {
      if (!video_.retrieve(image_)) return bad_image(last_name(), "cannot be decoded");
    } catch (const std::exception& error) {
      return bad_image(last_name(), std::string("cannot be decoded: ") + error.what());
    }
    return convert(out);
  }

  Result<bool> skip() override {
    try {
      if (!video_.grab()) return at_end();
    } catch (const std::exception& error) {
      return bad_image(path_, std::string("cannot be read: ") + error.what());
    }
    ++next_;
    return true;
  }

  std::vector<std::string> warnings() const override {
    std::vector<std::string> all;
    if (colour_) all.push_back("The video is in colour; lsv measures on its luma.");
    if (!lossless_) {
      all.push_back("The codec " + codec_ +
                    " is not known to be lossless, and a lossy one alters the speckle pattern; "
                    "FFV1 keeps every grey value.");
    }
    return all;
  }

 private:
  Result<bool> at_end() const {
    // Containers round their count, so one frame less is not an alarm.
    if (static_cast<double>(next_) + 1.0 >= declared_count_) return false;
    return bad_image(path_, "ends after " + std::to_string(next_) + " of the " +
                                std::to_string(std::llround(declared_count_)) +
                                " frames that it declares");
  }

  Result<bool> convert(Frame& out) {
    if (image_.depth() != CV_8U || (image_.channels() != 1 && image_.channels() != 3))
      return unsupported_image(last_name(), "has pixels of a kind that lsv does not read");
    const auto size = check_image_size(last_name(), image_.cols, image_.rows, max_pixels_);
    if (!size) return size.error();
    out.reset({.width_px = image_.cols, .height_px = image_.rows});
    for (int y = 0; y < image_.rows; ++y) {
      if (image_.channels() == 1) {
        std::memcpy(out.row8(y), image_.ptr(y), static_cast<std::size_t>(image_.cols));
      } else {
        convert_row(image_.ptr(y), out.row8(y));
      }
    }
    return true;
  }

  void convert_row(const std::uint8_t* bgr, std::uint8_t* grey) {
    int difference = 0;
    for (int x = 0; x < image_.cols; ++x, bgr += 3) {
      difference |= (bgr[0] ^ bgr[1]) | (bgr[1] ^ bgr[2]);
      grey[x] = static_cast<std::uint8_t>(luma(bgr[2], bgr[1], bgr[0]));
    }
    colour_ = colour_ || difference != 0;
  }

  std::string path_;
  cv::VideoCapture video_;
  std::int64_t max_pixels_;
  double declared_count_;
  std::string codec_;
  bool lossless_ = false;
  bool colour_ = false;
  std::int64_t next_ = 0;
  cv::Mat image_;
};

Result<void> check_container(const std::string& path) {
  const auto file = open_regular_file(path);
  if (!file) return file.error();
  std::array<std::uint8_t, 16> head{};
  const auto got = read_fully(file.value().handle.fd(), head, path);
  if (!got) return got.error();
  if (looks_like_container(std::span(head).first(got.value()))) return {};
  return bad_image(path, "does not begin like an AVI, Matroska, MP4 or QuickTime file");
}

}  // namespace

bool is_video_path(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return std::find(kExtensions.begin(), kExtensions.end(), extension) != kExtensions.end();
}

Result<std::unique_ptr<FrameStream>> open_video(const std::string& path, std::int64_t max_pixels) {
  const auto container = check_container(path);
  if (!container) return container.error();
  try {
    // "file:" keeps FFmpeg from reading a protocol into the name.
    cv::VideoCapture video("file:" + path, cv::CAP_FFMPEG);
    if (!video.isOpened())
      return bad_image(path,
                       "cannot be opened as a video; it is damaged or FFmpeg lacks its codec");
    const auto size = check_image_size(
        path, static_cast<std::int64_t>(video.get(cv::CAP_PROP_FRAME_WIDTH)),
        static_cast<std::int64_t>(video.get(cv::CAP_PROP_FRAME_HEIGHT)), max_pixels);
    if (!size) return size.error();
    if (deeper_than_8_bit(four_characters(video.get(cv::CAP_PROP_CODEC_PIXEL_FORMAT)))) {
      return unsupported_image(path,
                               "has more than 8 bits per pixel, which the video decoder would "
                               "squeeze; extract the frames as 16-bit PNG or TIFF");
    }
    return std::unique_ptr<FrameStream>(std::make_unique<VideoSource>(path, video, max_pixels));
  } catch (const std::exception& error) {
    return bad_image(path, std::string("cannot be opened as a video: ") + error.what());
  }
}

}  // namespace lsv
