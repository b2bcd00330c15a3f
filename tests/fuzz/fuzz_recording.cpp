// SPDX-License-Identifier: BSD-3-Clause
// A recording as frames: every frame handed out is within the limits and depends on the file alone.
#include "lsv/ingest/recording.h"
#include "tests/fuzz/frame_checks.h"
#include "tests/fuzz/heap_fill.h"
#include "tests/fuzz/memory_file.h"

namespace {

using namespace lsv;
using fuzz::require;

constexpr std::int64_t kMaxPixels = 1 << 12;

/// A recording that is only ever read over frames and a heap whose every byte is `value`.
class ReaderOver {
 public:
  ReaderOver(int value, const std::string& path, mcap::Damage damage) : value_(value) {
    const fuzz::HeapFill heap(value);
    reader_ = RecordingReader::open(path, {.damage = damage, .max_pixels = kMaxPixels});
  }
  bool opened() const { return reader_.ok(); }
  const RecordedFrame& frame() const { return frame_; }
  Result<bool> next() {
    fuzz::prefill(frame_.frame, value_, kMaxPixels);
    const fuzz::HeapFill heap(value_);
    return reader_.value().next(frame_);
  }

 private:
  int value_;
  Result<RecordingReader> reader_ = Error{};
  RecordedFrame frame_;
};

void read(const std::string& path, mcap::Damage damage) {
  ReaderOver zeros(0x00, path, damage);
  ReaderOver ones(0xFF, path, damage);
  require(zeros.opened() == ones.opened(), "acceptance depends on the file alone");
  if (!zeros.opened()) return;
  for (;;) {
    const auto first = zeros.next();
    const auto second = ones.next();
    require(first.ok() == second.ok(), "a frame that is read depends on the file alone");
    if (!first) {
      require(first.error().message.find(path) != std::string::npos, "an error names the file");
      return;
    }
    require(first.value() == second.value(), "the end depends on the file alone");
    if (!first.value()) return;
    const FrameView frame = zeros.frame().frame.view();
    require(is_possible(frame.format), "a frame has a possible format");
    require(std::int64_t{frame.width_px()} * frame.height_px() <= kMaxPixels,
            "a frame is within the limit of pixels");
    require(fuzz::same_frames(frame, ones.frame().frame.view()), "pixels depend on the file alone");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const fuzz::MemoryFile file(data, size);
  read(file.path(), mcap::Damage::refuse);
  read(file.path(), mcap::Damage::skip);
  return 0;
}
