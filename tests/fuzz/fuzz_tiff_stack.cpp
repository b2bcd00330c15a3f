// SPDX-License-Identifier: BSD-3-Clause
// A TIFF stack: every page counted is delivered whole or ends the stack with an error.
#include "lsv/ingest/tiff_stack.h"
#include "tests/fuzz/frame_checks.h"
#include "tests/fuzz/heap_fill.h"
#include "tests/fuzz/memory_file.h"

namespace {

constexpr std::int64_t kMaxPixels = 1 << 14;

/// A stack that is only ever read over frames and a heap whose every byte is `value`.
class StackOver {
 public:
  StackOver(int value, const std::string& path) : value_(value) {
    const lsv::fuzz::HeapFill heap(value);
    stack_ = lsv::open_tiff_stack(path, {.max_pixels = kMaxPixels});
  }
  const lsv::Result<std::unique_ptr<lsv::FrameStream>>& opened() const { return stack_; }
  const lsv::Frame& frame() const { return frame_; }

  lsv::Result<bool> read() {
    lsv::fuzz::prefill(frame_, value_, kMaxPixels);
    const lsv::fuzz::HeapFill heap(value_);
    return stack_.value()->read(frame_);
  }

 private:
  int value_;
  lsv::Result<std::unique_ptr<lsv::FrameStream>> stack_ = lsv::Error{};
  lsv::Frame frame_;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lsv::fuzz;
  const MemoryFile file(data, size);
  const auto names_file = [&](const lsv::Error& error) {
    return error.message.find(file.path()) != std::string::npos;
  };
  StackOver zeros(0x00, file.path());
  StackOver ones(0xFF, file.path());
  require(zeros.opened().ok() == ones.opened().ok(), "acceptance depends on the file alone");
  if (!zeros.opened()) {
    require(names_file(zeros.opened().error()), "an error names the file");
    return 0;
  }
  const std::int64_t count = zeros.opened().value()->count().value();
  for (std::int64_t page = 0;; ++page) {
    const auto first = zeros.read();
    const auto second = ones.read();
    require(first.ok() == second.ok(), "a page that is read depends on the file alone");
    if (!first) {
      require(names_file(first.error()), "an error names the file");
      return 0;
    }
    require(first.value() == (page < count), "the pages delivered are the pages counted");
    if (!first.value()) return 0;
    check_format(zeros.frame().view().format, kMaxPixels);
    require(same_frames(zeros.frame().view(), ones.frame().view()),
            "pixels depend on the file alone");
  }
}
