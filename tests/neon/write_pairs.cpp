// SPDX-License-Identifier: BSD-3-Clause
// Writes the frame pairs that the tracker is to answer alike on every machine:
//   neon_write_pairs FILE
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <utility>

#include "sim/speckle.h"
#include "tests/neon/frame_pairs.h"

namespace {

struct Condition {
  int width_px, height_px, bit_depth;
  double speckle_px;
  double mean_of_full_scale;
  double dx_px, dy_px;
  double guess_dx_px, guess_dy_px;
};

// Bright and large frames fill the integer sums; odd widths end within a vector; the last two
// guesses find nothing.
constexpr Condition kConditions[] = {
    {128, 128, 8, 4.0, 0.24, 1.37, -2.61, 1, -3},  {97, 141, 8, 4.0, 0.24, -0.5, 0.25, 0, 0},
    {64, 48, 8, 2.5, 0.24, 4.49, 3.51, 3, 2},      {141, 97, 12, 6.0, 0.24, 20.3, -10.8, 20, -10},
    {96, 80, 10, 3.0, 0.24, -6.2, 7.7, -6, 8},     {128, 128, 16, 4.0, 0.24, 0.02, 5.98, 0, 6},
    {512, 512, 8, 6.0, 0.9, 2.2, 1.1, 2, 1},       {300, 300, 12, 6.0, 0.9, -1.4, 0.9, -1, 1},
    {300, 300, 16, 6.0, 0.9, 0.6, 0.6, 1, 1},      {128, 128, 8, 4.0, 0.6, 2.63, -1.42, 3, -1},
    {128, 128, 8, 4.0, 0.24, 1.37, -2.61, 30, 30}, {64, 64, 12, 4.0, 0.24, 1.37, -2.61, 500, 0},
};

lsv::Result<lsv::sim::FramePair> rendered(const Condition& c) {
  lsv::sim::SpeckleConfig config;
  config.width_px = c.width_px;
  config.height_px = c.height_px;
  config.bit_depth = c.bit_depth;
  config.speckle_px = c.speckle_px;
  config.mean_signal_counts = c.mean_of_full_scale * lsv::full_scale_counts(c.bit_depth);
  return lsv::sim::render_pair(config, 20260401, c.dx_px, c.dy_px);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return std::fputs("usage: neon_write_pairs FILE\n", stderr), 2;
  std::ofstream out(argv[1], std::ios::binary);
  for (const Condition& c : kConditions) {
    auto pair = rendered(c);
    if (!pair) return std::fprintf(stderr, "%s\n", pair.error().message.c_str()), EXIT_FAILURE;
    lsv::test::GuessedPair guessed{.earlier = std::move(pair.value().first),
                                   .later = std::move(pair.value().second),
                                   .guess_dx_px = c.guess_dx_px,
                                   .guess_dy_px = c.guess_dy_px};
    lsv::test::write_pair(out, guessed);
  }
  out.close();
  if (!out) return std::fprintf(stderr, "cannot write %s\n", argv[1]), EXIT_FAILURE;
  return EXIT_SUCCESS;
}
