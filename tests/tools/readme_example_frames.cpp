// SPDX-License-Identifier: BSD-3-Clause
// The camera of docs/example.cpp: three frames of a moving pattern.
#include <algorithm>
#include <vector>

#include "lsv/core/stamp.h"
#include "tests/support/pattern.h"

bool next_frame(std::vector<std::byte>& pixels, lsv::Stamp& stamp);

bool next_frame(std::vector<std::byte>& pixels, lsv::Stamp& stamp) {
  static int index = 0;
  if (index == 3) return false;
  static const lsv::test::PlaneWavePattern kPattern(1, 4.0, 60);
  const lsv::Frame frame =
      kPattern.frame({.width_px = 128, .height_px = 128}, 2.0 * index, 0.0, 60.0);
  for (int y = 0; y < 128; ++y)
    std::copy_n(frame.view().data + y * frame.view().stride_bytes, 128, pixels.data() + y * 128);
  stamp.ns = 1'000'000 * index++;
  return true;
}
