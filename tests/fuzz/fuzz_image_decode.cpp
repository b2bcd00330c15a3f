// SPDX-License-Identifier: BSD-3-Clause
// The first byte chooses the format, the rest is the file.
#include <array>

#include "lsv/ingest/image_decode.h"
#include "tests/fuzz/frame_checks.h"
#include "tests/fuzz/memory_file.h"

namespace {

constexpr std::int64_t kMaxPixels = 1 << 16;
constexpr std::array kKinds = {lsv::ImageKind::png, lsv::ImageKind::tiff, lsv::ImageKind::pgm,
                               lsv::ImageKind::bmp, lsv::ImageKind::jpeg};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lsv::fuzz;
  if (size == 0) return 0;
  const lsv::ImageKind kind = kKinds[data[0] % kKinds.size()];
  const MemoryFile file(data + 1, size - 1);
  lsv::ImageReader reader({.max_pixels = kMaxPixels});
  lsv::Frame over_zeros;
  prefill(over_zeros, 0x00, kMaxPixels);
  const auto first = reader.read(file.path(), kind, over_zeros);
  if (!first) {
    require(first.error().message.find(file.path()) != std::string::npos);
    return 0;
  }
  check_format(over_zeros.view().format, kMaxPixels);
  lsv::Frame over_ones;
  prefill(over_ones, 0xFF, kMaxPixels);
  const auto second = reader.read(file.path(), kind, over_ones);
  require(second && second.value() == first.value());
  require(same_frames(over_zeros.view(), over_ones.view()));
  return 0;
}
