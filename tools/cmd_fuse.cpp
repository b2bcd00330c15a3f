// SPDX-License-Identifier: BSD-3-Clause
// `lsv fuse`: LSV sensors, wheels and gyro to one pose.
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "lsv/output/output_file.h"
#include "tools/commands.h"
#include "tools/fuse_inputs.h"
#include "tools/fuse_outputs.h"
#include "tools/fuse_report.h"
#include "tools/fuse_run.h"
#include "tools/output_names.h"
#include "tools/rover_file.h"

namespace lsv::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFooter =
    "Columns are read by name: time_s,vx_m_s,vy_m_s for an LSV sensor, in its own axes (optional\n"
    "sigma_vx_m_s,sigma_vy_m_s,dt_s,status,motion; the CSV of lsv track is one), one --lsv per\n"
    "sensor in the order of the rover's [[lsv]]; time_s,left_rad_s,right_rad_s for the wheels; "
    "time_s,wz_rad_s\n"
    "for the IMU. All on one clock. The rover file holds geometry, mounts and noises\n"
    "(docs/formats.md). Writes pose.csv, pose.tum, pose.jsonl, events.csv, summary.json and\n"
    "report.html into DIR. Model and gates: docs/fusion.md.\n"
    "\n"
    "Example, without hardware:\n"
    "  lsv simulate rover sand_crossing -o drive\n"
    "  lsv fuse --lsv drive/lsv_1.csv --lsv drive/lsv_2.csv --wheels drive/wheels.csv \\\n"
    "      --rover drive/rover.toml -o out\n"
    "  lsv evaluate out/pose.csv drive/truth.csv\n"
    "Exit codes: 0 ok, 1 output not written, 2 usage, 3 input.";

struct FuseCommand {
  FuseInputs inputs;
  std::string rover;
  std::string output;
};

std::vector<std::string> input_files(const FuseCommand& command) {
  std::vector<std::string> out = command.inputs.lsv;
  for (const std::string& one : {command.inputs.wheels, command.inputs.imu}) {
    if (!one.empty()) out.push_back(one);
  }
  out.push_back(command.rover);
  return out;
}

/// What no file tells of is no part of the rover.
FusionConfig without_silent_sensors(FusionConfig config, const FuseInputs& inputs) {
  config.lsv.resize(inputs.lsv.size());
  if (inputs.wheels.empty()) config.wheels.reset();
  if (inputs.imu.empty()) config.gyro.reset();
  return config;
}

Result<void> prepare_folder(const FuseCommand& command) {
  std::vector<std::string> outputs;
  for (const char* const name : kFuseFiles)
    outputs.push_back((fs::path(command.output) / name).string());
  if (Result<void> ok = refuse_inputs(outputs, input_files(command)); !ok) return ok;
  std::error_code status;
  fs::create_directories(command.output, status);
  if (status) {
    return Error{ErrorCode::output_failed,
                 command.output + ": cannot be created: " + status.message()};
  }
  return {};
}

Result<void> fuse_files(const FuseCommand& command) {
  const Result<RoverFile> rover = read_rover(command.rover);
  if (!rover) return rover.error();
  const Result<FuseSamples> samples = read_samples(command.inputs, rover.value().config);
  if (!samples) return samples.error();
  const FusionConfig config = without_silent_sensors(rover.value().config, command.inputs);
  if (Result<void> ready = prepare_folder(command); !ready) return ready;
  for (const std::string& warning : mounting_warnings(config))
    std::fprintf(stderr, "lsv: warning: %s\n", warning.c_str());

  std::string head = "# lsv: " LSV_VERSION "\n";
  for (const std::string& file : input_files(command)) head += "# input: " + file + "\n";
  head +=
      "# axes: x, y of the plane, yaw counter-clockwise; velocities in body axes, x forward, y "
      "left\n";
  Result<FuseOutputs> outputs = FuseOutputs::open(command.output, head, config);
  if (!outputs) return outputs.error();
  FuseReport report(config);
  const Result<FusionCounters> counters =
      fuse(config, samples.value(), [&](const FuseRow& row) -> Result<void> {
        report.add(row);
        return outputs.value().write(row);
      });
  if (!counters) return counters.error();
  report.finish(counters.value(), samples.value().rows_left_out, outputs.value().events());
  const auto path = [&](const char* name) { return (fs::path(command.output) / name).string(); };
  if (Result<void> done = write_file(path("report.html"), report.html()); !done) return done;
  if (Result<void> done =
          write_file(path("summary.json"), report.json(input_files(command), rover.value().sha256));
      !done)
    return done;
  if (Result<void> done = outputs.value().commit(); !done) return done;
  std::fputs(report.text().c_str(), stderr);
  return {};
}

}  // namespace

void add_fuse_command(CLI::App& app, int& exit_code) {
  CLI::App* const sub =
      app.add_subcommand("fuse", "Fuse LSV tracks, wheel rates and a gyro to pose and wheel slip");
  const auto command = std::make_shared<FuseCommand>();
  FuseCommand& c = *command;
  sub->add_option("--lsv", c.inputs.lsv, "Velocities of an LSV sensor, CSV; once per sensor")
      ->allow_extra_args(false);
  sub->add_option("--wheels", c.inputs.wheels, "Rates of the wheels, CSV");
  sub->add_option("--imu", c.inputs.imu, "Yaw rates of a gyro, CSV");
  sub->add_option("--rover", c.rover, "Geometry, mounts and noises, TOML")->required();
  sub->add_option("-o,--output", c.output, "Folder for what is written")->required();
  sub->footer(kFooter);
  sub->callback([command, &exit_code] {
    const Result<void> done = fuse_files(*command);
    exit_code = done ? kExitOk : report_error(done.error());
  });
}

}  // namespace lsv::cli
