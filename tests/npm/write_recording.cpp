// SPDX-License-Identifier: BSD-3-Clause
// write_recording FILE.mcap FRAMES plain|zstd: the recording that check.mjs expects.
#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "lsv/record/recorder.h"
#include "tests/lsv/record/recorded_stream.h"

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fputs("usage: write_recording FILE.mcap FRAMES plain|zstd\n", stderr);
    return 2;
  }
  const std::int64_t frames = std::atoll(argv[2]);
  lsv::RecorderOptions options = lsv::test::recorder_options(argv[1]);
  options.queue_frames = static_cast<std::size_t>(frames);
  options.chunk_bytes = 60'000;
  if (std::string_view(argv[3]) == "zstd") options.compression = lsv::mcap::Compression::zstd;
  auto recorder = lsv::Recorder::create(options);
  if (!recorder) {
    std::fprintf(stderr, "%s\n", recorder.error().message.c_str());
    return 1;
  }
  lsv::Frame frame;
  for (std::int64_t index = 0; index < frames; ++index)
    lsv::test::push(*recorder.value(), index, frame);
  recorder.value()->on_event(lsv::test::some_event());
  recorder.value()->on_health(lsv::test::some_health());
  const lsv::Result<void> closed = recorder.value()->close();
  if (!closed) std::fprintf(stderr, "%s\n", closed.error().message.c_str());
  return closed ? 0 : 1;
}
