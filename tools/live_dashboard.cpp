// SPDX-License-Identifier: BSD-3-Clause
#include "tools/live_dashboard.h"

#include <unistd.h>

#include <cmath>
#include <cstdio>

#include "lsv/output/number_text.h"

namespace lsv::cli {
namespace {

constexpr auto kRedraw = std::chrono::milliseconds(200);
constexpr auto kNextLine = std::chrono::seconds(1);

/// With its unit, or a dash where it is unknown.
std::string known(double value, const char* format) {
  if (!std::isfinite(value)) return "-";
  char text[48];
  // The formats are literals of this file.
  std::snprintf(text, sizeof text, format, value);
  return text;
}

std::string milliseconds(double seconds) { return known(seconds * 1e3, "%.2f"); }

std::string text(std::string_view word) { return std::string(word); }

double speed_m_s(const StepReport& last) {
  return std::hypot(last.velocity.vx_m_s, last.velocity.vy_m_s);
}

std::int64_t rejected(const HealthSnapshot& health) {
  std::int64_t sum = 0;
  for (const std::int64_t count : health.rejected) sum += count;
  return sum;
}

long long number(std::int64_t value) { return static_cast<long long>(value); }

}  // namespace

std::string latency_line(const HealthSnapshot& h) {
  return formatted("latency   p50 %s, p99 %s, p99.9 %s, max %s ms; %lld later than a period",
                   milliseconds(h.latency.p50_s).c_str(), milliseconds(h.latency.p99_s).c_str(),
                   milliseconds(h.latency.p999_s).c_str(), milliseconds(h.latency.max_s).c_str(),
                   number(h.deadline_misses));
}

std::string losses_line(const HealthSnapshot& h) {
  return formatted(
      "losses    %lld missing, %lld rejected, %lld dropped; transport %lld; opened anew "
      "%lld times",
      number(h.missing), number(rejected(h)), number(h.dropped), number(h.transport_losses),
      number(h.restarts));
}

std::vector<std::string> dashboard_block(const HealthSnapshot& h, const StepReport& last) {
  return {
      formatted("%-9s %s Hz, %lld frames", text(word(h.state)).c_str(),
                known(h.frame_rate_hz, "%.1f").c_str(), number(h.received)),
      latency_line(h),
      formatted("quality   Q %s, ZNCC %s; %lld shifts accepted, %lld refused; now: %s",
                known(last.shift.quality.q, "%.1f").c_str(),
                known(last.shift.quality.zncc, "%.3f").c_str(), number(h.shifts_ok),
                number(h.shifts_refused), text(word(last.shift.status)).c_str()),
      formatted("speed     %s m/s (%s, %s)", known(speed_m_s(last), "%.4f").c_str(),
                known(last.velocity.vx_m_s, "%+.4f").c_str(),
                known(last.velocity.vy_m_s, "%+.4f").c_str()),
      formatted("position  (%s, %s) m, sigma (%s, %s)", known(last.position.x_m, "%.4f").c_str(),
                known(last.position.y_m, "%.4f").c_str(),
                known(last.position.sigma_x_m, "%.2g").c_str(),
                known(last.position.sigma_y_m, "%.2g").c_str()),
      losses_line(h)};
}

std::string dashboard_line(const HealthSnapshot& h, const StepReport& last) {
  return formatted(
      "%s, %s Hz, %lld frames, latency p99 %s ms, Q %s, %s m/s, at (%s, %s) m, %lld missing, %lld "
      "rejected, %lld dropped",
      text(word(h.state)).c_str(), known(h.frame_rate_hz, "%.1f").c_str(), number(h.received),
      milliseconds(h.latency.p99_s).c_str(), known(last.shift.quality.q, "%.1f").c_str(),
      known(speed_m_s(last), "%.4f").c_str(), known(last.position.x_m, "%.4f").c_str(),
      known(last.position.y_m, "%.4f").c_str(), number(h.missing), number(rejected(h)),
      number(h.dropped));
}

LiveDashboard::LiveDashboard(bool quiet)
    : quiet_(quiet), terminal_(isatty(STDERR_FILENO) != 0), drawn_(Clock::now()) {}

LiveDashboard::~LiveDashboard() { wipe(); }

bool LiveDashboard::is_due() const {
  return !quiet_ && Clock::now() - drawn_ >= (terminal_ ? Clock::duration(kRedraw) : kNextLine);
}

void LiveDashboard::draw(const HealthSnapshot& health) {
  drawn_ = Clock::now();
  wipe();
  if (!terminal_) {
    std::fprintf(stderr, "lsv: %s\n", dashboard_line(health, last_).c_str());
    return;
  }
  const std::vector<std::string> lines = dashboard_block(health, last_);
  for (const std::string& line : lines) std::fprintf(stderr, "%s\n", line.c_str());
  lines_ = lines.size();
}

void LiveDashboard::tell(const StreamEvent& event) {
  if (quiet_ && event.severity == Severity::info) return;
  wipe();
  const char* const kind = event.severity == Severity::info      ? ""
                           : event.severity == Severity::warning ? "warning: "
                                                                 : "error: ";
  std::string line = event.text;  // may quote what a camera says
  for (char& c : line) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) c = '?';
  }
  std::fprintf(stderr, "lsv: %s%s: %s\n", kind, event.name.c_str(), line.c_str());
}

void LiveDashboard::wipe() {
  if (lines_ > 0) std::fprintf(stderr, "\033[%zuA\033[J", lines_);
  lines_ = 0;
}

}  // namespace lsv::cli
