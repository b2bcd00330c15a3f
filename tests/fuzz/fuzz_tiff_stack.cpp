// SPDX-License-Identifier: BSD-3-Clause
// A TIFF stack: every page counted is delivered whole or ends the stack with an error.
#include "lsv/ingest/tiff_stack.h"
#include "tests/fuzz/frame_checks.h"
#include "tests/fuzz/memory_file.h"

namespace {
constexpr std::int64_t kMaxPixels = 1 << 14;
}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lsv::fuzz;
  const MemoryFile file(data, size);
  const lsv::DecodeOptions options{.max_pixels = kMaxPixels};
  auto over_zeros = lsv::open_tiff_stack(file.path(), options);
  auto over_ones = lsv::open_tiff_stack(file.path(), options);
  require(over_zeros.ok() == over_ones.ok());
  if (!over_zeros) {
    require(over_zeros.error().message.find(file.path()) != std::string::npos);
    return 0;
  }
  const std::int64_t count = over_zeros.value()->count().value();
  lsv::Frame a;
  lsv::Frame b;
  for (std::int64_t page = 0;; ++page) {
    prefill(a, 0x00, kMaxPixels);
    prefill(b, 0xFF, kMaxPixels);
    const auto first = over_zeros.value()->read(a);
    const auto second = over_ones.value()->read(b);
    require(first.ok() == second.ok());
    if (!first) {
      require(first.error().message.find(file.path()) != std::string::npos);
      return 0;
    }
    require(first.value() == (page < count));
    if (!first.value()) return 0;
    check_format(a.view().format, kMaxPixels);
    require(same_frames(a.view(), b.view()));
  }
}
