// SPDX-License-Identifier: BSD-3-Clause
#include "tools/recording.h"

#include <unistd.h>

#include <cstdio>
#include <system_error>
#include <utility>

#include "tools/commands.h"
#include "tools/interrupt.h"

namespace lsv::cli {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kMaxFrames = 10'000'000;

Error usage(std::string message) { return {ErrorCode::invalid_argument, std::move(message)}; }

Error disk_error(const fs::path& path, const std::error_code& code) {
  return {ErrorCode::output_failed, "cannot write " + path.string() + ": " + code.message()};
}

bool names_tiff_stack(const std::string& output) {
  const std::string extension = fs::path(output).extension().string();
  return extension == ".tif" || extension == ".tiff";
}

/// The format of the frames in a directory; nothing for a TIFF stack.
Result<std::optional<FrameFileFormat>> file_format(const RecordingOptions& options) {
  if (names_tiff_stack(options.output)) {
    if (options.format.empty() || options.format == "tiff") return std::optional<FrameFileFormat>();
    return usage("--format " + options.format + " does not fit " + options.output +
                 ": name a directory, or leave --format out for a TIFF stack");
  }
  const auto format =
      frame_file_format_from(options.format.empty() ? std::string("png") : options.format);
  if (!format)
    return usage("--format is \"" + options.format + "\" but must be png, tiff, pgm or raw");
  return format;
}

/// Refuses to overwrite; an empty directory may be filled.
Result<void> refuse_existing(const fs::path& path, bool may_be_empty_directory) {
  std::error_code ignored;
  if (!fs::exists(path, ignored)) return {};
  if (may_be_empty_directory && fs::is_directory(path, ignored) && fs::is_empty(path, ignored))
    return {};
  return usage(path.string() + " exists already: remove it or choose another name");
}

void show_progress(std::int64_t done, std::int64_t frames) {
  if (!::isatty(STDERR_FILENO) || (done % 16 != 0 && done != frames)) return;
  std::fprintf(stderr, "\rframe %lld of %lld%s", static_cast<long long>(done),
               static_cast<long long>(frames), done == frames ? "\n" : "");
}

}  // namespace

Result<Recording> Recording::begin(const RecordingOptions& options) {
  const auto format = file_format(options);
  if (!format) return format.error();
  Recording recording;
  recording.format_ = format.value();
  recording.target_ = options.output;
  // "run1/" and "run1" are the same directory.
  if (!recording.target_.has_filename()) recording.target_ = recording.target_.parent_path();
  if (recording.target_.empty())
    return usage("--output names nothing: give a directory or a .tif file");
  if (auto free = refuse_existing(recording.target_, format.value().has_value()); !free)
    return free.error();
  if (auto made = recording.make_parent(); !made) return made.error();
  if (format.value()) {
    if (auto begun = recording.begin_directory(); !begun) return begun.error();
  } else {
    auto stack = TiffStackWriter::create(recording.target_.string(), options.pixel_bytes);
    if (!stack) return stack.error();
    recording.stack_.emplace(std::move(stack).value());
  }
  if (options.truth) {
    if (auto opened = recording.open_truth(*options.truth); !opened) return opened.error();
  }
  return recording;
}

Recording::Recording(Recording&& other) noexcept
    : target_(std::move(other.target_)),
      part_directory_(std::exchange(other.part_directory_, {})),
      format_(other.format_),
      stack_(std::move(other.stack_)),
      truth_(std::move(other.truth_)) {}

Recording::~Recording() {
  truth_.reset();
  std::error_code ignored;
  if (!part_directory_.empty()) fs::remove_all(part_directory_, ignored);
}

Result<void> Recording::add_frame(const Frame& frame) {
  if (stack_) return stack_->append(frame.view());
  char name[40];
  std::snprintf(name, sizeof name, "frame_%05lld", static_cast<long long>(frame.index));
  return write_frame(frame.view(), *format_,
                     (part_directory_ / name).string() + std::string(extension(*format_)));
}

Result<void> Recording::commit() {
  if (truth_) {
    if (auto done = truth_->commit(); !done) return done;
  }
  if (stack_) return stack_->commit();
  std::error_code code;
  fs::rename(part_directory_, target_, code);
  if (code) return disk_error(target_, code);
  part_directory_.clear();
  return {};
}

Result<void> Recording::make_parent() const {
  if (!target_.has_parent_path()) return {};
  std::error_code code;
  fs::create_directories(target_.parent_path(), code);
  if (code) return disk_error(target_, code);
  return {};
}

Result<void> Recording::begin_directory() {
  const fs::path part = target_.string() + ".part";
  std::error_code code;
  if (fs::create_directory(part, code)) {
    part_directory_ = part;
    return {};
  }
  if (code) return disk_error(target_, code);
  return usage(part.string() + " is left from a run that was cut short: remove it first");
}

Result<void> Recording::open_truth(const std::string& asked) {
  fs::path path = asked;
  if (asked.empty()) path = (format_ ? part_directory_ : target_.parent_path()) / "truth.csv";
  if (auto free = refuse_existing(path, false); !free) return free;
  if (path == target_) return usage("--truth and --output name the same file");
  auto file = OutputFile::open(path.string());
  if (!file) return file.error();
  truth_.emplace(std::move(file).value());
  return {};
}

Result<void> check_frame_count(std::int64_t frames) {
  if (frames >= 1 && frames <= kMaxFrames) return {};
  return usage("--frames is " + std::to_string(frames) + " but must be in [1, " +
               std::to_string(kMaxFrames) + "]");
}

Result<int> record_frames(Recording recording, std::int64_t frames,
                          const std::function<Result<void>(std::int64_t, Recording&)>& record) {
  catch_interrupts();
  for (std::int64_t k = 0; k < frames && !interrupted(); ++k) {
    if (auto done = record(k, recording); !done) return done.error();
    show_progress(k + 1, frames);
  }
  if (interrupted()) {
    std::fputs("lsv: interrupted, nothing was written\n", stderr);
    return kExitInterrupted;
  }
  if (auto done = recording.commit(); !done) return done.error();
  return kExitOk;
}

}  // namespace lsv::cli
