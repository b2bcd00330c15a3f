// SPDX-License-Identifier: BSD-3-Clause
// Faults of the frames: A1 to A6 and A10 to A12.
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "sim/philox.h"
#include "tools/faults/scenario.h"

namespace lsv::faults {
namespace {

constexpr double kAsGoodAsClean = 0.001;  // of the distance
// Faults stand apart by this, so that each is an episode with its recovery.
constexpr std::int64_t kApart = 30;

/// `act` on stretches of `length` exposures, far apart, not at the very ends.
template <typename Act>
void for_stretches(Script& script, std::int64_t length, std::int64_t apart, const Act& act) {
  for (std::int64_t k = kApart + script.random(kApart); k + length + kApart < script.exposures();
       k += length + apart + script.random(apart)) {
    for (std::int64_t i = 0; i < length; ++i) act(k + i);
  }
}

void lose_at_random(Script& script, double share) {
  for (std::int64_t k = 1; k + 1 < script.exposures(); ++k) {
    if (script.chance(share)) script.lose(k);
  }
}

Scenario random_losses(double share) {
  const std::string percent = std::to_string(std::lround(100.0 * share)) + " %";
  return {.id = "A1 " + percent,
          .fault = percent + " of the frames lost at random",
          .alarms = kMissing,
          .inject = [share](Script& script) { lose_at_random(script, share); },
          // The run of losses is as long as it is; the next frame tells it.
          .limits = {.latency_frames = 20.0, .end_error_ratio = kAsGoodAsClean}};
}

Scenario bursts(std::int64_t length) {
  // A long one is told by the silence, before its end.
  const double told_after = std::min(static_cast<double>(length) + 1.0, 91.0);
  return {.id = "A2 " + std::to_string(length),
          .fault = "bursts of " + std::to_string(length) + " frames lost",
          .alarms = kMissing | kLost,
          .inject =
              [length](Script& script) {
                for_stretches(script, length, 10 * kApart, [&](std::int64_t k) { script.lose(k); });
              },
          .limits = {.latency_frames = told_after}};
}

void repeat_frames(Script& script) {
  for (std::int64_t k = 1; k + 1 < script.exposures(); ++k) {
    if (!script.chance(0.05)) continue;
    Delivery copy = script.at(k);
    copy.label.arrival_ns += kPeriod_ns / 3;
    script.deliveries.push_back(copy);
    script.mark(k);
    ++script.rejected[FrameRejection::duplicate];
  }
}

/// The camera goes on counting and shows one picture for `length` frames more.
Scenario frozen(std::int64_t length) {
  return {.id = "A3 frozen " + std::to_string(length),
          .fault = "one picture again, " + std::to_string(length) + " times with new ids",
          .alarms = kRefused,
          .inject =
              [length](Script& script) {
                std::int64_t first = -1;
                for_stretches(script, length, 2 * kApart, [&](std::int64_t k) {
                  if (first < 0 || k > first + length) first = k - 1;
                  script.at(k).picture = first;
                  script.mark(k);
                });
              },
          .limits = {.latency_frames = 3.0, .faulty_accepted_ratio = 0.0}};
}

/// Frames that arrive after others that were exposed later.
void delay_some(Script& script, std::int64_t least, std::int64_t most, bool lose_instead) {
  for_stretches(script, 1, 2 * kApart + most, [&](std::int64_t k) {
    const std::int64_t by = least + script.random(most - least + 1);
    if (k + by + 1 >= script.exposures()) return;
    if (lose_instead) return script.lose(k);
    script.at(k).label.arrival_ns += by * kPeriod_ns + kPeriod_ns / 3;
    // From its turn until it has come.
    for (std::int64_t i = 0; i <= by; ++i) script.mark(k + i);
    ++script.missing;
    ++script.rejected[FrameRejection::late];
  });
}

Scenario late(std::string id, std::string fault, std::int64_t least, std::int64_t most) {
  return {.id = std::move(id),
          .fault = std::move(fault),
          .alarms = kMissing | kRejected,
          .inject = [=](Script& script) { delay_some(script, least, most, false); },
          .limits = {.end_error_ratio = kAsGoodAsClean},
          .same_as = [=](Script& script) { delay_some(script, least, most, true); }};
}

Scenario spoilt(std::string id, std::string fault, std::function<void(Script&, std::int64_t)> spoil,
                std::optional<double> accepted_ratio = 0.0, std::int64_t length = 1) {
  return {.id = "A5 " + std::move(id),
          .fault = std::move(fault),
          .alarms = kRefused,
          .inject =
              [spoil = std::move(spoil), length](Script& script) {
                for_stretches(script, length, 2 * kApart, [&](std::int64_t k) {
                  spoil(script, k);
                  if (!script.faulty[static_cast<std::size_t>(k)]) script.mark(k);
                });
              },
          .limits = {.latency_frames = 2.0, .faulty_accepted_ratio = accepted_ratio}};
}

void fill(Frame& frame, std::uint8_t counts) {
  const FrameView view = frame.view();
  for (int y = 0; y < view.height_px(); ++y) std::fill_n(frame.row8(y), view.width_px(), counts);
}

/// Rows from `first` on, every `every`-th block of `block` rows, are those of another exposure, or
/// black.
Spoil other_rows(const Footage& footage, std::int64_t exposure, int first, int block, int every) {
  return [=, &footage](Frame& frame) {
    const FrameView view = frame.view();
    for (int y = first; y < view.height_px(); ++y) {
      if (((y - first) / block) % every != 0) continue;
      if (exposure < 0)
        std::fill_n(frame.row8(y), view.width_px(), std::uint8_t{0});
      else
        std::copy_n(footage.frame(exposure).row8(y), view.width_px(), frame.row8(y));
    }
  };
}

// Rows of a place that is nearer pull the shift by no more than the 0.05 px of I2: half the way,
// half of the rows being of either.
constexpr double kHarmless_px = 0.1;

/// Half of the rows are those of `before` exposures earlier.
void mix_in(Script& script, std::int64_t k, std::int64_t before, int first, int block, int every) {
  script.at(k).spoil = other_rows(script.footage, k - before, first, block, every);
  const Position& now = script.footage.position(k);
  const Position& then = script.footage.position(k - before);
  if (std::hypot(now.x_px - then.x_px, now.y_px - then.y_px) < kHarmless_px)
    script.mark_harmless(k);
}

/// The light of the laser times `factor`, with camera noise of its own.
Spoil dimmed(const Footage& footage, std::int64_t exposure, std::uint64_t seed, double factor) {
  return [=, &footage](Frame& frame) {
    const FrameView view = frame.view();
    const double dark = footage.camera().noise_mean_counts;
    for (int y = 0; y < view.height_px(); ++y) {
      for (int x = 0; x < view.width_px(); ++x) {
        const double noise =
            footage.camera().noise_sd_counts * std::sqrt(2.0) *
            sim::complex_normal(seed, sim::Stream::camera_noise, x, y, exposure).real();
        const double counts = dark + factor * (view.at(x, y) - dark) + noise;
        frame.row8(y)[x] = static_cast<std::uint8_t>(std::clamp(std::round(counts), 0.0, 255.0));
      }
    }
  };
}

Scenario light(std::string id, std::string fault, unsigned alarms, std::int64_t length,
               double (*factor)(std::int64_t exposure), Limits limits) {
  return {.id = "A6 " + std::move(id),
          .fault = std::move(fault),
          .alarms = alarms,
          .inject =
              [length, factor](Script& script) {
                const std::uint64_t seed = script.random_bits();
                for_stretches(script, length, 4 * kApart, [&](std::int64_t k) {
                  script.mark(k);
                  script.at(k).spoil = dimmed(script.footage, k, seed, factor(k));
                });
              },
          .limits = limits};
}

Scenario ground(std::string id, std::string fault, Scene scene, Limits limits) {
  limits.quiet_otherwise = false;
  limits.good_measured_ratio = 0.0;
  return {.id = std::move(id),
          .fault = std::move(fault),
          .scene = scene,
          .inject = [](Script&) {},
          .limits = limits};
}

Scenario foreign(std::string id, std::string fault, std::int64_t length, FrameFormat format) {
  return {.id = "A12 " + std::move(id),
          .fault = std::move(fault),
          .alarms = kRejected,
          .inject =
              [length, format](Script& script) {
                for_stretches(script, length, 6 * kApart, [&](std::int64_t k) {
                  script.mark(k);
                  script.at(k).format = format;
                  ++script.rejected[FrameRejection::wrong_format];
                });
              },
          .limits = {.latency_frames = 0.0}};
}

}  // namespace

std::vector<Scenario> frame_scenarios() {
  std::vector<Scenario> out;
  out.push_back({.id = "clean",
                 .fault = "none",
                 .inject = [](Script&) {},
                 .limits = {.end_error_ratio = kAsGoodAsClean, .coverage = true}});
  for (const double share : {0.01, 0.1, 0.5}) out.push_back(random_losses(share));
  for (const std::int64_t length : {5, 20, 100, 1000}) out.push_back(bursts(length));
  out.push_back({.id = "A3 same id",
                 .fault = "5 % of the frames come twice",
                 .alarms = kRejected,
                 .inject = repeat_frames,
                 .limits = {.latency_frames = 1.0, .end_error_ratio = kAsGoodAsClean},
                 .same_as = [](Script&) {}});
  for (const std::int64_t length : {1, 3, 50}) out.push_back(frozen(length));
  out.push_back(late("A4 1-5", "frames overtaken by 1 to 5 others", 1, 5));
  out.push_back(late("A4 50 ms", "frames late by 50 ms", 50, 50));

  out.push_back(spoilt("blank", "black frames", [](Script& script, std::int64_t k) {
    script.at(k).spoil = [](Frame& frame) { fill(frame, 0); };
  }));
  Scenario saturated = spoilt("saturated", "white frames", [](Script& script, std::int64_t k) {
    script.at(k).spoil = [](Frame& frame) { fill(frame, 255); };
  });
  saturated.alarms = kLight;
  out.push_back(std::move(saturated));
  const auto half = [](Script& script, std::int64_t k) {
    const int from = script.footage.format().height_px / 2;
    script.at(k).spoil = other_rows(script.footage, -1, from, 1, 1);
  };
  out.push_back(spoilt("half", "lower half black", half));
  const auto torn = [](Script& script, std::int64_t k) {
    const int from = script.footage.format().height_px / 2;
    mix_in(script, k, 5, from, 1, 1);
  };
  out.push_back(spoilt("torn", "lower half of five frames before", torn, std::nullopt));
  const auto stripes = [](Script& script, std::int64_t k) { mix_in(script, k, 20, 4, 8, 2); };
  out.push_back(spoilt("stripes", "every other 8 rows of 20 frames before", stripes, std::nullopt));

  out.push_back(light("off", "laser off for 0.3 s", kLight, 300, [](std::int64_t) { return 0.0; },
                      {.latency_frames = 2.0, .faulty_accepted_ratio = 0.0}));
  out.push_back(
      light("dim", "laser at 10 % for 0.3 s", 0, 300, [](std::int64_t) { return 0.1; }, {}));
  out.push_back(light("flicker", "laser flickers at 100 Hz to nothing for 0.3 s", 0, 300,
                      [](std::int64_t k) {
                        return 0.5 + 0.5 * std::cos(0.2 * 3.14159265 * static_cast<double>(k));
                      },
                      {}));

  out.push_back(ground("A10 speed", "up to 1.5 frames of motion per frame", Scene::too_fast, {}));
  out.push_back(ground("A10 blur", "up to 10 px of blur", Scene::blurred, {}));
  const std::pair<Scene, const char*> boiling[] = {
      {Scene::boiling_0, "0.99"}, {Scene::boiling_1, "0.9"}, {Scene::boiling_2, "0.7"},
      {Scene::boiling_3, "0.5"},  {Scene::boiling_4, "0.2"}, {Scene::boiling_5, "0"}};
  for (const auto& [scene, correlation] : boiling) {
    // Where next to nothing is accepted there is nothing to cover.
    const bool measures = scene != Scene::boiling_4 && scene != Scene::boiling_5;
    out.push_back(ground(std::string("A11 ") + correlation,
                         std::string("frames that correlate to ") + correlation, scene,
                         {.coverage = measures}));
  }

  FrameFormat wider{.width_px = 96, .height_px = 80};
  FrameFormat deeper{.width_px = 64, .height_px = 64, .type = PixelType::mono16, .bit_depth = 12};
  out.push_back(foreign("size", "5 frames of another size", 5, wider));
  out.push_back(foreign("depth", "50 frames of 12 bit", 50, deeper));
  return out;
}

}  // namespace lsv::faults
