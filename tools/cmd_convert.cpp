// SPDX-License-Identifier: BSD-3-Clause
// lsv convert: a recording as an HDF5 file.
#include <cstdio>
#include <memory>
#include <utility>

#include "lsv/ingest/frame_source.h"
#include "lsv/ingest/recording.h"
#include "tools/commands.h"
#include "tools/hdf5_recording.h"
#include "tools/interrupt.h"
#include "tools/output_names.h"
#include "tools/progress.h"

namespace lsv::cli {
namespace {

struct ConvertCommand {
  std::string recording;
  std::string output;
  bool quiet = false;
};

Result<int> convert(const ConvertCommand& command) {
  if (Result<void> file = refuse_stdout(command.output, "an HDF5 file"); !file) return file.error();
  const std::string& path = command.recording;
  Result<RecordingReader> reader =
      RecordingReader::open(path, {.max_pixels = SourceOptions{}.max_pixels});
  if (!reader) return reader.error();
  RecordedFrame frame;
  Result<bool> more = reader.value().next(frame);
  if (!more) return more.error();
  if (!more.value()) return Error{ErrorCode::bad_input, path + ": holds no frame"};
  Result<Hdf5Recording> output =
      Hdf5Recording::create(command.output, frame, reader.value().notes());
  if (!output) return output.error();
  catch_interrupts();
  {
    Progress progress(std::nullopt, command.quiet);
    while (more.value()) {
      if (Result<void> added = output.value().add(frame); !added)
        return Error{added.error().code, path + ": " + added.error().message};
      progress.frame_done(false);
      if (interrupted()) break;
      more = reader.value().next(frame);
      if (!more) return more.error();
    }
  }
  if (interrupted()) {
    std::fputs("lsv: interrupted, nothing was written\n", stderr);
    return kExitInterrupted;
  }
  if (Result<void> finished = output.value().finish(); !finished) return finished.error();
  return kExitOk;
}

}  // namespace

void add_convert_command(CLI::App& app, int& exit_code) {
  auto command = std::make_shared<ConvertCommand>();
  CLI::App* const sub = app.add_subcommand("convert", "Write a recording as an HDF5 file");
  sub->add_option("RECORDING", command->recording, "The recording (.mcap)")->required();
  sub->add_option("OUTPUT", command->output, "The HDF5 file (.h5); must not exist")->required();
  sub->add_flag("-q,--quiet", command->quiet, "No progress on stderr");
  sub->footer(
      "Example:\n"
      "  lsv convert drive.mcap drive.h5\n"
      "Exit codes: 0 ok, 1 output not written, 2 usage, 3 input, 130 interrupted.");
  sub->callback([command, &exit_code] {
    const Result<int> converted = convert(*command);
    exit_code = converted ? converted.value() : report_error(converted.error());
  });
}

}  // namespace lsv::cli
