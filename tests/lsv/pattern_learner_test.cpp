// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/pattern_learner.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

namespace lsv {
namespace {

constexpr int kSide_px = 128;
constexpr FrameFormat kFormat{
    .width_px = kSide_px, .height_px = kSide_px, .type = PixelType::mono16, .bit_depth = 16};
constexpr std::size_t kPixels = kSide_px * kSide_px;

/// Fully developed speckle: independent, exponentially distributed.
class CleanGround {
 public:
  explicit CleanGround(std::uint64_t seed) : random_(seed), frame_(kFormat) {}
  FrameView next(double mean_counts) {
    for (int y = 0; y < kSide_px; ++y) {
      std::uint16_t* const row = frame_.row16(y);
      for (int x = 0; x < kSide_px; ++x) {
        const double unit = (static_cast<double>(random_() >> 11) + 1.0) * 0x1p-53;
        row[x] = static_cast<std::uint16_t>(std::min(-mean_counts * std::log(unit), 65534.0));
      }
    }
    return frame_.view();
  }

 private:
  std::mt19937_64 random_;
  Frame frame_;
};

// A limit that one pixel in a million passes by chance would mark some here, and in one drive out
// of ten: the shifts of such a drive then have several times the noise.
TEST(PatternLearner, LeavesAllOfACleanSensorAlone) {
  const std::vector<float> factor(kPixels, 1.0F), less(kPixels, 0.0F);
  int marked = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    CleanGround ground(seed);
    PatternLearner learner(kFormat, {});
    for (int look = 0; look < 64; ++look) {
      if (!learner.look(ground.next(2000.0), factor, less)) continue;
      for (std::size_t i = 0; i < kPixels; ++i) {
        marked += learner.kind(i) == PatternLearner::PixelKind::clean ? 0 : 1;
      }
    }
  }
  EXPECT_EQ(marked, 0) << "seeds 1 to 20";
}

// Light that comes back: 20 bright looks among 300 dim ones say as little as 20.
TEST(PatternLearner, LightThatChangesMarksNothing) {
  const std::vector<float> factor(kPixels, 1.0F), less(kPixels, 0.0F);
  CleanGround ground(21);
  PatternLearner learner(kFormat, {});
  int judgements = 0;
  for (int look = 0; look < 400; ++look) {
    const bool is_bright = look < 20 || look >= 320;
    if (!learner.look(ground.next(is_bright ? 2000.0 : 200.0), factor, less)) continue;
    ++judgements;
    for (std::size_t i = 0; i < kPixels; ++i)
      ASSERT_EQ(learner.kind(i), PatternLearner::PixelKind::clean) << "seed 21, look " << look;
  }
  EXPECT_GE(judgements, 4);
}

}  // namespace
}  // namespace lsv
