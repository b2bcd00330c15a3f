// SPDX-License-Identifier: BSD-3-Clause
#include "tools/source_flags.h"

namespace lsv::cli {

void add_source_flags(CLI::App& command, SourceFlags& flags) {
  SourceOptions& options = flags.options;
  command
      .add_option("FRAMES", flags.frames,
                  "A folder, image files, a quoted pattern, a TIFF stack, a raw file, a video, or "
                  "- for raw frames on standard input")
      ->required();
  command.add_option("--rate-hz", options.rate_hz, "Frames per second of the camera");
  command.add_option("--timestamps", options.timestamps_path,
                     "File with one time stamp per frame (column time_s or time_ns)");
  command.add_option("--raw", flags.raw,
                     "Raw frames: WIDTHxHEIGHT:mono8|mono10|mono12|mono14|mono16[:HEADER_BYTES]");
  command.add_option("--roi", flags.roi,
                     "Use only this part of each frame, in px: X,Y,WIDTH,HEIGHT");
  command.add_option("--bit-depth", options.bit_depth,
                     "Significant low bits of 16-bit pixels: 10, 12, 14 or 16");
  command.add_option("--start", options.start, "First frame index used (default 0)");
  command.add_option("--stop", options.stop, "First frame index not used any more");
  command.add_option("--step", options.step, "Use every STEP-th frame (default 1)");
  command.add_flag("--ignore-numbers", options.ignore_numbers,
                   "Numbers in file names do not mean missing frames");
}

Result<SourceOptions> source_options(const SourceFlags& flags) {
  SourceOptions options = flags.options;
  if (!flags.raw.empty()) {
    const auto raw = parse_raw_format(flags.raw);
    if (!raw) return raw.error();
    options.raw = raw.value();
  }
  if (!flags.roi.empty()) {
    const auto roi = parse_roi(flags.roi);
    if (!roi) return roi.error();
    options.roi = roi.value();
  }
  return options;
}

}  // namespace lsv::cli
