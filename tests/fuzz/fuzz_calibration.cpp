// SPDX-License-Identifier: BSD-3-Clause
// A calibration is accepted whole and in range, or refused by name.
#include <cmath>
#include <string>

#include "calibration/calibration_io.h"
#include "lsv/core/config.h"
#include "tests/fuzz/frame_checks.h"

using lsv::fuzz::require;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  const auto parsed = lsv::parse_calibration(text, "fuzz.toml");
  if (!parsed) {
    require(parsed.error().message.find("fuzz.toml") == 0, "an error names the file");
    return 0;
  }
  lsv::TrackConfig config;
  config.calibration = parsed.value();
  require(lsv::validate(config).ok(), "an accepted calibration is in range");
  require(config.calibration.digest.size() == 64, "a digest has 64 digits");
  return 0;
}
