// SPDX-License-Identifier: BSD-3-Clause
// The report of `lsv calibrate noise` for a terminal.
#include <cmath>

#include "lsv/core/config.h"
#include "lsv/core/frame.h"
#include "lsv/output/number_text.h"
#include "tools/noise_report.h"

namespace lsv::cli {
namespace {

constexpr double kMilli = 1e3;
constexpr double kMicro = 1e6;

/// Three digits, "-" where unknown.
std::string figure(double value, int width) {
  return std::isfinite(value) ? formatted("%*.3g", width, value) : formatted("%*s", width, "-");
}

void append_set_up(std::string& out, const NoiseReport& r) {
  const NoiseConditions& c = r.input.conditions;
  const Calibration& sensor = r.input.calibration;
  out += "sensor     " + sensor.sensor_name +
         formatted("\n           pitch %.4g x %.4g um, Sc %.5g along x, %.5g along y\n",
                   sensor.pixel_pitch_x_m * kMicro, sensor.pixel_pitch_y_m * kMicro,
                   sensor.sc_x_ratio, sensor.sc_y_ratio);
  out += formatted("frames     %d x %d px, %d bit, %.6g Hz, exposed for %.4g us\n", c.width_px,
                   c.height_px, c.bit_depth, r.input.rate_hz, r.input.exposure_s * kMicro);
  out += formatted(
      "pattern    speckle of %.3g px; %.5g mm/s along x moves it %.4g px per frame, %.3g px while\n"
      "           exposed; correlation from frame to frame %.6g\n",
      c.speckle_px, r.input.speed_m_s * kMilli, c.shift_px, c.blur_px, c.rho);
  out += formatted("light      mean signal %.4g counts of %.4g; camera noise %.3g counts; ",
                   c.mean_signal_counts, full_scale_counts(c.bit_depth) - c.dark_counts,
                   c.noise_sd_counts);
  out += std::isinf(c.electrons_per_count)
             ? "no shot noise (--full-well-e)\n"
             : formatted("%.4g electrons per count\n", c.electrons_per_count);
  if (c.rho == 1.0)
    out += "           the pattern is taken not to change (--rho): real ground is worse\n";
}

void append_row(std::string& out, const char* name, double x, double y, const char* note) {
  out += formatted("  %-26s", name) + figure(x, 10) + figure(y, 10) + note + "\n";
}

void append_sigma(std::string& out, const NoiseReport& r) {
  const NoisePrediction& p = r.pair;
  out += "\none shift between two frames     along x   along y\n";
  append_row(out, "noise, mpx", p.x.noise_px * kMilli, p.y.noise_px * kMilli, "");
  append_row(out, "change of pattern, mpx", p.x.boiling_px * kMilli, p.y.boiling_px * kMilli, "");
  append_row(out, "clipped pixels, mpx", p.x.clipping_px * kMilli, p.y.clipping_px * kMilli, "");
  append_row(out, "interpolation, mpx", p.x.interpolation_px * kMilli,
             p.y.interpolation_px * kMilli, "");
  append_row(out, "sigma of the shift, mpx", p.sigma_x_px * kMilli, p.sigma_y_px * kMilli, "");
  append_row(out, "velocity, mm/s", velocity_sigma_m_s(r.scale_x, p.sigma_x_px) * kMilli,
             velocity_sigma_m_s(r.scale_y, p.sigma_y_px) * kMilli, "");
  const TrackingNoise& t = r.tracking;
  out += "steady tracking\n";
  append_row(out, "from frame to frame, mpx", t.step_x_px * kMilli, t.step_y_px * kMilli, "");
  append_row(out, "velocity, mm/s", velocity_sigma_m_s(r.scale_x, t.step_x_px) * kMilli,
             velocity_sigma_m_s(r.scale_y, t.step_y_px) * kMilli, "");
  const double frames_per_m = r.input.rate_hz / r.input.speed_m_s;
  append_row(out, "position after 1 m, um",
             surface_m_per_px(r.scale_x) * std::sqrt(frames_per_m * t.drift_x_px2) * kMicro,
             surface_m_per_px(r.scale_y) * std::sqrt(frames_per_m * t.drift_y_px2) * kMicro,
             "   grows with the root of the distance");
  out += formatted("ZNCC %.4f, %.3g sigmas over chance (gate %g)", p.zncc, p.zncc_sigmas,
                   GateConfig{}.min_zncc_sigmas);
  if (t.frames_per_keyframe > 0)
    out += formatted("; a keyframe every %d frames", t.frames_per_keyframe);
  out += "\nThe sigma of the scale is not in these: random errors only.\n";
}

void append_sweeps(std::string& out, const NoiseReport& r) {
  out += "\nsigma of one shift along x, mpx, when one figure alone is changed\n";
  for (const NoiseSweep& sweep : r.sweeps) {
    out += formatted("  %-22s", std::string(sweep.name).c_str());
    for (const NoiseSweep::At& at : sweep.table) out += figure(at.value, 9);
    out += formatted("\n  %-22s", "");
    for (const NoiseSweep::At& at : sweep.table) out += figure(at.sigma_x_px * kMilli, 9);
    out += "\n";
  }
}

void append_choice(std::string& out, const NoiseReport& r) {
  out += formatted(
      "\nwhich window, rate and exposure for %.5g mm/s: least sigma of the velocity over %.4g ms\n"
      "  window      rate  exposure    shift     blur   signal   velocity    after 1 m   pixels\n"
      "      px        Hz        us       px       px   counts       mm/s           um   1e6/s\n",
      r.input.speed_m_s * kMilli, kMilli / r.input.update_hz);
  for (const WindowChoice& window : r.recommendation.windows) {
    if (!window.best) {
      out += formatted("  %6d  ", window.window_px) + std::string(advice(window.limit)) + "\n";
      continue;
    }
    const Choice& c = *window.best;
    const bool is_best = r.recommendation.best && r.recommendation.best->window_px == c.window_px;
    out += formatted("%c %6d%10.5g%10.4g%9.3g%9.3g%9.3g%11.3g%13.3g%9.3g\n", is_best ? '*' : ' ',
                     c.window_px, c.rate_hz, c.exposure_s * kMicro, c.shift_px, c.blur_px,
                     c.mean_signal_counts, c.update_sigma_m_s * kMilli, c.distance_sigma_m * kMicro,
                     c.rate_hz * c.window_px * c.window_px / kMicro);
  }
  if (!r.recommendation.best) return;
  const Choice& best = *r.recommendation.best;
  out += formatted("* %d x %d px at %.5g Hz, exposed for %.4g us: %.3g mm/s over %.4g ms\n",
                   best.window_px, best.window_px, best.rate_hz, best.exposure_s * kMicro,
                   best.update_sigma_m_s * kMilli, kMilli / r.input.update_hz);
  for (const std::string& reason : r.reasons) out += "    " + reason + "\n";
}

}  // namespace

std::string noise_text(const NoiseReport& report) {
  std::string out;
  append_set_up(out, report);
  append_sigma(out, report);
  append_sweeps(out, report);
  append_choice(out, report);
  if (!report.warnings.empty()) out += "\n";
  for (const std::string& warning : report.warnings) out += "warning: " + warning + "\n";
  return out;
}

}  // namespace lsv::cli
