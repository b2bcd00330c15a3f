// SPDX-License-Identifier: BSD-3-Clause
// Random numbers as a pure function of (seed, stream, three counters): the same on every compiler
// and in any order of evaluation, which the distributions of <random> do not promise.
// Generator: Philox4x32-10 (Salmon, Moraes, Dror, Shaw: Parallel random numbers: as easy as 1, 2,
// 3, SC11). Normal numbers by Box-Muller. No state, no allocation, safe from any thread.
#pragma once

#include <array>
#include <cmath>
#include <complex>
#include <cstdint>
#include <numbers>

namespace lsv::sim {

/// What a number is drawn for; streams never share numbers.
enum class Stream : std::uint32_t {
  ground = 0,
  boiling = 1,
  camera_noise = 2,
  shot_noise = 3,
  profile = 4,
  sensor_pattern = 5,
  flat_field = 6,
  reference_pose = 7,
  sensor_track = 8,
  exposure_jitter = 9,
  rover_drive = 10,
  encoder = 11,
  lsv_noise = 12,
  lsv_outlier = 13,
  imu = 14
};

using PhiloxWords = std::array<std::uint32_t, 4>;

inline PhiloxWords philox4x32(PhiloxWords counter, std::uint64_t key) {
  auto key_low = static_cast<std::uint32_t>(key);
  auto key_high = static_cast<std::uint32_t>(key >> 32);
  for (int round = 0; round < 10; ++round) {
    const std::uint64_t a = std::uint64_t{0xD2511F53} * counter[0];
    const std::uint64_t b = std::uint64_t{0xCD9E8D57} * counter[2];
    counter = {
        static_cast<std::uint32_t>(b >> 32) ^ counter[1] ^ key_low, static_cast<std::uint32_t>(b),
        static_cast<std::uint32_t>(a >> 32) ^ counter[3] ^ key_high, static_cast<std::uint32_t>(a)};
    key_low += 0x9E3779B9;
    key_high += 0xBB67AE85;
  }
  return counter;
}

/// Two independent numbers, uniform in (0, 1]. Counters are taken modulo 2^32.
inline std::array<double, 2> uniform_pair(std::uint64_t seed, Stream stream, std::int64_t i,
                                          std::int64_t j, std::int64_t k) {
  const PhiloxWords words =
      philox4x32({static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(j),
                  static_cast<std::uint32_t>(k), static_cast<std::uint32_t>(stream)},
                 seed);
  const auto unit = [](std::uint32_t high, std::uint32_t low) {
    const std::uint64_t bits = (std::uint64_t{high} << 32) | low;
    return static_cast<double>((bits >> 11) + 1) * 0x1p-53;
  };
  return {unit(words[0], words[1]), unit(words[2], words[3])};
}

/// Complex circular normal number with E|z|^2 = 1: each part has variance 1/2.
inline std::complex<double> complex_normal(std::uint64_t seed, Stream stream, std::int64_t i,
                                           std::int64_t j, std::int64_t k) {
  const auto [u, v] = uniform_pair(seed, stream, i, j, k);
  const double radius = std::sqrt(-std::log(u));
  const double angle_rad = 2.0 * std::numbers::pi * v;
  return {radius * std::cos(angle_rad), radius * std::sin(angle_rad)};
}

}  // namespace lsv::sim
