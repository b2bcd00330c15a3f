// SPDX-License-Identifier: BSD-3-Clause
// --raw and --roi: what is accepted must say the same again.
#include "lsv/ingest/frame_source.h"
#include "tests/fuzz/frame_checks.h"

namespace {

using lsv::fuzz::require;

std::string text_of(const lsv::RawFormat& raw) {
  return std::to_string(raw.format.width_px) + "x" + std::to_string(raw.format.height_px) +
         ":mono" + std::to_string(raw.format.bit_depth) + ":" + std::to_string(raw.header_bytes);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  if (const auto raw = lsv::parse_raw_format(text)) {
    const lsv::RawFormat& value = raw.value();
    require(value.format.width_px > 0 && value.format.height_px > 0 && value.header_bytes >= 0,
            "a raw frame holds a pixel");
    const auto again = lsv::parse_raw_format(text_of(value));
    require(again && again.value().format == value.format &&
                again.value().header_bytes == value.header_bytes,
            "a raw format reads back as written");
  }
  if (const auto roi = lsv::parse_roi(text)) {
    const lsv::Roi& value = roi.value();
    require(value.x_px >= 0 && value.y_px >= 0 && value.width_px > 0 && value.height_px > 0,
            "a region holds a pixel");
  }
  return 0;
}
