// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/ingest/frame_source.h"

#include <algorithm>
#include <cctype>
#include <cstring>
#include <exception>
#include <filesystem>
#include <utility>

#include "lsv/ingest/frame_paths.h"
#include "lsv/ingest/frame_stream.h"
#include "lsv/ingest/image_decode.h"
#include "lsv/ingest/image_sequence.h"
#include "lsv/ingest/mcap_stream.h"
#include "lsv/ingest/raw_source.h"
#include "lsv/ingest/tiff_stack.h"
#include "lsv/ingest/time_base.h"
#include "lsv/ingest/video_source.h"

namespace lsv {
namespace {

Error usage(std::string what) { return {ErrorCode::invalid_argument, std::move(what)}; }

std::string describe(const FrameFormat& format) {
  return std::to_string(format.width_px) + " x " + std::to_string(format.height_px) + " px, " +
         std::to_string(format.bit_depth) + " bit";
}

/// A word above full scale means that the depth is wrong or the data sit in the high bits.
Result<void> check_depth(const FrameView& frame, const std::string& name) {
  if (frame.format.type == PixelType::mono8 || frame.format.bit_depth == 16) return {};
  const int full_scale = full_scale_counts(frame.format.bit_depth);
  for (int y = 0; y < frame.height_px(); ++y) {
    const std::uint16_t* row = frame.row16(y);
    const std::uint16_t* above = std::find_if(
        row, row + frame.width_px(), [&](std::uint16_t value) { return value > full_scale; });
    if (above == row + frame.width_px()) continue;
    return Error{ErrorCode::bad_input,
                 name + ": pixel at column " + std::to_string(above - row) + ", row " +
                     std::to_string(y) + " is " + std::to_string(*above) + ", above the " +
                     std::to_string(full_scale) + " of " + std::to_string(frame.format.bit_depth) +
                     " bit; correct the bit depth (--bit-depth, or mono16 in --raw)"};
  }
  return {};
}

void copy_pixels(const FrameView& from, Frame& to) {
  to.reset(from.format);
  const std::size_t row_bytes =
      static_cast<std::size_t>(from.width_px()) * bytes_per_pixel(from.format.type);
  for (int y = 0; y < from.height_px(); ++y)
    std::memcpy(to.row(y), from.data + y * from.stride_bytes, row_bytes);
}

/// Adds to a stream what all inputs share: selection, region, time, agreement of the frames.
/// The first frame is read at opening, so that a bad input is refused before any work starts.
class SelectedSource : public FrameSource {
 public:
  SelectedSource(std::unique_ptr<FrameStream> stream, TimeBase time, const SourceOptions& options,
                 std::vector<std::string> files)
      : stream_(std::move(stream)),
        time_(std::move(time)),
        selection_{.start = options.start, .stop = options.stop, .step = options.step},
        roi_(options.roi) {
    info_.files = std::move(files);
  }

  Result<void> open() {
    auto planned = plan();
    if (!planned) return planned;
    const auto read = advance(first_);
    if (!read) return read.error();
    if (!read.value()) {
      return Error{ErrorCode::bad_input, stream_->last_name() + ": the input holds no frame" +
                                             (selection_.start > 0 ? " at or after --start" : "")};
    }
    has_first_ = true;
    info_.description = stream_->description();
    info_.format = first_.view().format;
    info_.whole_format = *format_;
    if (time_.is_time() || stream_->own_stamp()) info_.first_stamp = first_.stamp;
    for (std::string& warning : stream_->warnings()) info_.warnings.push_back(std::move(warning));
    return {};
  }

  const SourceInfo& info() const override { return info_; }

  Result<bool> next(Frame& out) override {
    if (has_first_) {
      has_first_ = false;
      std::swap(out, first_);
      return true;
    }
    if (finished_) return false;
    try {
      auto read = advance(out);
      finished_ = !read || !read.value();
      return read;
    } catch (const std::exception& error) {
      finished_ = true;
      return Error{ErrorCode::bad_input, stream_->last_name() + ": " + error.what()};
    }
  }

 private:
  /// What can be known and refused before the first frame is decoded.
  Result<void> plan() {
    const auto count = stream_->count();
    if (!count) return {};
    if (*count == 0) {
      return Error{ErrorCode::bad_input, stream_->last_name() + ": the input holds no frame"};
    }
    const auto [selected, last] = select(*count);
    const std::int64_t last_index = place_of(*count - 1).index;
    if (selected == 0) {
      return usage("--start, --stop and --step select no frame; the input has frames 0 to " +
                   std::to_string(last_index));
    }
    info_.frame_count = selected;
    info_.missing_count = last_index + 1 - *count;
    auto longer = time_.check_length(*count, last_index);
    if (!longer) return longer.error();
    if (longer.value()) info_.warnings.push_back(*longer.value());
    const auto last_stamp = time_.stamp(last);
    if (!last_stamp) return last_stamp.error();
    if (time_.is_time()) info_.last_stamp = last_stamp.value();
    return {};
  }

  FramePlace place_of(std::int64_t ordinal) const {
    const auto* indices = stream_->indices();
    return {.index = indices ? (*indices)[static_cast<std::size_t>(ordinal)] : ordinal,
            .ordinal = ordinal};
  }

  struct Selected {
    std::int64_t count = 0;
    FramePlace last;
  };

  Selected select(std::int64_t count) const {
    Selected out;
    if (!stream_->indices()) {
      out.count = selection_.count_below(count);
      out.last = place_of(selection_.start + (out.count - 1) * selection_.step);
      return out;
    }
    for (std::int64_t ordinal = 0; ordinal < count; ++ordinal) {
      if (!selection_.takes(place_of(ordinal).index)) continue;
      ++out.count;
      out.last = place_of(ordinal);
    }
    return out;
  }

  /// The next selected frame, complete, or false at the end.
  Result<bool> advance(Frame& out) {
    for (;;) {
      const FramePlace place{.index = stream_->next_index(), .ordinal = ordinal_++};
      if (selection_.past_end(place.index)) return false;
      if (selection_.takes(place.index)) return read(place, out);
      auto skipped = stream_->skip();
      if (!skipped || !skipped.value()) return skipped;
    }
  }

  Result<bool> read(const FramePlace& place, Frame& out) {
    Frame& whole = roi_ ? uncropped_ : out;
    auto got = stream_->read(whole);
    if (!got || !got.value()) return got;
    const auto checked = check(whole.view());
    if (!checked) return checked.error();
    if (roi_) copy_pixels(crop(whole.view(), *roi_), out);
    const auto stamp = stamp_of(place);
    if (!stamp) return stamp.error();
    out.stamp = stamp.value();
    out.index = place.index;
    return true;
  }

  /// A time base that was asked for stands above the one of the input.
  Result<Stamp> stamp_of(const FramePlace& place) const {
    const std::optional<Stamp> own = stream_->own_stamp();
    if (own && !time_.is_time()) return *own;
    return time_.stamp(place);
  }

  Result<void> check(const FrameView& frame) {
    const std::string name = stream_->last_name();
    if (!format_) format_ = frame.format;
    if (frame.format != *format_) {
      return Error{ErrorCode::bad_input, name + ": is " + describe(frame.format) +
                                             " but the frames before it are " + describe(*format_)};
    }
    if (roi_ && !contains(frame.format, *roi_)) {
      return usage("--roi " + std::to_string(roi_->x_px) + "," + std::to_string(roi_->y_px) + "," +
                   std::to_string(roi_->width_px) + "," + std::to_string(roi_->height_px) +
                   " does not lie inside the frame of " + std::to_string(frame.width_px()) + " x " +
                   std::to_string(frame.height_px()) + " px (" + name + ")");
    }
    return check_depth(frame, name);
  }

  std::unique_ptr<FrameStream> stream_;
  TimeBase time_;
  FrameSelection selection_;
  std::optional<Roi> roi_;
  SourceInfo info_;
  std::optional<FrameFormat> format_;  // of whole frames
  Frame first_;
  Frame uncropped_;
  std::int64_t ordinal_ = 0;
  bool has_first_ = false;
  bool finished_ = false;
};

Result<void> check(const SourceOptions& options) {
  if (options.start < 0) return usage("--start must be 0 or more");
  if (options.stop && *options.stop <= options.start) return usage("--stop must be above --start");
  if (options.step < 1) return usage("--step must be 1 or more");
  if (options.max_pixels < 1) return usage("the limit of pixels per frame must be 1 or more");
  if (options.bit_depth && *options.bit_depth != 10 && *options.bit_depth != 12 &&
      *options.bit_depth != 14 && *options.bit_depth != 16)
    return usage("--bit-depth must be 10, 12, 14 or 16 (it speaks of 16-bit words)");
  return {};
}

/// --raw with --bit-depth taken into account.
std::optional<RawFormat> raw_format(const SourceOptions& options) {
  std::optional<RawFormat> raw = options.raw;
  if (raw && options.bit_depth && raw->format.type == PixelType::mono16)
    raw->format.bit_depth = *options.bit_depth;
  return raw;
}

Result<std::unique_ptr<FrameStream>> open_raw_input(const std::string& path,
                                                    const SourceOptions& options) {
  const std::optional<RawFormat> raw = raw_format(options);
  if (!raw) {
    return usage((path == "-" ? "standard input" : path) +
                 ": raw frames do not say their size; give --raw, for example --raw 640x480:mono8");
  }
  return open_raw(path, *raw, options.max_pixels);
}

Result<std::unique_ptr<FrameStream>> open_stream(const FramePaths& paths,
                                                 const SourceOptions& options) {
  const auto& [files, order] = paths;
  const DecodeOptions decode{
      .max_pixels = options.max_pixels, .bit_depth = options.bit_depth, .raw = raw_format(options)};
  if (files.size() == 1) {
    const std::string& file = files.front();
    if (file == "-" || options.raw || is_raw_path(file)) return open_raw_input(file, options);
    if (is_recording_path(file)) {
      return open_mcap_stream(
          file, {.damage = options.salvage ? mcap::Damage::skip : mcap::Damage::refuse,
                 .max_pixels = options.max_pixels,
                 .bit_depth = options.bit_depth});
    }
    if (is_video_path(file)) return open_video(file, options.max_pixels);
    if (image_kind_of(file) == ImageKind::tiff) return open_tiff_stack(file, decode);
  }
  if (!options.raw) {
    const auto list = check_image_list(files);
    if (!list) return list.error();
  }
  return open_image_sequence(files, order, options.ignore_numbers, decode);
}

}  // namespace

Result<std::unique_ptr<FrameSource>> open_frames(const std::vector<std::string>& paths,
                                                 const SourceOptions& options) {
  try {
    const auto checked = check(options);
    if (!checked) return checked.error();
    SourceOptions time_options = options;
    if (paths.size() == 1 && is_recording_path(paths.front())) time_options.need_time = false;
    auto time = TimeBase::make(time_options);
    if (!time) return time.error();
    auto expanded = expand_frame_paths(paths, options.raw.has_value());
    if (!expanded) return expanded.error();
    auto stream = open_stream(expanded.value(), options);
    if (!stream) return stream.error();
    std::vector<std::string> files = std::move(expanded).value().files;
    std::erase(files, "-");
    auto source = std::make_unique<SelectedSource>(
        std::move(stream).value(), std::move(time).value(), options, std::move(files));
    const auto opened = source->open();
    if (!opened) return opened.error();
    return std::unique_ptr<FrameSource>(std::move(source));
  } catch (const std::exception& error) {
    return Error{ErrorCode::bad_input,
                 (paths.empty() ? "" : paths.front()) + ": cannot be opened: " + error.what()};
  }
}

}  // namespace lsv
