// SPDX-License-Identifier: BSD-3-Clause
// The program behind `lsv simulate camera`: a GigE Vision camera on the loopback interface that
// sends laser speckle of which all is known.
#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <exception>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <thread>

#include "lsv/output/number_text.h"
#include "lsv/output/output_file.h"
#include "sim/speckle.h"
#include "tools/camera_simulator/exposures.h"
#include "tools/camera_simulator/gige_camera.h"
#include "tools/commands.h"
#include "tools/interrupt.h"
#include "tools/motion_options.h"
#include "tools/simulated_camera.h"

namespace lsv::cli {
namespace {

using Clock = std::chrono::steady_clock;

constexpr auto kLook = std::chrono::milliseconds(20);
constexpr double kMaxRate_hz = 10'000.0;

constexpr const char* kAbout =
    "A GigE Vision camera that any GenICam program can open: `lsv live genicam:127.0.0.1`, or\n"
    "arv-viewer. It has a clock of its own, 16-bit frame ids that soon wrap, and loses exposures\n"
    "when the machine is busy, as real ones do. The motion goes there and back without end.\n"
    "\n"
    "Says on stderr when it is ready, runs until --seconds are over or until Ctrl-C, and then\n"
    "prints on stdout, as JSON, what it sent. --truth has one row per frame sent: id and stamp as\n"
    "on the wire, position of the pattern, shift since the row before, FNV-1a of the pixels.\n"
    "\n"
    "A second camera needs an address of its own; as root: ip addr add 127.0.0.2/8 dev lo\n"
    "\n";
constexpr const char* kExample =
    "\n"
    "Example:\n"
    "  lsv simulate camera --rate-hz 250 --profile drive --speed-px 3 --seconds 60 --truth t.csv\n"
    "  lsv simulate camera --address 127.0.0.2 --serial LSV02 --packet-loss 5 --unplug-after-s "
    "10\n";

struct SimulatorOptions {
  GigeCameraConfig camera;
  SimulatedCamera optics;
  MotionOptions motion;
  int loop_frames = 500;
  double packet_loss_per_mille = 0.0;
  double jitter_us = 0.0;
  double unplug_after_s = 0.0;
  double unplug_for_s = 0.0;
  double seconds = 0.0;
  std::string truth;
};

Error usage(std::string message) { return {ErrorCode::invalid_argument, std::move(message)}; }

bool within(double value, double low, double high) { return value >= low && value <= high; }

Result<void> validate(const SimulatorOptions& o) {
  constexpr double kMaxTime_s = 1e7;
  const double rate_hz = o.optics.config.frame_rate_hz;
  if (!within(rate_hz, 0.1, kMaxRate_hz)) return usage("--rate-hz must be between 0.1 and 10000");
  if (!within(o.loop_frames, 2, 100'000)) return usage("--loop-frames must be in [2, 100000]");
  if (!within(o.packet_loss_per_mille, 0.0, 1000.0))
    return usage("--packet-loss must be between 0 and 1000 per mille");
  if (!within(o.jitter_us, 0.0, 0.5e6 / rate_hz))
    return usage("--jitter-us must be between 0 and half a period");
  if (!within(o.unplug_after_s, 0.0, kMaxTime_s) || !within(o.unplug_for_s, 0.0, kMaxTime_s) ||
      !within(o.seconds, 0.0, kMaxTime_s))
    return usage("--seconds, --unplug-after-s and --unplug-for-s must be between 0 and 1e7");
  if (o.camera.serial.empty() || o.camera.serial.size() > 15)
    return usage("--serial must have 1 to 15 characters");
  return {};
}

/// Every frame sent, counted and, on request, written down with its truth.
class Log {
 public:
  static Result<Log> open(const std::string& truth_path, const std::string& command) {
    Log log;
    if (truth_path.empty()) return log;
    Result<OutputFile> file = OutputFile::open(truth_path);
    if (!file) return file.error();
    log.truth_.emplace(std::move(file).value());
    const std::string head = "# lsv: " LSV_VERSION "\n# command: " + command +
                             "\n# units: stamp ns; position and shift px; positive x to larger "
                             "columns, positive y to larger rows\n"
                             "camera_id,stamp_ns,x_px,y_px,dx_px,dy_px,pixel_checksum\n";
    if (Result<void> written = log.truth_->write(head); !written) return written.error();
    return log;
  }

  Result<void> add(const std::vector<SentFrame>& sent) {
    std::string rows;
    for (const SentFrame& frame : sent) {
      if (sent_ > 0) missed_ += frame.exposure - last_.exposure - 1;
      if (truth_) append_row(frame, rows);
      last_ = frame;
      if (sent_++ == 0) first_id_ = frame.camera_id;
    }
    return truth_ && !rows.empty() ? truth_->write(rows) : Result<void>{};
  }

  Result<void> finish() {
    if (truth_) {
      if (Result<void> done = truth_->commit(); !done) return done;
    }
    nlohmann::ordered_json summary;
    summary["frames_sent"] = sent_;
    summary["exposures_missed"] = missed_;
    summary["first_camera_id"] = sent_ > 0 ? nlohmann::ordered_json(first_id_) : nullptr;
    summary["last_camera_id"] = sent_ > 0 ? nlohmann::ordered_json(last_.camera_id) : nullptr;
    std::printf("%s\n", summary.dump(2).c_str());
    if (std::fflush(stdout) != 0)
      return Error{ErrorCode::output_failed, "the count of the frames sent cannot be written"};
    return {};
  }

  std::int64_t sent() const { return sent_; }

 private:
  void append_row(const SentFrame& frame, std::string& rows) const {
    constexpr int kDecimals = 9;
    append_integer(rows, frame.camera_id);
    rows += ',';
    append_integer(rows, frame.stamp_ns);
    rows += ',';
    append_fixed(rows, frame.x_px, kDecimals);
    rows += ',';
    append_fixed(rows, frame.y_px, kDecimals);
    rows += ',';
    if (sent_ > 0) append_fixed(rows, frame.x_px - last_.x_px, kDecimals);
    rows += ',';
    if (sent_ > 0) append_fixed(rows, frame.y_px - last_.y_px, kDecimals);
    rows += formatted(",%016llx\n", static_cast<unsigned long long>(frame.checksum));
  }

  std::optional<OutputFile> truth_;
  SentFrame last_{};
  std::int64_t first_id_ = 0;
  std::int64_t sent_ = 0;
  std::int64_t missed_ = 0;
};

/// When the camera is off, counted from its first frame.
class Unplugging {
 public:
  explicit Unplugging(const SimulatorOptions& o)
      : after_s_(o.unplug_after_s), for_s_(o.unplug_for_s) {}

  bool is_off(double since_first_frame_s) const {
    if (after_s_ <= 0.0 || since_first_frame_s < after_s_) return false;
    return for_s_ <= 0.0 || since_first_frame_s < after_s_ + for_s_;
  }

 private:
  double after_s_;
  double for_s_;
};

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Until the time is over or someone interrupts.
Result<void> serve(const SimulatorOptions& o, GigeCamera& camera, Log& log) {
  const Clock::time_point start = Clock::now();
  const Unplugging unplugging(o);
  std::optional<Clock::time_point> first_frame;
  bool off = false;
  while (!interrupted() && (o.seconds <= 0.0 || seconds_since(start) < o.seconds)) {
    std::this_thread::sleep_for(kLook);
    if (Result<void> noted = log.add(camera.take_sent()); !noted) return noted;
    if (!first_frame && log.sent() > 0) first_frame = Clock::now();
    const bool shall_be_off = first_frame && unplugging.is_off(seconds_since(*first_frame));
    if (shall_be_off == off) continue;
    off = shall_be_off;
    if (off) {
      camera.unplug();
    } else if (Result<void> on = camera.plug_in(); !on) {
      return on;
    }
    std::fprintf(stderr, "lsv: camera %s is %s\n", o.camera.serial.c_str(),
                 off ? "unplugged" : "plugged in again");
  }
  camera.unplug();
  return log.add(camera.take_sent());
}

Result<void> simulate(SimulatorOptions& o, const std::string& command) {
  if (Result<void> valid = validate(o); !valid) return valid;
  const sim::SpeckleConfig& config = o.optics.config;
  Result<sim::MotionProfile> motion = motion_profile(o.motion, o.loop_frames, config.seed);
  if (!motion) return motion.error();
  Result<Exposures> exposures = Exposures::render(config, motion.value(), o.loop_frames,
                                                  static_cast<std::int64_t>(o.jitter_us * 1000.0));
  if (!exposures) return exposures.error();
  Result<Log> log = Log::open(o.truth, command);
  if (!log) return log.error();

  o.camera.rate_hz = config.frame_rate_hz;
  o.camera.packet_loss_ratio = o.packet_loss_per_mille / 1000.0;
  GigeCamera camera(o.camera, exposures.value());
  if (Result<void> on = camera.plug_in(); !on) return on;
  std::fprintf(stderr, "lsv: camera %s is ready at %s: %dx%d px, %g Hz\n", o.camera.serial.c_str(),
               o.camera.address.c_str(), config.width_px, config.height_px, config.frame_rate_hz);
  if (Result<void> served = serve(o, camera, log.value()); !served) return served;
  return log.value().finish();
}

void add_options(CLI::App& command, SimulatorOptions& o) {
  const auto number = [&command](const char* name, double& value, const char* what) {
    command.add_option(name, value, what)->capture_default_str();
  };
  o.optics.config.frame_rate_hz = 250.0;
  command.add_option("--address", o.camera.address, "Where it answers")->capture_default_str();
  command.add_option("--serial", o.camera.serial, "Its serial number")->capture_default_str();
  number("--seconds", o.seconds, "How long it runs; 0: until it is interrupted");
  command.add_option("--truth", o.truth, "CSV file of all frames sent");
  number("--packet-loss", o.packet_loss_per_mille, "Of 1000 packets, so many are lost");
  number("--jitter-us", o.jitter_us, "Exposures begin up to so much late");
  number("--unplug-after-s", o.unplug_after_s, "Gone so long after its first frame; 0: never");
  number("--unplug-for-s", o.unplug_for_s, "Back after so long; 0: never");
  command.add_option("--loop-frames", o.loop_frames, "Frames of the motion, before it goes back")
      ->capture_default_str();
  add_motion_options(command, o.motion);
  add_speckle_options(command, o.optics);
  add_camera_options(command, o.optics);
}

int run(int argc, char** argv) {
  CLI::App app{kAbout, "lsv simulate camera"};
  app.footer(std::string(kMotionHelp) + kExample);
  SimulatorOptions options;
  add_options(app, options);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);
    return report_error(usage(std::string(error.what()) + "; see lsv simulate camera --help"));
  }
  if (Result<void> resolved = resolve_camera(app, options.optics); !resolved)
    return report_error(resolved.error());
  catch_interrupts();
  const Result<void> done = simulate(options, command_line(app, ""));
  return done ? kExitOk : report_error(done.error());
}

}  // namespace
}  // namespace lsv::cli

int main(int argc, char** argv) {
  try {
    return lsv::cli::run(argc, argv);
  } catch (const std::exception& error) {
    return lsv::cli::report_error(
        {lsv::ErrorCode::output_failed, std::string("stopped by: ") + error.what()});
  }
}
