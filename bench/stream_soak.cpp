// SPDX-License-Identifier: BSD-3-Clause
// A stream at a camera's rate for minutes or hours: what is lost, late, leaked or wrong?
//   stream_soak --seconds 600 --rate-hz 1000
// The source is in the same process: simulated speckle rendered before, with its truth. Ends with 1
// when a limit is broken, with 2 when something cannot be done.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "bench/resident_memory.h"
#include "lsv/stream/paced_source.h"
#include "lsv/stream/stream.h"
#include "tests/support/allocation_counter.h"
#include "tools/cpu_model.h"
#include "tools/simulated_loop.h"

namespace lsv::bench {
namespace {

constexpr double kMicro = 1e6;
constexpr double kMega = 1e6;
constexpr int kLoopFrames = 200;
constexpr double kMaxStep_px = 5.0;

struct SoakOptions {
  double seconds = 600.0;
  double warm_up_s = 5.0;
  double rate_hz = 1000.0;
  int side_px = 128;
  int fifo_priority = 0;
  double p999_limit_us = 1000.0;
  double error_limit_px = 0.02;
  double growth_limit_mb_per_h = 1.0;
};

/// Holds every shift against the truth of the loop. On the worker thread.
class TruthCheck : public StreamSink {
 public:
  TruthCheck(const cli::SimulatedLoop& loop, std::int64_t period_ns)
      : loop_(loop), period_ns_(period_ns) {}

  void on_report(const StreamReport& report, Frame&) override {
    const StepReport& step = report.step;
    if (step.shift.status != ShiftStatus::ok) return;
    const std::int64_t since = step.frame - (step.dt_ns + period_ns_ / 2) / period_ns_;
    cli::TrueShift truth;
    for (std::int64_t k = since + 1; k <= step.frame; ++k) {
      const cli::TrueShift one = loop_.shift(k);
      truth = {truth.dx_px + one.dx_px, truth.dy_px + one.dy_px};
    }
    largest_px_ = std::max({largest_px_, std::abs(step.shift.dx_px - truth.dx_px),
                            std::abs(step.shift.dy_px - truth.dy_px)});
  }
  void on_event(const StreamEvent& event) override {
    std::fprintf(stderr, "%s: %s\n", event.name.c_str(), event.text.c_str());
  }
  void on_health(const HealthSnapshot&) override {}

  double largest_px() const { return largest_px_; }

 private:
  const cli::SimulatedLoop& loop_;
  std::int64_t period_ns_;
  double largest_px_ = 0.0;
};

/// Prints what was measured beside its limit.
class Verdict {
 public:
  void at_most(const char* what, double value, double limit, const char* unit) {
    const bool holds = value <= limit;  // NaN does not
    broken_ += holds ? 0 : 1;
    std::printf("%-34s %12.6g %-5s (limit %g)%s\n", what, value, unit, limit,
                holds ? "" : "  BROKEN");
  }
  bool holds() const { return broken_ == 0; }

 private:
  int broken_ = 0;
};

int soak(const SoakOptions& options) {
  sim::SpeckleConfig camera;
  camera.width_px = camera.height_px = options.side_px;
  camera.frame_rate_hz = options.rate_hz;
  const auto loop = cli::SimulatedLoop::render(camera, kMaxStep_px, kLoopFrames);
  if (!loop) {
    std::fprintf(stderr, "stream_soak: %s\n", loop.error().message.c_str());
    return 2;
  }
  const auto frames = static_cast<std::int64_t>(options.seconds * options.rate_hz);
  const std::int64_t period_ns = std::llround(static_cast<double>(kNsPerS) / options.rate_hz);
  TruthCheck truth(loop.value(), period_ns);
  auto source =
      std::make_unique<PacedSource>([&](std::int64_t k) { return loop.value().frame(k); },
                                    PacedOptions{.period_ns = period_ns, .frames = frames});
  std::vector<std::int64_t> memory_bytes;
  memory_bytes.reserve(static_cast<std::size_t>(options.seconds) + 10);

  const std::int64_t start_bytes = resident_bytes();
  auto started = Stream::start(
      std::move(source), cli::loop_config(camera),
      {.fifo_priority = options.fifo_priority, .lock_memory = options.fifo_priority > 0}, {&truth});
  if (!started) {
    std::fprintf(stderr, "stream_soak: %s\n", started.error().message.c_str());
    return 2;
  }
  Stream& stream = *started.value();
  std::this_thread::sleep_for(std::chrono::duration<double>(options.warm_up_s));
  const std::int64_t warm_bytes = resident_bytes();
  test::count_allocations(true);
  while (!stream.finished()) {
    if (memory_bytes.size() < memory_bytes.capacity()) memory_bytes.push_back(resident_bytes());
    std::this_thread::sleep_for(std::chrono::seconds(1));
  }
  test::count_allocations(false);
  const long allocations = test::allocations();
  const std::int64_t end_bytes = resident_bytes();
  const HealthSnapshot health = stream.health();

  const auto megabytes = [](std::int64_t bytes) { return static_cast<double>(bytes) / kMega; };
  std::printf("%s; %.0f s at %.0f Hz, %d x %d px, 8 bit, %s\n", cli::cpu_model().c_str(),
              options.seconds, options.rate_hz, options.side_px, options.side_px,
              options.fifo_priority > 0 ? "SCHED_FIFO, memory locked" : "ordinary priority");
  std::printf("received %lld, processed %lld, shifts accepted %lld, refused %lld\n",
              static_cast<long long>(health.received), static_cast<long long>(health.processed),
              static_cast<long long>(health.shifts_ok),
              static_cast<long long>(health.shifts_refused));
  std::printf(
      "latency p50 %.1f us, p99 %.1f us, max %.1f us; queue age max %.1f us; deadline "
      "misses %lld\n",
      kMicro * health.latency.p50_s, kMicro * health.latency.p99_s, kMicro * health.latency.max_s,
      kMicro * health.queue_age_max_s, static_cast<long long>(health.deadline_misses));
  std::printf("memory at start %.2f MB, warm %.2f MB, end %.2f MB\n", megabytes(start_bytes),
              megabytes(warm_bytes), megabytes(end_bytes));
  Verdict verdict;
  verdict.at_most("frames not received", static_cast<double>(frames - health.received), 0.0, "");
  verdict.at_most("dropped by the queue", static_cast<double>(health.dropped), 0.0, "");
  verdict.at_most("latency p99.9", kMicro * health.latency.p999_s, options.p999_limit_us, "us");
  verdict.at_most("allocations after warm-up", static_cast<double>(allocations), 0.0, "");
  verdict.at_most("growth of memory after warm-up", slope_bytes_per_h(memory_bytes) / kMega,
                  options.growth_limit_mb_per_h, "MB/h");
  verdict.at_most("shifts refused", static_cast<double>(health.shifts_refused), 0.0, "");
  verdict.at_most("largest error of a shift", truth.largest_px(), options.error_limit_px, "px");
  return verdict.holds() ? 0 : 1;
}

}  // namespace
}  // namespace lsv::bench

int main(int argc, char** argv) {
  lsv::bench::SoakOptions o;
  CLI::App app{"stream_soak: a stream at a camera's rate, for long"};
  app.add_option("--seconds", o.seconds)->check(CLI::Range(6.0, 1e6))->capture_default_str();
  app.add_option("--rate-hz", o.rate_hz)->check(CLI::Range(1.0, 1e5))->capture_default_str();
  app.add_option("--size", o.side_px, "Side of the frames, px")->capture_default_str();
  app.add_option("--realtime", o.fifo_priority, "SCHED_FIFO priority; 0: ordinary")
      ->capture_default_str();
  app.add_option("--p999-us", o.p999_limit_us, "Limit of the p99.9 of the latency")
      ->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  return lsv::bench::soak(o);
}
