// SPDX-License-Identifier: BSD-3-Clause
// `lsv faults`: does the measurement stay honest when frames, clocks and machine fail?
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "lsv/output/output_file.h"
#include "tools/commands.h"
#include "tools/faults/campaign.h"
#include "tools/faults/report.h"
#include "tools/interrupt.h"

namespace lsv::cli {
namespace {

constexpr int kExitBroken = kExitLowQuality;

constexpr const char* kFooter =
    "Simulated frames with known truth are spoilt on purpose and streamed through the real "
    "pipeline\n"
    "on a virtual clock. Every fault must be told in time, nothing wrong may be called valid, and\n"
    "the books must balance. The same seeds give the same frames, faults and figures.\n"
    "\n"
    "Example:\n"
    "  lsv faults --only A1 --only T --seeds 20\n"
    "Exit codes: 0 every limit holds, 1 output not written, 2 usage, 4 a limit is broken, 130\n"
    "interrupted.";

struct FaultsOptions {
  std::vector<std::string> only;
  faults::CampaignOptions campaign;
  std::string output = "-";
  bool lists = false;
};

int run(const FaultsOptions& options) {
  const std::vector<faults::Scenario> scenarios = faults::chosen_scenarios(options.only);
  if (scenarios.empty()) {
    return report_error(
        {ErrorCode::invalid_argument, "no fault of that name; lsv faults --list names them"});
  }
  if (options.lists) {
    for (const faults::Scenario& scenario : scenarios)
      std::printf("%-14s %s\n", scenario.id.c_str(), scenario.fault.c_str());
    return kExitOk;
  }
  catch_interrupts();
  faults::Scenes scenes(options.campaign.side_px, options.campaign.exposures);
  std::vector<faults::Row> rows;
  bool holds = true;
  for (const faults::Scenario& scenario : scenarios) {
    const auto row = faults::run_scenario(scenario, scenes, options.campaign);
    if (!row) return report_error(row.error());
    if (interrupted()) return kExitInterrupted;
    holds = holds && row.value().broken_limits.empty();
    rows.push_back(row.value());
  }
  if (const Result<void> written = write_file(options.output, faults::table(rows)); !written)
    return report_error(written.error());
  return holds ? kExitOk : kExitBroken;
}

}  // namespace

void add_faults_command(CLI::App& app, int& exit_code) {
  CLI::App* const sub = app.add_subcommand(
      "faults", "Spoil frames, clocks and machine, and check what is made of it");
  const auto options = std::make_shared<FaultsOptions>();
  FaultsOptions& o = *options;
  sub->add_option("--only", o.only, "Faults whose id begins with this; may be given again");
  sub->add_option("--seeds", o.campaign.seeds, "Runs of each fault")
      ->check(CLI::Range(1, 100'000))
      ->capture_default_str();
  sub->add_option("--first-seed", o.campaign.first_seed, "Seed of the first run")
      ->capture_default_str();
  sub->add_option("--size", o.campaign.side_px, "Side of the frames, px")
      ->check(CLI::Range(64, 1024))
      ->capture_default_str();
  sub->add_option("--exposures", o.campaign.exposures, "Length of a run at 1 kHz")
      ->check(CLI::Range(400, 1'000'000))
      ->capture_default_str();
  sub->add_flag_callback(
      "--no-learn-fixed-pattern", [&o] { o.campaign.learn_fixed_pattern = false; },
      "Without learning the fixed pattern while driving");
  sub->add_option("-o,--output", o.output, "File of the table (Markdown); - is standard output")
      ->capture_default_str();
  sub->add_flag("--list", o.lists, "Name the faults and end");
  sub->footer(kFooter);
  sub->callback([options, &exit_code] { exit_code = run(*options); });
}

}  // namespace lsv::cli
