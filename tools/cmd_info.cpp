// SPDX-License-Identifier: BSD-3-Clause
// lsv info: what the frames are, before they are measured.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>

#include "lsv/ingest/frame_source.h"
#include "lsv/mcap/tail.h"
#include "lsv/output/number_text.h"
#include "tools/camera_list.h"
#include "tools/commands.h"
#include "tools/recording_facts.h"
#include "tools/settings.h"
#include "tools/track_settings.h"

namespace lsv::cli {
namespace {

struct Levels {
  double mean_counts = 0.0;
  double sd_counts = 0.0;
  int min_counts = 0;
  int max_counts = 0;
  double saturated_share = 0.0;  // of the pixels, at full scale

  /// Speckle contrast; unknown for a black frame.
  double contrast_ratio() const {
    return mean_counts > 0.0 ? sd_counts / mean_counts : std::numeric_limits<double>::quiet_NaN();
  }
};

Levels levels_of(const FrameView& frame) {
  const int full_scale = full_scale_counts(frame.format.bit_depth);
  Levels levels{.min_counts = full_scale};
  double sum = 0.0;
  double sum_of_squares = 0.0;  // below 2^53 for every size that is let in
  std::int64_t saturated = 0;
  for (int y = 0; y < frame.height_px(); ++y) {
    for (int x = 0; x < frame.width_px(); ++x) {
      const int counts = frame.at(x, y);
      levels.min_counts = std::min(levels.min_counts, counts);
      levels.max_counts = std::max(levels.max_counts, counts);
      saturated += counts >= full_scale ? 1 : 0;
      sum += counts;
      sum_of_squares += static_cast<double>(counts) * counts;
    }
  }
  const double pixels = static_cast<double>(frame.width_px()) * frame.height_px();
  levels.mean_counts = sum / pixels;
  levels.sd_counts =
      std::sqrt(std::max(0.0, sum_of_squares / pixels - levels.mean_counts * levels.mean_counts));
  levels.saturated_share = static_cast<double>(saturated) / pixels;
  return levels;
}

std::string seconds_text(Stamp stamp) {
  std::string text;
  append_seconds(text, stamp.ns);
  return text;
}

void print_text(const SourceInfo& info, const Levels& levels) {
  const auto line = [](const char* name, const std::string& value) {
    std::printf("%-16s%s\n", name, value.c_str());
  };
  const auto number = [](double value, const char* format) {
    char text[64];
    std::snprintf(text, sizeof text, format, value);
    return std::string(text);
  };
  line("input", info.description);
  line("frame size", std::to_string(info.format.width_px) + " x " +
                         std::to_string(info.format.height_px) + " px");
  line("bit depth", std::to_string(info.format.bit_depth) + " bit");
  line("frames", info.frame_count ? std::to_string(*info.frame_count)
                                  : "not known before the end of the input");
  line("missing frames", std::to_string(info.missing_count));
  line("first stamp", info.first_stamp ? seconds_text(*info.first_stamp) + " s"
                                       : "not known: give --rate-hz or --timestamps");
  if (info.last_stamp) line("last stamp", seconds_text(*info.last_stamp) + " s");
  std::printf("\nfirst frame\n");
  line("mean level", number(levels.mean_counts, "%.2f counts"));
  line("darkest pixel", std::to_string(levels.min_counts) + " counts");
  line("brightest pixel", std::to_string(levels.max_counts) + " counts");
  line("saturated", number(100.0 * levels.saturated_share, "%.3f %% of the pixels"));
  line("contrast", std::isnan(levels.contrast_ratio())
                       ? "not defined: the frame is black"
                       : number(levels.contrast_ratio(), "%.3f (standard deviation / mean)"));
  for (const std::string& warning : info.warnings) std::printf("\nwarning: %s\n", warning.c_str());
}

template <typename Value>
nlohmann::ordered_json or_null(const std::optional<Value>& value) {
  return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json(nullptr);
}

nlohmann::ordered_json stamp_or_null(const std::optional<Stamp>& stamp) {
  return stamp ? nlohmann::ordered_json(stamp->ns) : nlohmann::ordered_json(nullptr);
}

void print_json(const SourceInfo& info, const Levels& levels,
                const std::optional<RecordingFacts>& recording) {
  const double contrast = levels.contrast_ratio();
  nlohmann::ordered_json json = {
      {"schema", "lsv.info/1"},
      {"input", info.description},
      {"width_px", info.format.width_px},
      {"height_px", info.format.height_px},
      {"bit_depth", info.format.bit_depth},
      {"frames", or_null(info.frame_count)},
      {"missing_frames", info.missing_count},
      {"first_stamp_ns", stamp_or_null(info.first_stamp)},
      {"last_stamp_ns", stamp_or_null(info.last_stamp)},
      {"first_frame",
       {{"mean_counts", levels.mean_counts},
        {"min_counts", levels.min_counts},
        {"max_counts", levels.max_counts},
        {"saturated_share", levels.saturated_share},
        {"contrast_ratio", std::isnan(contrast) ? nlohmann::ordered_json(nullptr)
                                                : nlohmann::ordered_json(contrast)}}},
      {"warnings", info.warnings}};
  if (recording) json["recording"] = to_json(*recording);
  // File names in warnings may hold bytes that are not UTF-8.
  std::puts(json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace).c_str());
}

/// Why a recording has no frame to look at.
Error without_frames(const std::string& path, const RecordingFacts& facts) {
  const mcap::FileCondition& found = facts.condition;
  std::string why = path + ": holds no frame";
  if (!found.finished && facts.has_tail) {
    why = path + ": was never closed, and holds no whole frame; lsv recover may find frames in " +
          mcap::tail_path(path);
  } else if (found.chunks == 0 && found.damages > 0) {
    why = found.first_damage;
  } else if (!found.finished) {
    why = path + ": was never closed, and holds no whole frame; there is no " +
          mcap::tail_path(path) + ", where lsv recover would look for some";
  }
  return {ErrorCode::bad_input, why};
}

struct InfoCommand {
  std::vector<std::string> frames;
  bool json = false;
  SourceOptions source;
  Settings settings;
};

Result<void> describe(InfoCommand& command) {
  if (Result<void> resolved =
          command.settings.resolve("", Settings::Variables::some_of_other_commands);
      !resolved)
    return resolved;
  if (command.frames.size() == 1 && command.frames.front() == "genicam:")
    return print_cameras(command.json);
  command.source.need_time = false;
  command.source.salvage = true;
  std::optional<RecordingFacts> recording;
  if (command.frames.size() == 1 && is_recording_path(command.frames.front())) {
    auto facts = recording_facts(command.frames.front(), command.source.max_pixels);
    if (!facts) return facts.error();
    if (facts.value().frames == 0) return without_frames(command.frames.front(), facts.value());
    recording = std::move(facts).value();
  }
  Result<std::unique_ptr<FrameSource>> source = open_frames(command.frames, command.source);
  if (!source) return source.error();
  Frame frame;
  const Result<bool> read = source.value()->next(frame);
  if (!read) return read.error();
  const Levels levels = levels_of(frame.view());
  SourceInfo info = source.value()->info();
  if (recording) {
    info.frame_count = recording->frames;
    info.last_stamp = recording->last_stamp;
    info.missing_count = recording->missing;
  }
  if (command.json) {
    print_json(info, levels, recording);
  } else {
    print_text(info, levels);
    if (recording) print_text(*recording);
  }
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0)
    return Error{ErrorCode::output_failed, "standard output could not be written"};
  return {};
}

}  // namespace

void add_info_command(CLI::App& app, int& exit_code) {
  CLI::App* const sub =
      app.add_subcommand("info", "Say what the frames are and check the first one");
  auto command = std::make_shared<InfoCommand>();
  sub->add_option("FRAMES", command->frames, kFramesHelp)->required();
  sub->add_flag("--json", command->json, "Print one JSON object");
  add_source_settings(*sub, command->settings, command->source);
  sub->footer(
      "Examples:\n"
      "  lsv info sample_frames/drive_png --rate-hz 1000\n"
      "  lsv info drive.mcap\n"
      "  lsv info genicam:            (the GenICam cameras that answer)");
  sub->callback([command, &exit_code] {
    const Result<void> described = describe(*command);
    exit_code = described ? kExitOk : report_error(described.error());
  });
}

}  // namespace lsv::cli
