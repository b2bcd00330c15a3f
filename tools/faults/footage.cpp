// SPDX-License-Identifier: BSD-3-Clause
#include "tools/faults/footage.h"

#include <utility>

#include "sim/motion_profile.h"
#include "tools/simulated_loop.h"

namespace lsv::faults {
namespace {

constexpr double kSpeedX_px = 3.0;
constexpr double kSpeedY_px = 1.2;

double correlation_of(Scene scene) {
  switch (scene) {
    case Scene::boiling_0:
      return 0.99;
    case Scene::boiling_1:
      return 0.9;
    case Scene::boiling_2:
      return 0.7;
    case Scene::boiling_3:
      return 0.5;
    case Scene::boiling_4:
      return 0.2;
    case Scene::boiling_5:
      return 0.0;
    default:
      return 1.0;
  }
}

/// From rest to `vx` and back again.
sim::MotionProfile there_and_back(double vx_px, double vy_px, double exposures) {
  const double quarter = exposures / 4.0;
  return sim::piecewise({{quarter, vx_px, vy_px},
                         {quarter, 0.0, 0.0},
                         {quarter, -vx_px, -vy_px},
                         {quarter, 0.0, 0.0}});
}

}  // namespace

Result<std::shared_ptr<const Footage>> Footage::render(const sim::SpeckleConfig& camera,
                                                       const sim::MotionProfile& motion,
                                                       std::int64_t exposures) {
  Result<sim::SpeckleCamera> source = sim::SpeckleCamera::create(camera);
  if (!source) return source.error();
  auto out = std::make_shared<Footage>();
  out->camera_ = camera;
  for (std::int64_t k = 0; k < exposures; ++k) {
    const sim::PatternMotion at = motion(k);
    Frame frame;
    if (Result<void> rendered = source.value().render(k, at, frame); !rendered)
      return rendered.error();
    out->frames_.push_back(std::move(frame));
    out->positions_.push_back({at.x_px, at.y_px});
  }
  return std::shared_ptr<const Footage>(std::move(out));
}

TrackConfig Footage::config() const {
  TrackConfig out;
  out.calibration = cli::matching_calibration(camera_);
  return out;
}

Result<std::shared_ptr<const Footage>> Scenes::get(Scene scene) {
  for (const auto& [known, footage] : rendered_) {
    if (known == scene) return footage;
  }
  sim::SpeckleConfig camera;
  camera.width_px = camera.height_px = side_px_;
  camera.rho = correlation_of(scene);
  camera.seed = 20 + static_cast<std::uint64_t>(scene);
  std::int64_t exposures = exposures_;
  sim::MotionProfile motion = sim::drive(kSpeedX_px, kSpeedY_px, static_cast<double>(exposures));
  if (scene != Scene::drive) {
    exposures = std::min<std::int64_t>(exposures_, 1000);  // the slow ones to render
    motion = sim::drive(kSpeedX_px, kSpeedY_px, static_cast<double>(exposures));
  }
  if (scene == Scene::too_fast) {
    motion = there_and_back(1.5 * side_px_, 0.3 * side_px_, static_cast<double>(exposures));
  } else if (scene == Scene::blurred) {
    camera.exposure_ratio = 1.0;
    motion = there_and_back(10.0, 2.0, static_cast<double>(exposures));
  }
  Result<std::shared_ptr<const Footage>> footage = Footage::render(camera, motion, exposures);
  if (footage) rendered_.emplace_back(scene, footage.value());
  return footage;
}

}  // namespace lsv::faults
