// SPDX-License-Identifier: BSD-3-Clause
// lsv recover: a clean recording out of one that was cut short or damaged.
#include <cstdio>
#include <filesystem>
#include <memory>
#include <utility>

#include "lsv/mcap/messages.h"
#include "lsv/mcap/recover.h"
#include "lsv/mcap/tail.h"
#include "tools/commands.h"
#include "tools/output_names.h"

namespace lsv::cli {
namespace {

struct RecoverCommand {
  std::string recording;
  std::string output;
};

Result<mcap::Recovered> recover(const RecoverCommand& command) {
  if (Result<void> named = refuse_stdout(command.output, "a recording"); !named)
    return named.error();
  auto file = mcap::open_file(command.recording);
  if (!file) return file.error();
  auto tail = mcap::open_tail(command.recording);
  if (!tail) return tail.error();
  auto sink = mcap::create_file(command.output);
  if (!sink) return sink.error();
  auto recovered =
      mcap::recover(std::move(file).value(), std::move(tail).value(), std::move(sink).value());
  std::error_code ignored;
  if (!recovered) std::filesystem::remove(command.output, ignored);
  return recovered;
}

void print(const RecoverCommand& command, const mcap::Recovered& found) {
  const auto number = [](std::uint64_t value) { return std::to_string(value); };
  const auto line = [](const std::string& text) { std::printf("%s\n", text.c_str()); };
  const auto frames = found.by_topic.find(std::string(mcap::kImageTopic));
  line(command.output + ": " + number(found.messages) + " messages, " +
       number(frames == found.by_topic.end() ? 0 : frames->second) + " of them frames");
  if (found.file.finished)
    line("the recording was closed well");
  else
    line("the recording was never closed, or its end is lost");
  if (found.tail_messages > 0)
    line(number(found.tail_messages) + " messages come out of " +
         mcap::tail_path(command.recording));
  if (!found.tail_refused.empty())
    line(mcap::tail_path(command.recording) + " was not used: " + found.tail_refused);
  if (found.file.damages > 0)
    line(number(found.file.damages) + " damaged places, first: " + found.file.first_damage);
  if (found.chunks_before_tail > 0) line(number(found.chunks_before_tail) + " chunks are lost");
  if (!found.file.finished && !found.has_tail)
    line("there is no " + mcap::tail_path(command.recording) +
         ", which would hold its last frames");
  if (found.lost_something())
    line("something is lost; frames that are missing show as holes");
  else
    line(found.end_unknown ? "frames at its end may be lost" : "nothing is known to be lost");
}

int run(const RecoverCommand& command) {
  const Result<mcap::Recovered> recovered = recover(command);
  if (!recovered) return report_error(recovered.error());
  print(command, recovered.value());
  if (std::fflush(stdout) != 0) {
    return report_error({ErrorCode::output_failed, "standard output could not be written"});
  }
  const bool whole = !recovered.value().lost_something() && !recovered.value().end_unknown;
  return whole ? kExitOk : kExitLowQuality;
}

}  // namespace

void add_recover_command(CLI::App& app, int& exit_code) {
  auto command = std::make_shared<RecoverCommand>();
  CLI::App* const sub = app.add_subcommand(
      "recover", "Write a clean recording out of one that was cut short or damaged");
  sub->add_option("RECORDING", command->recording, "The recording (.mcap); its .tail is used too")
      ->required();
  sub->add_option("-o,--output", command->output, "The new recording; must not exist")->required();
  sub->footer(
      "Example:\n"
      "  lsv recover drive.mcap -o drive_recovered.mcap\n"
      "Exit codes: 0 nothing is known to be lost, 1 output not written, 2 usage, 3 input, 4 saved, "
      "but something is lost or may be.");
  sub->callback([command, &exit_code] { exit_code = run(*command); });
}

}  // namespace lsv::cli
