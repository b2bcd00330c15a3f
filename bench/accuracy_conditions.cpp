// SPDX-License-Identifier: BSD-3-Clause
#include "bench/accuracy_conditions.h"

#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>

#include "bench/frames.h"

namespace lsv::bench {
namespace {

constexpr int kSide_px = 128;
constexpr std::uint64_t kShiftStream = 0x9e3779b97f4a7c15;

Condition condition(std::string_view name, std::string_view meaning) {
  Condition out{.name = name, .meaning = meaning};
  out.camera = camera(kSide_px, 8);
  out.camera.mean_signal_counts = 60.0;
  out.camera.noise_mean_counts = 3.0;
  out.camera.noise_sd_counts = 0.5;
  return out;
}

Condition far(std::string_view name, std::string_view meaning, double range_px) {
  Condition out = condition(name, meaning);
  out.range_px = range_px;
  out.template_px = 64;
  return out;
}

Condition boiling(std::string_view name, std::string_view meaning, double rho) {
  Condition out = condition(name, meaning);
  out.camera.rho = rho;
  return out;
}

std::vector<Condition> make_conditions() {
  std::vector<Condition> out;
  out.push_back(condition("A", "no camera noise: rounding and clipping only"));
  out.back().camera.noise_sd_counts = 0.0;
  out.push_back(condition("B", "camera noise of 0.5 counts"));
  out.push_back(condition("S", "B with shot noise, full well 10 000 electrons"));
  out.back().camera.full_well_electrons = 10000.0;
  out.push_back(far("C16", "B, shifts up to 16 px per axis", 16.0));
  out.push_back(far("C32", "B, shifts up to 32 px per axis, lsv searches 40 px", 32.0));
  out.back().max_shift_px = 40;
  out.push_back(condition("E", "B, 3 px in any direction, exposed for half of the interval"));
  out.back().law = ShiftLaw::circle;
  out.back().camera.exposure_ratio = 0.5;
  out.push_back(condition("F", "low light: mean 12 counts, camera noise of 2 counts"));
  out.back().camera.mean_signal_counts = 12.0;
  out.back().camera.noise_sd_counts = 2.0;
  out.push_back(boiling("G999", "B, intensity correlation 0.999 from frame to frame", 0.999));
  out.push_back(boiling("G990", "the same, 0.99", 0.99));
  out.push_back(boiling("D90", "the same, 0.9", 0.9));
  out.push_back(boiling("D70", "the same, 0.7", 0.7));
  return out;
}

/// [0, 1), the same with every standard library.
double unit_random(std::mt19937_64& engine) {
  return static_cast<double>(engine() >> 11) * 0x1p-53;
}

}  // namespace

const std::vector<Condition>& conditions() {
  static const std::vector<Condition> all = make_conditions();
  return all;
}

const Condition& condition_named(std::string_view name) {
  for (const Condition& candidate : conditions())
    if (candidate.name == name) return candidate;
  throw std::out_of_range("there is no condition of that name");
}

std::uint64_t pair_seed(int pair) { return kSeed + static_cast<std::uint64_t>(pair); }

cli::TrueShift true_shift(const Condition& condition, int pair) {
  std::mt19937_64 engine(pair_seed(pair) ^ kShiftStream);
  const double u = unit_random(engine);
  const double v = unit_random(engine);
  if (condition.law == ShiftLaw::circle) {
    const double angle_rad = 2.0 * std::numbers::pi * u;
    return {condition.range_px * std::cos(angle_rad), condition.range_px * std::sin(angle_rad)};
  }
  return {condition.range_px * (2.0 * u - 1.0), condition.range_px * (2.0 * v - 1.0)};
}

}  // namespace lsv::bench
