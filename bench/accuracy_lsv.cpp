// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <utility>

#include "bench/accuracy_methods.h"
#include "bench/accuracy_pair.h"
#include "lsv/shift_meter.h"

namespace lsv::bench {
namespace {

class LsvMethod : public Method {
 public:
  LsvMethod(ShiftMeter meter, bool follows)
      : meter_(std::move(meter)),
        follows_(follows),
        earlier_(meter_.make_frame()),
        later_(meter_.make_frame()),
        reference_(meter_.make_reference()) {}

  Estimate measure(const FrameView& earlier, const FrameView& later) override {
    earlier_.load(earlier);
    later_.load(later);
    if (meter_.fitness(earlier_) != ShiftStatus::ok || meter_.fitness(later_) != ShiftStatus::ok)
      return {};
    meter_.build(earlier_, reference_);
    Shift found =
        meter_.refine(earlier_, reference_, later_, meter_.acquire(earlier_, later_)).shift;
    // As in a drive: the preset's own way of measuring, near where the pattern is expected.
    if (follows_ && found.status == ShiftStatus::ok)
      found = meter_.follow(earlier_, reference_, later_, found.dx_px, found.dy_px).shift;
    return {{found.dx_px, found.dy_px}, std::sqrt(found.cov.xx_px2), std::sqrt(found.cov.yy_px2)};
  }

 private:
  ShiftMeter meter_;
  bool follows_;
  TrackFrame earlier_;
  TrackFrame later_;
  TrackReference reference_;
};

}  // namespace

TrackConfig track_config(Preset preset, const sim::SpeckleConfig& camera) {
  TrackConfig out;
  out.preset = preset;
  out.calibration = cli::matching_calibration(camera);
  return out;
}

std::vector<NamedMethod> lsv_methods(const Condition& condition) {
  std::vector<NamedMethod> out;
  for (const Preset preset : {Preset::precise, Preset::fast, Preset::classic}) {
    TrackConfig config = track_config(preset, condition.camera);
    config.correlation.max_shift_px = condition.max_shift_px;
    ShiftMeter meter =
        require_value(ShiftMeter::create(config, sim::frame_format(condition.camera)));
    const bool follows = preset != Preset::classic;
    out.push_back({word(preset), std::make_unique<LsvMethod>(std::move(meter), follows)});
  }
  return out;
}

}  // namespace lsv::bench
