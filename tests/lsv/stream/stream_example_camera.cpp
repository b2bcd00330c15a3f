// SPDX-License-Identifier: BSD-3-Clause
// The camera of docs/stream_example.cpp: 40 frames of a moving pattern.
#include <memory>

#include "lsv/stream/paced_source.h"
#include "tests/support/pattern.h"

lsv::Result<std::unique_ptr<lsv::LiveSource>> open_camera();

lsv::Result<std::unique_ptr<lsv::LiveSource>> open_camera() {
  static const lsv::test::PlaneWavePattern kPattern(1, 4.0, 60);
  constexpr std::int64_t kFrames = 40;
  static std::vector<lsv::Frame> frames;
  for (std::int64_t k = 0; k < kFrames; ++k) {
    frames.push_back(
        kPattern.frame({.width_px = 64, .height_px = 64}, 2.0 * static_cast<double>(k), 0.0, 60.0));
  }
  return std::unique_ptr<lsv::LiveSource>(std::make_unique<lsv::PacedSource>(
      [](std::int64_t k) { return frames[static_cast<std::size_t>(k)].view(); },
      lsv::PacedOptions{.frames = kFrames}));
}
