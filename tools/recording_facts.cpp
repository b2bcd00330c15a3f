// SPDX-License-Identifier: BSD-3-Clause
#include "tools/recording_facts.h"

#include <cstdio>
#include <filesystem>

#include "lsv/mcap/tail.h"
#include "lsv/output/number_text.h"

namespace lsv::cli {
namespace {

void line(const char* name, const std::string& value) {
  std::printf("%-16s%s\n", name, value.c_str());
}

const char* word(mcap::Severity severity) {
  if (severity == mcap::Severity::error) return "error";
  return severity == mcap::Severity::warning ? "warning" : "info";
}

std::string condition_text(const RecordingFacts& facts) {
  std::string text = facts.condition.finished ? "closed well" : "never closed, or its end is lost";
  if (facts.condition.damages > 0) text += "; " + facts.condition.first_damage;
  if (!facts.condition.finished || facts.condition.damages > 0)
    text += "; lsv recover writes a clean file";
  return text;
}

}  // namespace

Result<RecordingFacts> recording_facts(const std::string& path, std::int64_t max_pixels) {
  Result<RecordingReader> reader =
      RecordingReader::open(path, {.damage = mcap::Damage::skip, .max_pixels = max_pixels});
  if (!reader) return reader.error();
  RecordingFacts facts;
  RecordedFrame frame;
  for (;;) {
    const Result<bool> more = reader.value().next(frame);
    if (!more) return more.error();
    if (!more.value()) break;
    ++facts.frames;
    if (!facts.first_stamp) facts.first_stamp = frame.frame.stamp;
    facts.last_stamp = frame.frame.stamp;
    facts.missing += frame.note.missing_before;
    facts.dropped += frame.note.dropped_before;
    facts.rejected += frame.note.rejected_before;
  }
  facts.notes = reader.value().notes();
  facts.condition = reader.value().condition();
  std::error_code unknown;
  facts.has_tail = std::filesystem::exists(mcap::tail_path(path), unknown);
  return facts;
}

void print_text(const RecordingFacts& facts) {
  const RecordingNotes& notes = facts.notes;
  std::printf("\nrecording\n");
  line("condition", condition_text(facts));
  if (facts.has_tail) line("tail", "there is one; lsv recover adds it");
  if (!notes.program.empty()) line("written by", notes.program);
  if (!notes.source.empty()) line("source", notes.source);
  if (facts.first_stamp) {
    std::string duration;
    append_seconds(duration, facts.last_stamp->ns - facts.first_stamp->ns);
    line("duration", duration + " s");
  }
  line("chunks", std::to_string(facts.condition.chunks));
  line("lost", std::to_string(facts.missing) + " never arrived, " + std::to_string(facts.dropped) +
                   " dropped by the queue, " + std::to_string(facts.rejected) + " rejected, " +
                   std::to_string(notes.frames_dropped) + " measured but not recorded");
  for (const auto& [topic, told] : notes.topics)
    std::printf("  %-22s%10lld  %s\n", topic.c_str(), static_cast<long long>(told.messages),
                told.type.c_str());
  if (notes.event_count > 0) {
    std::printf("\n%lld events", static_cast<long long>(notes.event_count));
    if (notes.event_count > static_cast<std::int64_t>(notes.events.size()))
      std::printf(", the last %zu of them", notes.events.size());
    std::printf("\n");
  }
  for (const mcap::Event& event : notes.events)
    std::printf("%s %s: %s\n", word(event.severity), event.name.c_str(), event.text.c_str());
}

nlohmann::ordered_json to_json(const RecordingFacts& facts) {
  nlohmann::ordered_json topics = nlohmann::ordered_json::object();
  for (const auto& [topic, told] : facts.notes.topics)
    topics[topic] = {{"type", told.type}, {"messages", told.messages}};
  nlohmann::ordered_json events = nlohmann::ordered_json::array();
  for (const mcap::Event& event : facts.notes.events)
    events.push_back({{"stamp_ns", event.stamp_ns},
                      {"severity", word(event.severity)},
                      {"name", event.name},
                      {"text", event.text}});
  return {{"closed", facts.condition.finished},
          {"damages", facts.condition.damages},
          {"first_damage", facts.condition.first_damage},
          {"tail", facts.has_tail},
          {"program", facts.notes.program},
          {"source", facts.notes.source},
          {"chunks", facts.condition.chunks},
          {"missing", facts.missing},
          {"dropped", facts.dropped},
          {"rejected", facts.rejected},
          {"not_recorded", facts.notes.frames_dropped},
          {"topics", topics},
          {"event_count", facts.notes.event_count},
          {"events", events}};
}

}  // namespace lsv::cli
