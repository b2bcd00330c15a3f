// SPDX-License-Identifier: BSD-3-Clause
// Frames of a camera with known truth, through every way that a transport can spoil them.
#include "lsv/stream/intake.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <vector>

namespace lsv {
namespace {

constexpr FrameFormat kFormat{.width_px = 8, .height_px = 8};
constexpr std::int64_t kPeriod_ns = 1'000'000;
constexpr std::int64_t kFirst_ns = 5'000'000'000;
constexpr std::int64_t kWay_ns = 150'000;  // exposure to arrival

LiveSourceInfo camera_info() {
  return {.description = "test", .format = kFormat, .period_ns = kPeriod_ns};
}

/// What the camera made of exposure `k`.
struct Sent {
  std::int64_t exposure = 0;
  FrameLabel label;
};

Sent sent(std::int64_t exposure) {
  const std::int64_t at_ns = kFirst_ns + exposure * kPeriod_ns;
  return {exposure,
          {.camera_id = static_cast<std::uint64_t>(exposure + 1),
           .camera_ns = at_ns,
           .arrival_ns = 77 * kNsPerS + at_ns + kWay_ns}};
}

std::vector<Sent> all_sent(std::int64_t exposures) {
  std::vector<Sent> out;
  for (std::int64_t k = 0; k < exposures; ++k) out.push_back(sent(k));
  return out;
}

struct Taken {
  std::int64_t exposure = 0;  // the truth
  std::int64_t index = 0;
  std::int64_t stamp_ns = 0;
  bool stamp_replaced = false;
};

struct Outcome {
  std::vector<Taken> taken;
  std::int64_t missing = 0;
  std::int64_t bad_stamps = 0;
  std::map<FrameRejection, int> rejected;
};

Outcome run(const std::vector<Sent>& frames, const LiveSourceInfo& info = camera_info()) {
  Intake intake(info);
  Outcome out;
  Frame frame(kFormat);
  for (const Sent& one : frames) {
    const Admission admission = intake.judge(frame, one.label);
    out.missing += admission.missing_before;
    if (admission.rejection != FrameRejection::none) {
      ++out.rejected[admission.rejection];
      continue;
    }
    out.bad_stamps += admission.stamp_replaced ? 1 : 0;
    out.taken.push_back({one.exposure, frame.index, frame.stamp.ns, admission.stamp_replaced});
  }
  return out;
}

/// Whatever happens: order, and all that was sent is accounted for.
void expect_sound(const Outcome& outcome, std::size_t sent_frames) {
  for (std::size_t i = 1; i < outcome.taken.size(); ++i) {
    ASSERT_GT(outcome.taken[i].stamp_ns, outcome.taken[i - 1].stamp_ns) << "frame " << i;
    ASSERT_GT(outcome.taken[i].index, outcome.taken[i - 1].index) << "frame " << i;
  }
  std::size_t rejected = 0;
  for (const auto& [reason, count] : outcome.rejected) rejected += static_cast<std::size_t>(count);
  EXPECT_EQ(outcome.taken.size() + rejected, sent_frames);
}

/// Every index is the exposure that it was, from the first frame that was taken on.
void expect_true_indices(const Outcome& outcome) {
  ASSERT_FALSE(outcome.taken.empty());
  const std::int64_t first = outcome.taken.front().exposure;
  for (const Taken& one : outcome.taken) ASSERT_EQ(one.index, one.exposure - first);
}

void expect_true_stamps(const Outcome& outcome, std::int64_t tolerance_ns) {
  for (const Taken& one : outcome.taken) {
    ASSERT_NEAR(static_cast<double>(one.stamp_ns),
                static_cast<double>(kFirst_ns + one.exposure * kPeriod_ns),
                static_cast<double>(tolerance_ns))
        << "exposure " << one.exposure;
  }
}

// The ids count what is sent. That the first frame has waited must not make the next one look as if
// it had come before its exposure.
TEST(Intake, AHoleBehindAFirstFrameThatCameLateIsCounted) {
  for (const std::int64_t late_ns : {kPeriod_ns, 5 * kPeriod_ns, 50 * kPeriod_ns}) {
    std::vector<Sent> frames = {sent(0)};
    frames[0].label.arrival_ns += late_ns;
    for (std::int64_t k = 2; k < 500; ++k) {
      frames.push_back(sent(k));
      --frames.back().label.camera_id;
      frames.back().label.arrival_ns =
          std::max(frames.back().label.arrival_ns, frames[frames.size() - 2].label.arrival_ns + 1);
    }
    const Outcome outcome = run(frames);
    expect_sound(outcome, frames.size());
    expect_true_indices(outcome);
    expect_true_stamps(outcome, 0);
    EXPECT_EQ(outcome.missing, 1);
    EXPECT_EQ(outcome.bad_stamps, 0);
  }
}

TEST(Intake, TakesGoodFramesAsTheyAre) {
  const Outcome outcome = run(all_sent(5000));
  expect_sound(outcome, 5000);
  EXPECT_EQ(outcome.taken.size(), 5000U);
  expect_true_indices(outcome);
  expect_true_stamps(outcome, 0);
  EXPECT_EQ(outcome.missing, 0);
  EXPECT_EQ(outcome.bad_stamps, 0);
}

// A1, A2, with every behaviour of the ids that was seen: they tell the losses, or they do not.
TEST(Intake, FindsLossesByTheStamps) {
  for (const bool ids_tell : {true, false}) {
    for (const double loss : {0.01, 0.1, 0.5}) {
      for (std::uint32_t seed = 1; seed <= 5; ++seed) {
        std::mt19937 random(seed);
        std::bernoulli_distribution lost(loss);
        std::vector<Sent> frames;
        for (const Sent& one : all_sent(3000)) {
          if (lost(random)) continue;
          frames.push_back(one);
          if (!ids_tell) frames.back().label.camera_id = frames.size();
        }
        const Outcome outcome = run(frames);
        expect_sound(outcome, frames.size());
        expect_true_indices(outcome);
        expect_true_stamps(outcome, 0);
        EXPECT_EQ(outcome.bad_stamps, 0) << "seed " << seed;
        EXPECT_EQ(outcome.missing, frames.back().exposure - frames.front().exposure + 1 -
                                       static_cast<std::int64_t>(frames.size()))
            << "seed " << seed << ", loss " << loss << ", ids tell " << ids_tell;
      }
    }
  }
}

TEST(Intake, ASuspendIsAnOutageOfThatManyFrames) {
  for (const bool ids_tell : {true, false}) {
    std::vector<Sent> frames;
    for (const Sent& one : all_sent(6000)) {
      if (one.exposure >= 2000 && one.exposure < 4000) continue;
      frames.push_back(one);
      if (!ids_tell) frames.back().label.camera_id = frames.size();
    }
    const Outcome outcome = run(frames);
    expect_true_indices(outcome);
    expect_true_stamps(outcome, 0);
    EXPECT_EQ(outcome.missing, 2000);
    EXPECT_EQ(outcome.bad_stamps, 0);
  }
}

// The process was stopped: the driver kept some frames, lost the rest, and all come at once.
TEST(Intake, AFrameThatWaitedInTheDriverIsNoAbsurdStamp) {
  std::vector<Sent> frames;
  std::int64_t id = 0;
  for (Sent one : all_sent(3000)) {
    if (one.exposure >= 1064 && one.exposure < 1500) continue;
    one.label.camera_id = static_cast<std::uint64_t>(++id);
    if (one.exposure >= 1000 && one.exposure < 1500)
      one.label.arrival_ns = sent(1500).label.arrival_ns;
    frames.push_back(one);
  }
  const Outcome outcome = run(frames);
  expect_true_indices(outcome);
  EXPECT_EQ(outcome.missing, 436);
  EXPECT_EQ(outcome.bad_stamps, 0);
}

// A3: the same id again, at once or later, with any stamp.
TEST(Intake, RefusesAnIdSeenBefore) {
  for (std::uint32_t seed = 1; seed <= 5; ++seed) {
    std::mt19937 random(seed);
    std::vector<Sent> frames;
    int copies = 0;
    for (const Sent& one : all_sent(2000)) {
      frames.push_back(one);
      if (random() % 10 != 0) continue;
      Sent copy = frames[frames.size() - 1 - random() % std::min<std::size_t>(frames.size(), 20)];
      copy.label.arrival_ns = one.label.arrival_ns + 100;
      if (random() % 2 == 0) copy.label.camera_ns = *one.label.camera_ns + kPeriod_ns / 2;
      frames.push_back(copy);
      ++copies;
    }
    const Outcome outcome = run(frames);
    expect_sound(outcome, frames.size());
    expect_true_indices(outcome);
    EXPECT_EQ(outcome.rejected.at(FrameRejection::duplicate), copies) << "seed " << seed;
    EXPECT_EQ(outcome.rejected.size(), 1U);
    EXPECT_EQ(outcome.missing, 0);
  }
}

// A4: a late frame is one that was lost, but for the count of late ones.
TEST(Intake, RefusesLateFramesAndIsThenAsIfTheyWereLost) {
  for (std::uint32_t seed = 1; seed <= 5; ++seed) {
    std::mt19937 random(seed);
    std::vector<Sent> frames;
    std::vector<Sent> without;
    int late = 0;
    for (const Sent& one : all_sent(3000)) {
      Sent moved = one;
      const bool is_late = one.exposure < 2900 && random() % 20 == 0;
      if (is_late) {
        const auto by = static_cast<std::int64_t>(random() % 2 == 0 ? 1 + random() % 5 : 50);
        moved.label.arrival_ns += by * kPeriod_ns + kPeriod_ns / 3;
        ++late;
      } else {
        without.push_back(one);
      }
      frames.push_back(moved);
    }
    std::stable_sort(frames.begin(), frames.end(), [](const Sent& a, const Sent& b) {
      return a.label.arrival_ns < b.label.arrival_ns;
    });
    const Outcome outcome = run(frames);
    const Outcome lost = run(without);
    expect_sound(outcome, frames.size());
    // One may be late by so little that all it overtakes is itself late.
    EXPECT_EQ(outcome.taken.size(),
              lost.taken.size() + static_cast<std::size_t>(late) -
                  static_cast<std::size_t>(outcome.rejected.at(FrameRejection::late)));
    expect_true_indices(outcome);
    expect_true_stamps(outcome, 0);
    EXPECT_EQ(outcome.rejected.size(), 1U) << "seed " << seed;
    EXPECT_GT(outcome.rejected.at(FrameRejection::late), late * 9 / 10);
  }
}

// T1.
TEST(Intake, ReplacesNonsenseStampsByIdTimesPeriod) {
  using Spoil = std::optional<std::int64_t> (*)(std::int64_t at_ns);
  const std::map<std::string, Spoil> ways = {
      {"absent", [](std::int64_t) { return std::optional<std::int64_t>{}; }},
      {"zero", [](std::int64_t) { return std::optional<std::int64_t>{0}; }},
      {"negative", [](std::int64_t at_ns) { return std::optional<std::int64_t>{-at_ns}; }},
      {"equal", [](std::int64_t at_ns) { return std::optional<std::int64_t>{at_ns - kPeriod_ns}; }},
      {"back",
       [](std::int64_t at_ns) { return std::optional<std::int64_t>{at_ns - 7 * kPeriod_ns}; }},
      {"least", [](std::int64_t) { return std::optional<std::int64_t>{INT64_MIN}; }},
      {"largest", [](std::int64_t) { return std::optional<std::int64_t>{INT64_MAX}; }},
      {"hour ahead",
       [](std::int64_t at_ns) { return std::optional<std::int64_t>{at_ns + 3600 * kNsPerS}; }},
      {"10 ms ahead",
       [](std::int64_t at_ns) { return std::optional<std::int64_t>{at_ns + 10 * kPeriod_ns}; }},
  };
  for (const auto& [name, spoil] : ways) {
    for (std::uint32_t seed = 1; seed <= 3; ++seed) {
      std::mt19937 random(seed);
      std::vector<Sent> frames;
      std::int64_t spoilt = 0;
      for (Sent one : all_sent(3000)) {
        if (random() % 20 == 0 && one.exposure > 0) continue;  // a loss
        if (random() % 10 == 0 && one.exposure > 0) {
          one.label.camera_ns = spoil(*one.label.camera_ns);
          ++spoilt;
        }
        frames.push_back(one);
      }
      const Outcome outcome = run(frames);
      expect_sound(outcome, frames.size());
      EXPECT_EQ(outcome.taken.size(), frames.size()) << name << ", seed " << seed;
      expect_true_indices(outcome);
      expect_true_stamps(outcome, 0);
      if (name == "equal") {
        // Where the frame before was lost, it is a stamp like any other.
        EXPECT_GT(outcome.bad_stamps, spoilt * 9 / 10);
      } else {
        EXPECT_EQ(outcome.bad_stamps, spoilt) << name << ", seed " << seed;
      }
    }
  }
}

TEST(Intake, LivesWithoutAnyStamp) {
  std::vector<Sent> frames;
  for (Sent one : all_sent(3000)) {
    if (one.exposure % 7 == 3) continue;
    one.label.camera_ns = std::nullopt;
    frames.push_back(one);
  }
  const Outcome outcome = run(frames);
  expect_sound(outcome, frames.size());
  expect_true_indices(outcome);
  EXPECT_EQ(outcome.bad_stamps, static_cast<std::int64_t>(frames.size()));
  EXPECT_EQ(outcome.taken.back().stamp_ns - outcome.taken.front().stamp_ns, 2998 * kPeriod_ns);
}

TEST(Intake, ACameraClockThatIsSetMakesNoStep) {
  for (const std::int64_t jump_ns : {3600 * kNsPerS, -4 * kNsPerS, 30'000'000L}) {
    std::vector<Sent> frames = all_sent(4000);
    for (Sent& one : frames) {
      if (one.exposure >= 2000) *one.label.camera_ns += jump_ns;
    }
    const Outcome outcome = run(frames);
    expect_sound(outcome, 4000);
    expect_true_indices(outcome);
    expect_true_stamps(outcome, 0);
    EXPECT_EQ(outcome.missing, 0) << jump_ns;
    EXPECT_EQ(outcome.bad_stamps, 8) << "until the new clock is believed";
  }
}

// T3: distance and bookkeeping must not depend on it.
TEST(Intake, JitterAndRateOfTheCameraChangeNoIndex) {
  for (const double rate_error : {-0.001, 0.0, 0.001}) {
    for (std::uint32_t seed = 1; seed <= 5; ++seed) {
      std::mt19937 random(seed);
      std::uniform_int_distribution<std::int64_t> jitter(-kPeriod_ns / 5, kPeriod_ns / 5);
      std::vector<Sent> frames;
      for (Sent one : all_sent(20'000)) {
        if (random() % 50 == 0 || (one.exposure > 9000 && one.exposure < 11'000)) continue;
        const auto drift_ns = static_cast<std::int64_t>(
            std::llround(rate_error * static_cast<double>(one.exposure * kPeriod_ns)));
        one.label.camera_ns = *one.label.camera_ns + drift_ns + jitter(random);
        one.label.arrival_ns += drift_ns + kPeriod_ns / 4;
        // Ids that tell the losses at first, and are contiguous later on.
        if (one.exposure > 9000) one.label.camera_id = frames.size() + 1'000'000;
        frames.push_back(one);
      }
      const Outcome outcome = run(frames);
      expect_sound(outcome, frames.size());
      expect_true_indices(outcome);
      EXPECT_EQ(outcome.bad_stamps, 0) << "seed " << seed << ", rate " << rate_error;
      EXPECT_EQ(outcome.taken.size(), frames.size());
    }
  }
}

// T4.
TEST(Intake, CountersNearTheirEndGiveTheSame) {
  std::mt19937 random(3);
  std::vector<Sent> frames;
  for (const Sent& one : all_sent(4000)) {
    if (random() % 10 == 0) continue;
    frames.push_back(one);
    if (random() % 50 == 0) frames.push_back(one);
  }
  const Outcome expected = run(frames);
  struct Counter {
    int bits;
    bool skips_zero;
  };
  for (const Counter counter : {Counter{16, true}, Counter{16, false}, Counter{32, false}}) {
    std::vector<Sent> wrapped = frames;
    const std::uint64_t turn = (std::uint64_t{1} << counter.bits) - (counter.skips_zero ? 1 : 0);
    for (Sent& one : wrapped) {
      const std::uint64_t position = (turn - 2000 + one.label.camera_id) % turn;
      one.label.camera_id = position + (counter.skips_zero ? 1 : 0);
    }
    LiveSourceInfo info = camera_info();
    info.id_bits = counter.bits;
    info.id_skips_zero = counter.skips_zero;
    const Outcome outcome = run(wrapped, info);
    ASSERT_EQ(outcome.taken.size(), expected.taken.size()) << counter.bits;
    EXPECT_EQ(outcome.missing, expected.missing);
    EXPECT_EQ(outcome.rejected, expected.rejected);
    for (std::size_t i = 0; i < expected.taken.size(); ++i) {
      ASSERT_EQ(outcome.taken[i].index, expected.taken[i].index);
      ASSERT_EQ(outcome.taken[i].stamp_ns, expected.taken[i].stamp_ns);
    }
  }
}

TEST(Intake, CameraClocksThatWrapGiveTheSame) {
  std::vector<Sent> frames;
  for (const Sent& one : all_sent(4000)) {
    if (one.exposure % 9 != 4) frames.push_back(one);
    if (one.exposure % 90 == 1) frames.push_back(sent(one.exposure - 1));
  }
  const Outcome expected = run(frames);
  // Microseconds and milliseconds in 32 bit.
  for (const std::int64_t unit_ns : {1000L, 1'000'000L}) {
    LiveSourceInfo info = camera_info();
    info.clock_wraps_ns = (std::int64_t{1} << 32) * unit_ns;
    std::vector<Sent> wrapped = frames;
    const std::int64_t begin_ns = info.clock_wraps_ns - 2000 * kPeriod_ns - kFirst_ns;
    for (Sent& one : wrapped)
      one.label.camera_ns = (*one.label.camera_ns + begin_ns) % info.clock_wraps_ns;
    const Outcome outcome = run(wrapped, info);
    ASSERT_EQ(outcome.taken.size(), expected.taken.size());
    EXPECT_EQ(outcome.missing, expected.missing);
    EXPECT_EQ(outcome.rejected, expected.rejected);
    // At the instant of the wrap the stamp is 0, which is no stamp.
    EXPECT_LE(outcome.bad_stamps, 1);
    for (std::size_t i = 0; i < expected.taken.size(); ++i) {
      ASSERT_EQ(outcome.taken[i].index, expected.taken[i].index);
      ASSERT_EQ(outcome.taken[i].stamp_ns - begin_ns, expected.taken[i].stamp_ns);
    }
  }
}

// R1: after the camera was opened anew, ids and clock are others.
TEST(Intake, ARestartGoesOnByTheTimeOfArrival) {
  Intake intake(camera_info());
  Frame frame(kFormat);
  for (const Sent& one : all_sent(100)) intake.judge(frame, one.label);
  EXPECT_EQ(frame.index, 99);
  const std::int64_t last_ns = frame.stamp.ns;
  intake.restart(camera_info());
  for (std::int64_t k = 0; k < 50; ++k) {
    Sent one = sent(600 + k);  // half a second later
    one.label.camera_id = static_cast<std::uint64_t>(k + 1);
    one.label.camera_ns = 1000 + k * kPeriod_ns;  // a clock that began again
    const Admission admission = intake.judge(frame, one.label);
    ASSERT_EQ(admission.rejection, FrameRejection::none);
    EXPECT_EQ(admission.missing_before, k == 0 ? 500 : 0);
    EXPECT_FALSE(admission.stamp_replaced);
    EXPECT_EQ(frame.index, 600 + k);
    EXPECT_EQ(frame.stamp.ns, last_ns + (501 + k) * kPeriod_ns);
  }
}

TEST(Intake, ACameraThatRestartsByItselfIsFollowed) {
  for (const bool clock_too : {false, true}) {
    std::vector<Sent> frames;
    for (Sent one : all_sent(2000)) {
      if (one.exposure >= 1000 && one.exposure < 1300) continue;
      if (one.exposure >= 1300) {
        one.label.camera_id -= 1300;
        if (clock_too) one.label.camera_ns = 1000 + (one.exposure - 1300) * kPeriod_ns;
      }
      frames.push_back(one);
    }
    const Outcome outcome = run(frames);
    expect_sound(outcome, frames.size());
    expect_true_indices(outcome);
    EXPECT_EQ(outcome.bad_stamps, 0);
    EXPECT_EQ(outcome.rejected.count(FrameRejection::late), clock_too ? 1U : 0U);
    EXPECT_GE(outcome.taken.size(), frames.size() - 10);
  }
}

TEST(Intake, AnIdThatIsWrongOnceChangesNothing) {
  std::vector<Sent> frames = all_sent(1000);
  frames[500].label.camera_id = 5501;
  frames[700].label.camera_id = std::uint64_t{1} << 40;
  frames[800].label.camera_id = 3;
  const Outcome outcome = run(frames);
  expect_sound(outcome, 1000);
  EXPECT_EQ(outcome.taken.size(), 1000U);
  expect_true_indices(outcome);
  expect_true_stamps(outcome, 0);
}

// They arrived: they are rejected, not missing.
TEST(Intake, DamagedAndForeignFramesAreNotMissing) {
  Intake intake(camera_info());
  Frame whole(kFormat);
  Frame foreign({.width_px = 9, .height_px = 8});
  std::int64_t missing = 0;
  std::map<FrameRejection, int> rejected;
  for (Sent one : all_sent(1000)) {
    one.label.damaged = one.exposure % 10 == 5;
    if (one.exposure % 100 == 75) {  // the label is damaged too
      one.label.camera_id = 0;
      one.label.camera_ns = 0;
    }
    const bool is_foreign = one.exposure % 10 == 7;
    const Admission admission = intake.judge(is_foreign ? foreign : whole, one.label);
    missing += admission.missing_before;
    ++rejected[admission.rejection];
    if (admission.rejection == FrameRejection::none) {
      ASSERT_EQ(whole.index, one.exposure);
    }
  }
  EXPECT_EQ(rejected[FrameRejection::damaged], 100);
  EXPECT_EQ(rejected[FrameRejection::wrong_format], 100);
  EXPECT_EQ(rejected[FrameRejection::none], 800);
  EXPECT_EQ(missing, 10) << "those without a label";
}

// All at once, and only what must always hold.
TEST(Intake, StaysSoundUnderAnything) {
  for (std::uint32_t seed = 1; seed <= 200; ++seed) {
    std::mt19937_64 random(seed);
    LiveSourceInfo info = camera_info();
    info.id_bits = random() % 2 == 0 ? 16 : 64;
    info.id_skips_zero = random() % 2 == 0;
    info.clock_wraps_ns = random() % 4 == 0 ? 4'294'967'296'000 : 0;
    Intake intake(info);
    Frame frame(kFormat);
    std::int64_t last_index = -1;
    std::int64_t last_ns = INT64_MIN;
    std::int64_t arrival_ns = 0;
    for (int i = 0; i < 400; ++i) {
      arrival_ns += static_cast<std::int64_t>(random() % 3) * kPeriod_ns / 2;
      FrameLabel label{.arrival_ns = arrival_ns};
      label.camera_id = random() % 3 == 0 ? random() : static_cast<std::uint64_t>(i);
      if (random() % 5 != 0) {
        label.camera_ns = random() % 3 == 0 ? static_cast<std::int64_t>(random())
                                            : arrival_ns + static_cast<std::int64_t>(random() % 99);
      }
      label.damaged = random() % 10 == 0;
      if (random() % 100 == 0) intake.restart(info);
      const Admission admission = intake.judge(frame, label);
      ASSERT_GE(admission.missing_before, 0) << "seed " << seed << ", frame " << i;
      if (admission.rejection != FrameRejection::none) continue;
      ASSERT_GT(frame.index, last_index) << "seed " << seed << ", frame " << i;
      ASSERT_GT(frame.stamp.ns, last_ns) << "seed " << seed << ", frame " << i;
      last_index = frame.index;
      last_ns = frame.stamp.ns;
    }
  }
}

}  // namespace
}  // namespace lsv
