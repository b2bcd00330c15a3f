// SPDX-License-Identifier: BSD-3-Clause
#include "tools/camera_frames.h"

#include <cstddef>
#include <memory>
#include <utility>

#include "calibration/sha256.h"
#include "tools/interrupt.h"

namespace lsv::cli {
namespace {

class Reader {
 public:
  explicit Reader(const SourceOptions& options) : options_(options) {}

  Result<LightSequence> read(const std::string& name, double exposure_us) {
    Result<std::unique_ptr<FrameSource>> source = open_frames({name}, options_);
    if (!source) return source.error();
    const SourceInfo& info = source.value()->info();
    files_.insert(files_.end(), info.files.begin(), info.files.end());
    for (const std::string& warning : info.warnings)
      warnings_.emplace_back(name).append(": ").append(warning);
    Result<PixelStatistics> statistics = PixelStatistics::create(info.format);
    if (!statistics)
      return Error{statistics.error().code, name + ": " + statistics.error().message};
    Frame frame;
    while (!interrupted()) {
      const Result<bool> more = source.value()->next(frame);
      if (!more && interrupted()) break;  // the signal ended the wait for a pipe
      if (!more) return more.error();
      if (!more.value()) break;
      if (Result<void> added = statistics.value().add(frame.view()); !added)
        return Error{ErrorCode::bad_input, name + ": " + added.error().message};
      add_to_digest(frame.view());
    }
    return LightSequence{
        .name = name, .statistics = std::move(statistics).value(), .exposure_us = exposure_us};
  }

  void finish(CameraFrames& out) {
    out.files = std::move(files_);
    out.warnings = std::move(warnings_);
    out.inputs_sha256 = digest_;
  }

 private:
  void add_to_digest(const FrameView& frame) {
    const std::size_t row_bytes =
        static_cast<std::size_t>(frame.width_px()) * bytes_per_pixel(frame.format.type);
    bytes_ = digest_;
    for (int y = 0; y < frame.height_px(); ++y) {
      const auto* const row = reinterpret_cast<const char*>(frame.data + y * frame.stride_bytes);
      bytes_.append(row, row_bytes);
    }
    digest_ = sha256_hex(bytes_);
  }

  const SourceOptions& options_;
  std::vector<std::string> files_;
  std::vector<std::string> warnings_;
  std::string digest_;
  std::string bytes_;
};

}  // namespace

Result<CameraFrames> read_camera_frames(const std::string& dark,
                                        const std::vector<std::string>& flats,
                                        const std::vector<double>& exposures_us,
                                        const SourceOptions& options) {
  Reader reader(options);
  Result<LightSequence> dark_frames = reader.read(dark, kUnknown);
  if (!dark_frames) return dark_frames.error();
  CameraFrames out{.dark = std::move(dark_frames).value(),
                   .flats = {},
                   .files = {},
                   .warnings = {},
                   .inputs_sha256 = {}};
  for (std::size_t i = 0; i < flats.size(); ++i) {
    const double exposure_us = exposures_us.empty() ? kUnknown : exposures_us[i];
    Result<LightSequence> flat = reader.read(flats[i], exposure_us);
    if (!flat) return flat.error();
    out.flats.push_back(std::move(flat).value());
  }
  reader.finish(out);
  return out;
}

}  // namespace lsv::cli
