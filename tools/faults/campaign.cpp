// SPDX-License-Identifier: BSD-3-Clause
#include "tools/faults/campaign.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <utility>

#include "lsv/stream/stream_pipeline.h"

namespace lsv::faults {
namespace {

/// Hides from the detector what it looks at, or takes it out of the settings.
void take_out(Broken broken, Script& script, TrackConfig& config, StreamOptions& stream) {
  const auto renumber = [&] {
    std::uint64_t id = 0;
    for (Delivery& delivery : script.deliveries) delivery.label.camera_id = ++id;
  };
  const auto restamp = [&] {
    for (std::size_t i = 0; i < script.deliveries.size(); ++i) {
      FrameLabel& label = script.deliveries[i].label;
      label.camera_ns = script.stamp_ns(static_cast<std::int64_t>(i));
    }
  };
  GateConfig& gate = config.gate;
  switch (broken) {
    case Broken::nothing:
      break;
    case Broken::loss_by_stamps:
    case Broken::order:
      renumber();
      restamp();
      break;
    case Broken::duplicate_ids:
      renumber();
      for (std::size_t i = 1; i < script.deliveries.size(); ++i) {
        FrameLabel& label = script.deliveries[i].label;
        label.camera_ns = label.arrival_ns;
      }
      break;
    case Broken::stamp_check:
      for (Delivery& delivery : script.deliveries) {
        const std::int64_t true_ns = script.stamp_ns(delivery.exposure);
        if (delivery.label.camera_ns != true_ns)
          delivery.label.camera_ns = true_ns + kPeriod_ns / 3;
      }
      break;
    case Broken::format_check:
      for (Delivery& delivery : script.deliveries) delivery.format.reset();
      break;
    case Broken::frozen_check:
      gate.refuse_frozen = false;
      break;
    case Broken::light_check:
      gate.min_signal_fraction = 0.0;
      gate.max_saturated_fraction = 1.0;
      gate.min_contrast_to_noise = 0.0;
      break;
    case Broken::row_check:
      gate.refuse_inconsistent = false;
      break;
    case Broken::correlation_gate:
      gate.min_zncc = -1.0;
      gate.min_zncc_sigmas = 0.0;
      gate.min_q = 0.0;
      gate.min_peak_ratio = 0.0;
      break;
    case Broken::covariance:
      break;  // in the sink between stream and checker
    case Broken::silence:
      stream.lost_after_ns = 10 * kNsPerS;
      break;
    case Broken::drop_oldest:
      stream.queue_frames = 65'536;
      break;
  }
}

/// Passes on what the checker is to see.
class Tampering : public StreamSink {
 public:
  Tampering(StreamSink& next, Broken broken) : next_(next), broken_(broken) {}
  void on_report(const StreamReport& report, Frame& frame) override {
    StreamReport out = report;
    if (broken_ == Broken::covariance) {
      for (double* const part :
           {&out.step.shift.cov.xx_px2, &out.step.shift.cov.xy_px2, &out.step.shift.cov.yy_px2})
        *part *= 0.01;
      out.step.position.sigma_x_m *= 0.1;
      out.step.position.sigma_y_m *= 0.1;
    }
    next_.on_report(out, frame);
  }
  void on_event(const StreamEvent& event) override { next_.on_event(event); }
  void on_health(const HealthSnapshot& health) override { next_.on_health(health); }

 private:
  StreamSink& next_;
  Broken broken_;
};

struct Run {
  Findings findings;
  std::int64_t missing = 0;  // as it should have been found
  std::int64_t bad_stamps = 0;
  std::map<FrameRejection, std::int64_t> rejected;
};

Result<Run> run_once(const Scenario& scenario, const std::function<void(Script&)>& inject,
                     const Footage& footage, std::uint64_t seed, const CampaignOptions& options) {
  Script script(footage, seed);
  inject(script);
  script.close();
  TrackConfig config = footage.config();
  config.preset = options.preset;
  config.learn_fixed_pattern = options.learn_fixed_pattern;
  StreamOptions stream = scenario.stream;
  take_out(options.broken, script, config, stream);

  VirtualClock clock(script.arrival_ns(-2));
  Checker checker(footage, script.deliveries, script.episodes, scenario.alarms, clock);
  Tampering tampering(checker, options.broken);
  auto made = StreamPipeline::create(config, script.info, stream, {&tampering}, clock.function());
  if (!made) return made.error();
  StreamPipeline& pipeline = *made.value();
  VirtualCamera camera(
      clock, script.info, [&](std::int64_t k) { return footage.frame(k); }, script.deliveries);
  for (int grabs = 1; pipeline.capture(camera); ++grabs) {
    checker.on_books(pipeline.health());
    if (scenario.work_every == 1) {
      while (pipeline.health().queued > 0) pipeline.work(0);
      pipeline.work(0);
    } else if (grabs % scenario.work_every == 0) {
      pipeline.work(0);
    }
  }
  while (pipeline.work(0)) {
  }
  return Run{.findings = checker.finish(pipeline.health()),
             .missing = script.missing,
             .bad_stamps = script.bad_stamps,
             .rejected = script.rejected};
}

std::string text(const char* format, double value) {
  char out[96];
  std::snprintf(out, sizeof out, format, value);
  return out;
}

void add(Findings& all, const Findings& one) {
  all.exposures += one.exposures;
  all.good_frames += one.good_frames;
  all.good_measured += one.good_measured;
  all.faulty_frames += one.faulty_frames;
  all.faulty_accepted += one.faulty_accepted;
  all.accepted += one.accepted;
  all.silent_errors += one.silent_errors;
  all.lies += one.lies;
  all.unsound += one.unsound;
  all.false_alarms += one.false_alarms;
  all.largest_error_px = std::max(all.largest_error_px, one.largest_error_px);
  all.largest_error_sigmas = std::max(all.largest_error_sigmas, one.largest_error_sigmas);
  all.end_error_ratio = std::fmax(all.end_error_ratio, one.end_error_ratio);
  all.segments += one.segments;
  all.episodes += one.episodes;
  all.latencies_frames.insert(all.latencies_frames.end(), one.latencies_frames.begin(),
                              one.latencies_frames.end());
  all.recoveries_frames.insert(all.recoveries_frames.end(), one.recoveries_frames.begin(),
                               one.recoveries_frames.end());
  all.axes += one.axes;
  all.axes_in_1_sigma += one.axes_in_1_sigma;
  all.axes_in_196_sigma += one.axes_in_196_sigma;
  all.health = one.health;
  all.path = one.path;
}

double ratio(std::int64_t part, std::int64_t whole) {
  return whole == 0 ? kUnknown : static_cast<double>(part) / static_cast<double>(whole);
}

/// Of sorted values: the smallest that a share of them does not exceed.
double quantile(const std::vector<double>& sorted, double share) {
  if (sorted.empty()) return kUnknown;
  const double rank = std::ceil(share * static_cast<double>(sorted.size()));
  return sorted[static_cast<std::size_t>(std::max(rank, 1.0)) - 1];
}

bool same_path(const std::vector<SensorPosition>& a, const std::vector<SensorPosition>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const SensorPosition& x, const SensorPosition& y) {
                      return x.x_m == y.x_m && x.y_m == y.y_m && x.sigma_x_m == y.sigma_x_m &&
                             x.sigma_y_m == y.sigma_y_m;
                    });
}

/// The invariants and the counts of one run.
void judge_run(const Scenario& scenario, const Run& run, std::uint64_t seed, Row& row) {
  const Limits& limits = scenario.limits;
  const Findings& found = run.findings;
  const HealthSnapshot& health = found.health;
  const auto broken = [&](const std::string& what) {
    row.broken_limits.push_back(what + " (seed " + std::to_string(seed) + ")");
  };
  const auto count = [&](std::int64_t is, std::int64_t expected, const char* what) {
    if (is != expected) {
      broken(std::to_string(is) + " " + what + " instead of " + std::to_string(expected));
    }
  };
  count(found.unsound, 0, "unsound books or outputs (I1, I3)");
  count(found.silent_errors, 0, "silent errors (I2)");
  count(found.lies, 0, "positions wrong in silence (I2)");
  if (limits.quiet_otherwise) count(found.false_alarms, 0, "false alarms (I6)");
  count(health.missing, run.missing, "exposures counted missing");
  if (limits.exact_stamps) count(health.bad_stamps, run.bad_stamps, "stamps replaced");
  for (std::size_t i = 0; i < kAllFrameRejections.size(); ++i) {
    const auto expected = run.rejected.find(kAllFrameRejections[i]);
    const std::string what = "frames rejected as " + std::string(word(kAllFrameRejections[i]));
    count(health.rejected[i], expected == run.rejected.end() ? 0 : expected->second, what.c_str());
  }
  if (!limits.may_drop) count(health.dropped, 0, "frames dropped");
  if (limits.queue_age_s && !(health.queue_age_max_s <= *limits.queue_age_s))
    broken(text("a frame waited %g s", health.queue_age_max_s));
  if (limits.end_error_ratio && !(found.end_error_ratio <= *limits.end_error_ratio))
    broken(text("distance off by %g of the way", found.end_error_ratio));
}

/// What takes all runs together.
void judge_row(const Scenario& scenario, Row& row) {
  const Limits& limits = scenario.limits;
  const Findings& all = row.all;
  // Before what concerns single runs.
  const auto broken = [&](const char* format, double value) {
    row.broken_limits.insert(row.broken_limits.begin(), text(format, value));
  };
  if (row.detects && !(row.detected_ratio >= limits.detected_ratio))
    broken("only %.4f of the faults told (I4)", row.detected_ratio);
  if (row.detects && !all.latencies_frames.empty() &&
      !(row.all.latencies_frames.back() <= limits.latency_frames))
    broken("a fault told after %g frames (I4)", row.all.latencies_frames.back());
  if (!all.recoveries_frames.empty() && !(row.recovery_max_frames <= limits.recovery_frames))
    broken("no shift for %g frames after a fault (I5)", row.recovery_max_frames);
  const double good = ratio(all.good_measured, all.good_frames);
  if (all.good_frames > 0 && !(good >= limits.good_measured_ratio))
    broken("only %.4f of the good frames measured", good);
  const double accepted = ratio(all.faulty_accepted, all.faulty_frames);
  if (limits.faulty_accepted_ratio && !(accepted <= *limits.faulty_accepted_ratio))
    broken("%.4f of the faulty frames accepted", accepted);
  if (limits.coverage) {
    const double one = ratio(all.axes_in_1_sigma, all.axes);
    const double most = ratio(all.axes_in_196_sigma, all.axes);
    if (!(std::abs(one - 0.68) <= 0.05)) broken("%.3f of the errors within 1 sigma", one);
    if (!(std::abs(most - 0.95) <= 0.03)) broken("%.3f of the errors within 1.96 sigma", most);
  }
}

}  // namespace

Result<Row> run_scenario(const Scenario& scenario, Scenes& scenes, const CampaignOptions& options) {
  const auto footage = scenes.get(scenario.scene);
  if (!footage) return footage.error();
  Row row{.id = scenario.id, .fault = scenario.fault, .detects = scenario.alarms != 0};
  for (int i = 0; i < options.seeds; ++i) {
    const std::uint64_t seed = options.first_seed + static_cast<std::uint64_t>(i);
    const auto run = run_once(scenario, scenario.inject, *footage.value(), seed, options);
    if (!run) return run.error();
    judge_run(scenario, run.value(), seed, row);
    add(row.all, run.value().findings);
    if (!scenario.same_as) continue;
    const auto reference =
        run_once(scenario, scenario.same_as, *footage.value(), seed, {.preset = options.preset});
    if (!reference) return reference.error();
    if (!same_path(run.value().findings.path, reference.value().findings.path)) {
      row.broken_limits.push_back("positions differ from those without the fault (seed " +
                                  std::to_string(seed) + ")");
    }
  }
  Findings& all = row.all;
  std::sort(all.latencies_frames.begin(), all.latencies_frames.end());
  std::sort(all.recoveries_frames.begin(), all.recoveries_frames.end());
  const double ms_per_frame = 1e-6 * static_cast<double>(kPeriod_ns);
  if (row.detects) {
    row.detected_ratio =
        ratio(static_cast<std::int64_t>(all.latencies_frames.size()), all.episodes);
    row.latency_median_ms = ms_per_frame * quantile(all.latencies_frames, 0.5);
    row.latency_p99_ms = ms_per_frame * quantile(all.latencies_frames, 0.99);
  }
  row.recovery_max_frames = quantile(all.recoveries_frames, 1.0);
  const double hours = ms_per_frame * static_cast<double>(all.exposures) / 3.6e6;
  if (scenario.limits.quiet_otherwise)
    row.false_alarms_per_h = static_cast<double>(all.false_alarms) / hours;
  judge_row(scenario, row);
  return row;
}

std::vector<Scenario> chosen_scenarios(const std::vector<std::string>& ids) {
  std::vector<Scenario> out;
  for (auto* const list : {&frame_scenarios, &time_scenarios, &resource_scenarios}) {
    for (Scenario& scenario : list()) {
      const bool is_chosen =
          ids.empty() || std::any_of(ids.begin(), ids.end(), [&](const std::string& id) {
            return scenario.id.rfind(id, 0) == 0;
          });
      if (is_chosen) out.push_back(std::move(scenario));
    }
  }
  return out;
}

}  // namespace lsv::faults
