// SPDX-License-Identifier: BSD-3-Clause
// The first byte chooses the format, the rest is the file.
#include <array>

#include "lsv/ingest/image_decode.h"
#include "tests/fuzz/frame_checks.h"
#include "tests/fuzz/heap_fill.h"
#include "tests/fuzz/memory_file.h"

namespace {

constexpr std::int64_t kMaxPixels = 1 << 16;
constexpr std::array kKinds = {lsv::ImageKind::png, lsv::ImageKind::tiff, lsv::ImageKind::pgm,
                               lsv::ImageKind::bmp, lsv::ImageKind::jpeg};

/// Over a frame and a heap whose every byte is `value`, so that a pixel nobody wrote shows it.
lsv::Result<lsv::ImageNotes> read_over(int value, const lsv::fuzz::MemoryFile& file,
                                       lsv::ImageKind kind, lsv::Frame& out) {
  lsv::fuzz::prefill(out, value, kMaxPixels);
  const lsv::fuzz::HeapFill heap(value);
  return lsv::ImageReader({.max_pixels = kMaxPixels}).read(file.path(), kind, out);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lsv::fuzz;
  if (size == 0) return 0;
  const lsv::ImageKind kind = kKinds[data[0] % kKinds.size()];
  const MemoryFile file(data + 1, size - 1);
  lsv::Frame over_zeros;
  lsv::Frame over_ones;
  const auto first = read_over(0x00, file, kind, over_zeros);
  const auto second = read_over(0xFF, file, kind, over_ones);
  require(first.ok() == second.ok(), "acceptance depends on the file alone");
  if (!first) {
    require(first.error().message.find(file.path()) != std::string::npos,
            "an error names the file");
    require(first.error().message == second.error().message, "an error depends on the file alone");
    return 0;
  }
  check_format(over_zeros.view().format, kMaxPixels);
  require(second.value() == first.value(), "notes depend on the file alone");
  require(same_frames(over_zeros.view(), over_ones.view()), "pixels depend on the file alone");
  return 0;
}
