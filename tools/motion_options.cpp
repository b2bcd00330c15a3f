// SPDX-License-Identifier: BSD-3-Clause
#include "tools/motion_options.h"

#include <cmath>
#include <filesystem>
#include <utility>

namespace lsv::cli {
namespace {

constexpr double kMaxSpeed_px = 1e4;

Error usage(std::string message) { return {ErrorCode::invalid_argument, std::move(message)}; }

bool in_range(double value, double limit) { return std::abs(value) <= limit; }

Result<sim::MotionProfile> read_profile(const std::string& path, std::int64_t frames) {
  Result<sim::MotionTable> table = sim::read_motion_table(path);
  if (!table) return table.error();
  if (table.value().frames < frames) {
    return usage(path + " holds " + std::to_string(table.value().frames) +
                 " positions but --frames asks for " + std::to_string(frames));
  }
  return std::move(table.value().profile);
}

}  // namespace

void add_motion_options(CLI::App& command, MotionOptions& o) {
  command.add_option("--profile", o.profile, "Motion, see below")->capture_default_str();
  command.add_option("--speed-px", o.speed_px, "Greatest speed along x, px per frame")
      ->capture_default_str();
  command.add_option("--speed-y-px", o.speed_y_px, "Greatest speed along y, px per frame")
      ->capture_default_str();
  command.add_option("--period-frames", o.period_frames, "Period of the sinusoid, frames")
      ->capture_default_str();
}

Result<sim::MotionProfile> motion_profile(const MotionOptions& o, std::int64_t frames,
                                          std::uint64_t seed) {
  if (!in_range(o.speed_px, kMaxSpeed_px) || !in_range(o.speed_y_px, kMaxSpeed_px))
    return usage("--speed-px and --speed-y-px must be within 10000 px per frame");
  if (!(o.period_frames > 0.0 && o.period_frames <= 1e9))
    return usage("--period-frames must be above 0 and at most 1e9");
  if (o.profile == "parked") return sim::parked();
  if (o.profile == "constant") return sim::constant_velocity(o.speed_px, o.speed_y_px);
  if (o.profile == "drive")
    return sim::drive(o.speed_px, o.speed_y_px, static_cast<double>(frames));
  if (o.profile == "sinusoid") return sim::sinusoid(o.speed_px, o.speed_y_px, o.period_frames);
  if (o.profile == "random") return sim::random_shifts(o.speed_px, o.speed_y_px, frames, seed);
  if (std::filesystem::path(o.profile).extension() == ".csv")
    return read_profile(o.profile, frames);
  return usage("--profile is \"" + o.profile +
               "\" but must be parked, constant, drive, sinusoid, random or a .csv file");
}

}  // namespace lsv::cli
