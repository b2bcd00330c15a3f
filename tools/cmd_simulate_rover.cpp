// SPDX-License-Identifier: BSD-3-Clause
// `lsv simulate rover`: a rover on soils of different grip as its sensors report it, with the truth
// beside it.
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <numbers>
#include <string>

#include "lsv/core/shift.h"
#include "lsv/ingest/option_text.h"
#include "lsv/output/number_text.h"
#include "lsv/output/output_file.h"
#include "lsv/output/tum_pose.h"
#include "tools/commands.h"
#include "tools/html_page.h"
#include "tools/part_folder.h"
#include "tools/rover_scenario.h"
#include "tools/sensor_axes.h"
#include "tools/tables_mcap.h"
#include "tools/xy_plot.h"

namespace lsv::cli {
namespace {

constexpr const char* kFooter =
    "Writes truth.csv and truth.tum (pose of the axle's middle, velocity in body axes, efficiency "
    "of\n"
    "the wheels), wheels.csv, lsv_1.csv ... and imu.csv as far as the rover has them, the "
    "same\n"
    "in one rover.mcap (JSON, for Foxglove and PlotJuggler), rover.toml for lsv fuse, "
    "scenario.toml\n"
    "and rover.html. Nothing is overwritten. A scenario of your own is a TOML file "
    "(docs/formats.md).\n"
    "\n"
    "Example:\n"
    "  lsv simulate rover sand_crossing --seed 3 -o drive\n"
    "  lsv fuse --lsv drive/lsv_1.csv --lsv drive/lsv_2.csv --wheels drive/wheels.csv \\\n"
    "      --rover drive/rover.toml -o out\n"
    "Exit codes: 0 ok, 1 output not written, 2 usage, 3 input.";

struct SimulateRover {
  std::string scenario;
  std::string output;
  std::uint64_t seed = 1;
  bool list = false;
};

constexpr int kDecimals = 9;

void cell(std::string& out, double value) {
  out += ',';
  append_fixed(out, value, kDecimals);
}

std::string truth_csv(const std::string& head, const std::vector<sim::RoverState>& states) {
  std::string out = head +
                    "time_s,x_m,y_m,yaw_rad,vx_m_s,vy_m_s,wz_rad_s,left_efficiency_ratio,right_"
                    "efficiency_ratio\n";
  for (const sim::RoverState& s : states) {
    append_seconds(out, s.time_ns);
    for (const double value : {s.x_m, s.y_m, s.yaw_rad, s.vx_m_s, s.vy_m_s, s.wz_rad_s,
                               s.left_efficiency_ratio, s.right_efficiency_ratio})
      cell(out, value);
    out += '\n';
  }
  return out;
}

std::string truth_tum(const std::vector<sim::RoverState>& states) {
  std::string out;
  for (const sim::RoverState& s : states)
    append_tum_pose(out, {s.time_ns}, s.x_m, s.y_m, s.yaw_rad);
  return out;
}

std::string wheels_csv(const std::string& head, const std::vector<sim::EncoderReading>& readings) {
  std::string out = head + "time_s,left_rad_s,right_rad_s\n";
  for (const sim::EncoderReading& r : readings) {
    append_seconds(out, r.time_ns);
    cell(out, r.left_rad_s);
    cell(out, r.right_rad_s);
    out += '\n';
  }
  return out;
}

std::string lsv_csv(const std::string& head, const std::vector<sim::RoverLsvReading>& readings,
                    double noise_m_s) {
  std::string out = head + "time_s,vx_m_s,vy_m_s,sigma_vx_m_s,sigma_vy_m_s,status\n";
  for (const sim::RoverLsvReading& r : readings) {
    append_seconds(out, r.time_ns);
    const double known = r.is_lost ? kUnknown : 1.0;
    for (const double value : {r.vx_m_s, r.vy_m_s, noise_m_s, noise_m_s}) cell(out, known * value);
    out += r.is_lost ? ",dark\n" : ",ok\n";
  }
  return out;
}

std::string imu_csv(const std::string& head, const std::vector<sim::ImuReading>& readings) {
  std::string out = head + "time_s,wz_rad_s,ax_m_s2,ay_m_s2\n";
  for (const sim::ImuReading& r : readings) {
    append_seconds(out, r.time_ns);
    for (const double value : {r.wz_rad_s, r.ax_m_s2, r.ay_m_s2}) cell(out, value);
    out += '\n';
  }
  return out;
}

/// The encoders' own idea of the way: they know of no slip.
std::vector<Point> believed_path(const RoverScenario& scenario,
                                 const std::vector<sim::EncoderReading>& readings) {
  double x_m = scenario.plan.start_x_m, y_m = scenario.plan.start_y_m;
  double yaw_rad = scenario.plan.start_yaw_rad;
  std::vector<Point> out;
  for (std::size_t k = 0; k < readings.size(); ++k) {
    out.push_back({x_m, y_m});
    if (k + 1 == readings.size()) break;
    const double dt_s = static_cast<double>(readings[k + 1].time_ns - readings[k].time_ns) * 1e-9;
    const double left = scenario.plan.radius_m * readings[k].left_rad_s;
    const double right = scenario.plan.radius_m * readings[k].right_rad_s;
    const double turn_rad = dt_s * (right - left) / scenario.plan.track_m;
    x_m += dt_s * 0.5 * (left + right) * std::cos(yaw_rad + 0.5 * turn_rad);
    y_m += dt_s * 0.5 * (left + right) * std::sin(yaw_rad + 0.5 * turn_rad);
    yaw_rad += turn_rad;
  }
  return out;
}

struct Readings {
  std::vector<sim::RoverState> truth;
  std::vector<sim::EncoderReading> encoders;
  std::vector<std::vector<sim::RoverLsvReading>> lsv;
};

std::string page(const std::string& name, const RoverScenario& scenario, const Readings& readings) {
  constexpr std::string_view kBlue = "#2f80ed", kRed = "#d9542b", kGreen = "#27a06d",
                             kSand = "#d9a441";
  constexpr std::string_view kColours[] = {kGreen, "#9b59b6", "#b8860b", "#159d9d"};
  const double half_m = 0.5 * scenario.plan.track_m;
  XyPlot paths{.title = "paths of the axle and of both wheels",
               .x_name = "x, m",
               .y_name = "y, m",
               .series = {},
               .patches = {},
               .has_equal_axes = true};
  XySeries axle{"truth", kBlue, {}}, left{"left wheel", kGreen, {}},
      right{"right wheel", "#9b59b6", {}};
  XySeries speed{"ground", kBlue, {}}, left_grip{"left", kGreen, {}},
      right_grip{"right", "#9b59b6", {}};
  for (const sim::RoverState& s : readings.truth) {
    const double c = std::cos(s.yaw_rad), t = std::sin(s.yaw_rad);
    const double time_s = static_cast<double>(s.time_ns) * 1e-9;
    axle.points.push_back({s.x_m, s.y_m});
    left.points.push_back({s.x_m - half_m * t, s.y_m + half_m * c});
    right.points.push_back({s.x_m + half_m * t, s.y_m - half_m * c});
    speed.points.push_back({time_s, s.vx_m_s});
    left_grip.points.push_back({time_s, s.left_efficiency_ratio});
    right_grip.points.push_back({time_s, s.right_efficiency_ratio});
  }
  for (const sim::SoilPatch& patch : scenario.plan.patches) {
    paths.patches.push_back({patch.left_m, patch.right_m, patch.bottom_m, patch.top_m, kSand,
                             formatted("efficiency %g", patch.efficiency_ratio)});
  }
  paths.series = {
      axle,
      left,
      right,
      {"encoders alone", kRed, believed_path(scenario, readings.encoders), XyMark::dashed}};
  XyPlot speeds{
      .title = "forward speed", .x_name = "time, s", .y_name = "m/s", .series = {}, .patches = {}};
  speeds.includes_zero_y = true;
  XySeries rims{"encoders", kRed, {}, XyMark::dots};
  for (const sim::EncoderReading& r : readings.encoders)
    rims.points.push_back({static_cast<double>(r.time_ns) * 1e-9,
                           0.5 * scenario.plan.radius_m * (r.left_rad_s + r.right_rad_s)});
  speeds.series.push_back(rims);
  for (std::size_t i = 0; i < readings.lsv.size(); ++i) {
    XySeries sensor{scenario.lsv[i].name, kColours[i % std::size(kColours)], {}, XyMark::dots};
    const double yaw_rad = scenario.lsv[i].config.place.yaw_rad;
    for (const sim::RoverLsvReading& r : readings.lsv[i]) {
      const double known = r.is_lost ? kUnknown : 1.0;
      sensor.points.push_back({static_cast<double>(r.time_ns) * 1e-9,
                               known * forward_m_s(r.vx_m_s, r.vy_m_s, yaw_rad)});
    }
    speeds.series.push_back(sensor);
  }
  speeds.series.push_back(speed);
  XyPlot grips{.title = "efficiency of the wheels",
               .x_name = "time, s",
               .y_name = "ground speed / rim speed",
               .series = {left_grip, right_grip},
               .patches = {}};
  grips.includes_zero_y = true;
  const sim::RoverState& end = readings.truth.back();
  std::string body = "<h1>Simulated rover: " + escaped(name) + "</h1>\n<p>" +
                     formatted("Ends after %.2f s at x %.6f m, y %.6f m, heading %.6f deg.",
                               static_cast<double>(end.time_ns) * 1e-9, end.x_m, end.y_m,
                               end.yaw_rad * 180.0 / std::numbers::pi) +
                     "</p>\n<div class=\"plots\">\n";
  body += "<figure>" + draw(paths, 620, 560) + "</figure>\n";
  body += "<figure>" + draw(speeds, 620, 320) + "</figure>\n";
  body += "<figure>" + draw(grips, 620, 320) + "</figure>\n</div>\n<h2>Scenario</h2>\n<pre>" +
          escaped(scenario.text) + "</pre>\n";
  return html_page("lsv simulate rover", body);
}

Result<void> simulate(const SimulateRover& command) {
  Result<RoverScenario> loaded = load_scenario(command.scenario);
  if (!loaded) return loaded.error();
  RoverScenario& scenario = loaded.value();
  scenario.plan.seed = command.seed;
  if (command.output.empty())
    return Error{ErrorCode::invalid_argument, "-o is missing: name the folder to write"};
  Result<PartFolder> folder = PartFolder::make(command.output);
  if (!folder) return folder.error();

  Readings readings{sim::drive_rover(scenario.plan), {}, {}};
  readings.encoders = sim::read_encoders(readings.truth, scenario.encoders, command.seed);
  const std::string head = "# command: lsv simulate rover " + command.scenario + " --seed " +
                           std::to_string(command.seed) + "\n";
  const auto write = [&](const std::string& name, const std::string& text) {
    return write_file(folder.value().file(name), text);
  };
  std::vector<std::pair<std::string, std::string>> files = {
      {"truth.csv", truth_csv(head, readings.truth)},
      {"truth.tum", truth_tum(readings.truth)},
      {"wheels.csv", wheels_csv(head, readings.encoders)},
      {"rover.toml", rover_toml(scenario)},
      {"scenario.toml", scenario.text}};
  for (std::size_t i = 0; i < scenario.lsv.size(); ++i) {
    const ScenarioSensor& sensor = scenario.lsv[i];
    readings.lsv.push_back(
        sim::read_lsv(readings.truth, sensor.config, command.seed, static_cast<int>(i)));
    files.emplace_back("lsv_" + std::to_string(i + 1) + ".csv",
                       lsv_csv(head, readings.lsv.back(), sensor.config.noise_m_s));
  }
  if (scenario.imu) {
    files.emplace_back("imu.csv", imu_csv(head, sim::read_imu(readings.truth, scenario.imu->config,
                                                              command.seed)));
  }
  files.emplace_back("rover.html", page(command.scenario, scenario, readings));
  std::vector<TopicTable> topics;
  for (const auto& [name, text] : files) {
    if (Result<void> done = write(name, text); !done) return done;
    if (name.ends_with(".csv")) topics.push_back({"/" + name.substr(0, name.size() - 4), text});
  }
  if (Result<void> done = write_tables_mcap(folder.value().file("rover.mcap"), topics); !done)
    return done;
  if (Result<void> done = folder.value().commit(); !done) return done;
  std::fprintf(stderr,
               "%s: %zu poses in %.6g s, %zu LSV sensors, wheels%s; rover.html shows them\n",
               command.output.c_str(), readings.truth.size(),
               static_cast<double>(readings.truth.back().time_ns) * 1e-9, scenario.lsv.size(),
               scenario.imu ? " and a gyro" : "");
  return {};
}

}  // namespace

void add_simulate_rover(CLI::App& simulate_app, int& exit_code) {
  CLI::App* const sub = simulate_app.add_subcommand(
      "rover", "Write what the sensors of a rover say on soils of different grip");
  const auto command = std::make_shared<SimulateRover>();
  SimulateRover& c = *command;
  sub->add_option("SCENARIO", c.scenario, "Name of a scenario, or a TOML file");
  sub->add_option("-o,--output", c.output, "Folder to write");
  sub->add_option("--seed", c.seed, "Seed of all noise, 0 or more")
      ->check([](const std::string& text) {  // CLI11 takes what is out of range for another number
        return whole_number<std::uint64_t>(text) ? "" : "must be a whole number, 0 to 2^64 - 1";
      })
      ->capture_default_str();
  sub->add_flag("--list", c.list, "Name the scenarios and end");
  sub->footer(kFooter);
  sub->callback([command, &exit_code] {
    if (command->list) {
      for (const ScenarioName& one : scenario_names())
        std::printf("%-16s %s\n", std::string(one.name).c_str(), std::string(one.sentence).c_str());
      exit_code = std::fflush(stdout) == 0 ? kExitOk : kExitOutputFailed;
      return;
    }
    const Result<void> done =
        command->scenario.empty()
            ? Result<void>(Error{ErrorCode::invalid_argument, "name a scenario; --list shows them"})
            : simulate(*command);
    exit_code = done ? kExitOk : report_error(done.error());
  });
}

}  // namespace lsv::cli
