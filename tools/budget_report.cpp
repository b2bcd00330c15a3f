// SPDX-License-Identifier: BSD-3-Clause
#include "tools/budget_report.h"

#include <cstdarg>
#include <cstdio>
#include <nlohmann/json.hpp>

namespace lsv::cli {
namespace {

using nlohmann::ordered_json;

[[gnu::format(printf, 2, 3)]] void append(std::string& out, const char* format, ...) {
  char line[256];
  va_list values;
  va_start(values, format);
  std::vsnprintf(line, sizeof line, format, values);
  va_end(values);
  out += line;
}

void append_row(std::string& out, const char* name, const DurationSummary& d) {
  append(out, "  %-26s %9.1f %9.1f %9.1f %9.1f %9.1f\n", name, d.mean_us, d.p50_us, d.p99_us,
         d.p999_us, d.max_us);
}

void append_column_names(std::string& out) {
  append(out, "  %-26s %9s %9s %9s %9s %9s\n", "us", "mean", "p50", "p99", "p99.9", "max");
}

void append_head(std::string& out, const Budget& b) {
  append(out, "machine    %s\n", b.cpu_model.c_str());
  append(out, "           SIMD %s, FFT %s\n", b.simd_target.c_str(), b.fft_backend.c_str());
  append(out, "frames     %d x %d px, %d bit, simulated speckle\n", b.format.width_px,
         b.format.height_px, b.format.bit_depth);
  append(out, "motion     to and fro, up to %.3g px per frame along either axis\n", b.max_step_px);
  append(out, "settings   preset %s; full search: engine %s, peak fit %s, lags +-%d x +-%d px\n",
         std::string(word(b.preset)).c_str(), std::string(word(b.correlation.engine)).c_str(),
         std::string(word(b.correlation.peak_fit)).c_str(), b.lags.max_dx_px, b.lags.max_dy_px);
}

void append_unpaced(std::string& out, const UnpacedTimes& t) {
  append(out, "\nAs fast as possible, %zu frames\n", t.push.samples);
  append_column_names(out);
  append_row(out, "whole push", t.push);
  append_row(out, "full search: prepare", t.prepare);
  append_row(out, "  correlate", t.correlate);
  append_row(out, "  peak and quality", t.peak_and_quality);
  append(out,
         "  at most %.0f frames per second; %zu of %zu shifts refused, largest error %.4f px\n",
         t.max_rate_hz(), t.shifts_refused, t.push.samples, t.largest_error_px);
}

void append_paced(std::string& out, const Budget& b) {
  const PacedTimes& t = b.paced;
  append(out, "\nOne frame every %.1f us (%.6g Hz), %zu of %zu frames measured\n", t.period_us,
         b.rate_hz, t.latency.samples, t.frames_due);
  append_column_names(out);
  append_row(out, "wake-up after due time", t.wake_up);
  append_row(out, "whole push", t.push);
  append_row(out, "latency: due to result", t.latency);
  append(out, "  %zu of %zu results late (after the next frame was due); headroom %.2f\n", t.late,
         t.frames_due, t.headroom());
}

void append_verdict(std::string& out, const Budget& b) {
  const PacedTimes& t = b.paced;
  if (t.holds()) {
    append(out, "\n%.6g Hz holds: 99.9 %% of the results were there before the next frame.\n",
           b.rate_hz);
    return;
  }
  append(out, "\n%.6g Hz does not hold: %zu of %zu results came after the next frame was due.\n",
         b.rate_hz, t.late, t.frames_due);
  if (t.push.p50_us < 0.5 * t.period_us) {
    append(
        out,
        "Half of the pushes took %.1f us or less: the late ones waited for the machine, not for\n"
        "the pipeline. Try again without other load, or with real-time priority (chrt -f 50).\n",
        t.push.p50_us);
  }
}

ordered_json to_json(const DurationSummary& d) {
  return {{"samples", d.samples}, {"mean", d.mean_us},  {"p50", d.p50_us},
          {"p99", d.p99_us},      {"p99_9", d.p999_us}, {"max", d.max_us}};
}

ordered_json to_json(const UnpacedTimes& t) {
  return {{"prepare_us", to_json(t.prepare)},
          {"correlate_us", to_json(t.correlate)},
          {"peak_and_quality_us", to_json(t.peak_and_quality)},
          {"push_us", to_json(t.push)},
          {"max_rate_hz", t.max_rate_hz()},
          {"shifts_refused", t.shifts_refused},
          {"largest_error_px", t.largest_error_px}};
}

ordered_json to_json(const PacedTimes& t) {
  return {{"period_us", t.period_us},         {"frames_due", t.frames_due},
          {"wake_up_us", to_json(t.wake_up)}, {"push_us", to_json(t.push)},
          {"latency_us", to_json(t.latency)}, {"late", t.late},
          {"headroom_ratio", t.headroom()}};
}

}  // namespace

std::string budget_text(const Budget& budget) {
  std::string out;
  append_head(out, budget);
  append_unpaced(out, budget.unpaced);
  append_paced(out, budget);
  append_verdict(out, budget);
  return out;
}

std::string budget_json(const Budget& b) {
  const ordered_json json = {{"schema", "lsv.budget/1"},
                             {"cpu_model", b.cpu_model},
                             {"simd_target", b.simd_target},
                             {"fft_backend", b.fft_backend},
                             {"rate_hz", b.rate_hz},
                             {"width_px", b.format.width_px},
                             {"height_px", b.format.height_px},
                             {"bit_depth", b.format.bit_depth},
                             {"preset", word(b.preset)},
                             {"max_step_px", b.max_step_px},
                             {"engine", word(b.correlation.engine)},
                             {"peak_fit", word(b.correlation.peak_fit)},
                             {"max_dx_px", b.lags.max_dx_px},
                             {"max_dy_px", b.lags.max_dy_px},
                             {"unpaced", to_json(b.unpaced)},
                             {"paced", to_json(b.paced)},
                             {"holds", b.paced.holds()}};
  // NaN (no frame was waited for, say) becomes null.
  return json.dump(2) + "\n";
}

}  // namespace lsv::cli
