// SPDX-License-Identifier: BSD-3-Clause
// Answers the pairs of a file on the machine that it was compiled for:
//   neon_check FILE
// Prints the SIMD target; then for each pair what must be the same on every machine ("exact", to
// the bit, as hexadecimal fractions) and what must be nearly so ("shift", of either refinement).
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>

#include "correlation/kernels.h"
#include "correlation/tracker.h"
#include "tests/neon/frame_pairs.h"

namespace {

void print_exact(int k, const lsv::TrackFrame& earlier, const lsv::TrackFrame& later,
                 const lsv::LagWindow& window) {
  std::printf("exact %d found %d at %d %d zncc", k, window.found, window.dx_px, window.dy_px);
  for (const double zncc : window.zncc) std::printf(" %a", zncc);
  std::printf(" gain %a offset %a", window.gain, window.offset_counts);
  for (const lsv::TrackFrame* frame : {&earlier, &later}) {
    const lsv::FrameStats& stats = frame->stats();
    std::printf(" mean %a sd %a saturated %a", stats.mean_counts, stats.sd_counts,
                stats.saturated_fraction);
  }
  std::printf("\n");
}

void print_shift(int k, const char* refinement, const lsv::Shift& shift) {
  std::printf("shift %d %s %s %.9f %.9f %.9f\n", k, refinement, lsv::word(shift.status).data(),
              shift.dx_px, shift.dy_px, std::sqrt(shift.cov.xx_px2));
}

void answer(int k, const lsv::test::GuessedPair& pair) {
  const lsv::FrameFormat format = pair.earlier.view().format;
  lsv::TrackFrame earlier(format), later(format);
  earlier.load(pair.earlier.view());
  later.load(pair.later.view());
  print_exact(k, earlier, later,
              lsv::climb(earlier, later, static_cast<int>(pair.guess_dx_px),
                         static_cast<int>(pair.guess_dy_px)));
  for (const auto refinement : {lsv::Refinement::none, lsv::Refinement::icgn}) {
    lsv::Tracker tracker(format, refinement, 0.5);
    lsv::TrackReference reference(format);
    tracker.build(earlier, reference);
    print_shift(
        k, refinement == lsv::Refinement::icgn ? "icgn" : "none",
        tracker.measure(earlier, reference, later, pair.guess_dx_px, pair.guess_dy_px).shift);
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return std::fputs("usage: neon_check FILE\n", stderr), 2;
  std::ifstream in(argv[1], std::ios::binary);
  if (!in) return std::fprintf(stderr, "cannot read %s\n", argv[1]), EXIT_FAILURE;
  std::printf("target %s\n", lsv::kernels::simd_target().data());
  lsv::test::GuessedPair pair;
  for (int k = 0; lsv::test::read_pair(in, pair); ++k) answer(k, pair);
  return EXIT_SUCCESS;
}
