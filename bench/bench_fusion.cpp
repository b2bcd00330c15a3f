// SPDX-License-Identifier: BSD-3-Clause
// One predict and the updates of all sensors: two LSV sensors, two wheels and a gyro of one stamp.
#include <cmath>

#include "bench/lsv_bench.h"
#include "fusion/navigator.h"

namespace lsv::bench {
namespace {

constexpr std::int64_t kStep_ns = 1'000'000;
constexpr double kSpeed_m_s = 0.055;

FusionConfig rover(MotionModel model) {
  FusionConfig out;
  out.wheels = WheelConfig{0.1, 0.8, 0.017, {}};
  out.lsv = {{"a", 0.20, 0.25, 0.0, 7e-4}, {"b", 0.35, -0.30, 0.0, 7e-4}};
  out.gyro = GyroConfig{1e-3, 1e-3};
  out.motion.model = model;
  return out;
}

void epoch(benchmark::State& state, MotionModel model) {
  Navigator navigator = Navigator::create(rover(model)).value();
  std::int64_t k = 0;
  for (auto _ : state) {
    const Stamp stamp{++k * kStep_ns};
    navigator.add(GyroSample{stamp, 0.0});
    navigator.add(WheelSample{stamp, kSpeed_m_s / 0.1, kSpeed_m_s / 0.1});
    for (const std::size_t sensor : {0U, 1U})
      navigator.add(sensor, {.stamp = stamp, .vx_m_s = kSpeed_m_s, .vy_m_s = 0.0});
    benchmark::DoNotOptimize(navigator.state().x_m);
  }
  const double expected_m = kSpeed_m_s * static_cast<double>((k - 1) * kStep_ns) * 1e-9;
  const double error_m = std::abs(navigator.state().x_m - expected_m);
  require(state, error_m < 1e-3 + 1e-3 * expected_m ? "" : "the navigator is somewhere else");
}

}  // namespace

void register_fusion() {
  benchmark::RegisterBenchmark("fusion/epoch/constant_velocity", epoch,
                               MotionModel::constant_velocity);
  benchmark::RegisterBenchmark("fusion/epoch/constant_acceleration", epoch,
                               MotionModel::constant_acceleration);
}

}  // namespace lsv::bench
