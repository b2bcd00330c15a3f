// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/ingest/raw_source.h"

#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cctype>
#include <cstring>
#include <filesystem>
#include <utility>
#include <vector>

#include "lsv/ingest/decoders.h"
#include "lsv/ingest/input_file.h"

namespace lsv {
namespace {

class RawSource : public FrameStream {
 public:
  /// `file` is empty for standard input.
  RawSource(std::string name, const RawFormat& raw, std::optional<InputFile> file)
      : name_(std::move(name)), raw_(raw), file_(std::move(file)) {
    buffer_.resize(static_cast<std::size_t>(bytes_per_frame(raw_.format)));
  }

  std::string description() const override {
    return "raw mono" + std::to_string(raw_.format.bit_depth) +
           (file_ ? " file" : " on standard input");
  }
  std::string last_name() const override {
    return name_ + ", frame " + std::to_string(std::max<std::int64_t>(next_ - 1, 0));
  }
  std::int64_t next_index() const override { return next_; }
  std::optional<std::int64_t> count() const override {
    if (!file_) return std::nullopt;
    return (file_->size_bytes - raw_.header_bytes) / bytes_per_frame(raw_.format);
  }

  Result<bool> read(Frame& out) override {
    auto there = skip();
    if (!there || !there.value()) return there;
    copy_raw_frame(buffer_, raw_.format, out);
    return true;
  }

  Result<bool> skip() override {
    const auto past_header = pass_header();
    if (!past_header) return past_header.error();
    const auto got = read_fully(fd(), buffer_, name_);
    if (!got) return got.error();
    if (got.value() == 0) return false;
    ++next_;
    if (got.value() == buffer_.size()) return true;
    return Error{ErrorCode::bad_input, last_name() + ": the input ends after " +
                                           std::to_string(got.value()) + " of its " +
                                           std::to_string(buffer_.size()) + " bytes"};
  }

 private:
  int fd() const { return file_ ? file_->handle.fd() : STDIN_FILENO; }

  Result<void> pass_header() {
    while (header_done_ < raw_.header_bytes) {
      const auto part = static_cast<std::size_t>(std::min<std::int64_t>(
          raw_.header_bytes - header_done_, static_cast<std::int64_t>(buffer_.size())));
      const auto got = read_fully(fd(), std::span(buffer_).first(part), name_);
      if (!got) return got.error();
      if (got.value() < part) return bad_image(name_, "ends inside its header");
      header_done_ += static_cast<std::int64_t>(part);
    }
    return {};
  }

  std::string name_;
  RawFormat raw_;
  std::optional<InputFile> file_;
  std::vector<std::uint8_t> buffer_;
  std::int64_t header_done_ = 0;
  std::int64_t next_ = 0;
};

Result<void> check_length(const std::string& path, const RawFormat& raw, std::int64_t size_bytes) {
  const std::int64_t frame_bytes = bytes_per_frame(raw.format);
  const std::int64_t data_bytes = size_bytes - raw.header_bytes;
  if (data_bytes < 0) return bad_image(path, "ends inside its header");
  const std::int64_t rest_bytes = data_bytes % frame_bytes;
  if (rest_bytes == 0) return {};
  return bad_image(path, "frame " + std::to_string(data_bytes / frame_bytes) + " has " +
                             std::to_string(rest_bytes) + " of its " + std::to_string(frame_bytes) +
                             " bytes; the size given with --raw is wrong or the file is cut");
}

}  // namespace

std::int64_t bytes_per_frame(const FrameFormat& format) {
  return std::int64_t{format.width_px} * format.height_px *
         static_cast<std::int64_t>(bytes_per_pixel(format.type));
}

Result<void> check_raw_size(const std::string& name, const RawFormat& raw,
                            std::int64_t max_pixels) {
  const auto size =
      check_image_size(name + ": --raw", raw.format.width_px, raw.format.height_px, max_pixels);
  if (!size) return Error{ErrorCode::invalid_argument, size.error().message};
  return {};
}

void copy_raw_frame(std::span<const std::uint8_t> bytes, const FrameFormat& format, Frame& out) {
  out.reset(format);
  const std::size_t row_bytes = bytes.size() / static_cast<std::size_t>(format.height_px);
  for (int y = 0; y < format.height_px; ++y) {
    std::memcpy(out.row(y), bytes.data() + static_cast<std::size_t>(y) * row_bytes, row_bytes);
    if constexpr (std::endian::native == std::endian::big) {
      if (format.type == PixelType::mono16) {
        for (int x = 0; x < format.width_px; ++x) {
          const std::uint16_t word = out.row16(y)[x];
          out.row16(y)[x] = static_cast<std::uint16_t>(word << 8 | word >> 8);
        }
      }
    }
  }
}

bool is_raw_path(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return extension == ".raw" || extension == ".bin" || extension == ".y8" || extension == ".y16";
}

Result<std::unique_ptr<FrameStream>> open_raw(const std::string& path, const RawFormat& raw,
                                              std::int64_t max_pixels) {
  if (const auto size = check_raw_size(path, raw, max_pixels); !size) return size.error();
  if (path == "-") {
    return std::unique_ptr<FrameStream>(
        std::make_unique<RawSource>("standard input", raw, std::nullopt));
  }
  auto file = open_regular_file(path);
  if (!file) return file.error();
  const auto length = check_length(path, raw, file.value().size_bytes);
  if (!length) return length.error();
  return std::unique_ptr<FrameStream>(
      std::make_unique<RawSource>(path, raw, std::move(file).value()));
}

}  // namespace lsv
