// SPDX-License-Identifier: BSD-3-Clause
#include "tools/tables_mcap.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <nlohmann/json.hpp>
#include <span>
#include <string_view>
#include <utility>

#include "lsv/mcap/byte_sink.h"
#include "lsv/mcap/chunk_memory.h"
#include "lsv/mcap/writer.h"

namespace lsv::cli {
namespace {

constexpr std::size_t kChunk_bytes = std::size_t{1} << 20;

std::vector<std::string> split(std::string_view text, char separator) {
  std::vector<std::string> out;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(separator, begin), text.size());
    out.emplace_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return out;
}

/// A number, a word, or null.
nlohmann::json value_of(const std::string& cell) {
  if (cell.empty()) return nullptr;
  char* end = nullptr;
  const double number = std::strtod(cell.c_str(), &end);
  if (end != cell.c_str() + cell.size()) return cell;
  return std::isfinite(number) ? nlohmann::json(number) : nlohmann::json(nullptr);
}

struct Row {
  std::int64_t time_ns = 0;
  std::size_t table = 0;
  nlohmann::json object;
};

/// Every column that never holds a word is a number, or null.
std::string json_schema(const std::vector<std::string>& columns, std::span<const Row> rows) {
  nlohmann::json properties;
  for (const std::string& column : columns) {
    const bool is_word = std::any_of(rows.begin(), rows.end(), [&](const Row& row) {
      return row.object.at(column).is_string();
    });
    properties[column] = {{"type", is_word ? "string" : "number"}};
  }
  return nlohmann::json{{"type", "object"}, {"properties", properties}}.dump();
}

mcap::ByteView bytes_of(const std::string& text) {
  return {reinterpret_cast<const std::byte*>(text.data()), text.size()};
}

}  // namespace

Result<void> write_tables_mcap(const std::string& path, const std::vector<TopicTable>& tables) {
  Result<std::unique_ptr<mcap::ByteSink>> sink = mcap::create_file(path);
  if (!sink) return sink.error();
  Result<mcap::Writer> writer =
      mcap::Writer::create(std::move(sink).value(), std::make_unique<mcap::HeapChunk>(kChunk_bytes),
                           {.profile = "", .compression = mcap::Compression::zstd});
  if (!writer) return writer.error();

  std::vector<Row> rows;
  std::vector<mcap::ChannelId> channels;
  for (const TopicTable& table : tables) {
    const std::size_t first = rows.size();
    std::vector<std::string> columns;
    for (const std::string& line : split(table.csv, '\n')) {
      if (line.empty() || line.front() == '#') continue;
      std::vector<std::string> cells = split(line, ',');
      if (columns.empty()) {
        columns = std::move(cells);
        continue;
      }
      Row row{.time_ns = std::llround(1e9 * std::strtod(cells.front().c_str(), nullptr)),
              .table = channels.size(),
              .object = nlohmann::json::object()};
      for (std::size_t i = 0; i < columns.size(); ++i) row.object[columns[i]] = value_of(cells[i]);
      rows.push_back(std::move(row));
    }
    const Result<mcap::ChannelId> added = writer.value().add_channel(
        {.topic = table.topic,
         .message_encoding = "json",
         .schema = {.name = table.topic.substr(1),
                    .encoding = "jsonschema",
                    .text = json_schema(columns, std::span(rows).subspan(first))}});
    if (!added) return added.error();
    channels.push_back(added.value());
  }

  std::stable_sort(rows.begin(), rows.end(),
                   [](const Row& a, const Row& b) { return a.time_ns < b.time_ns; });
  std::vector<std::uint32_t> sequences(tables.size(), 0);
  for (const Row& row : rows) {
    const std::string text = row.object.dump();
    if (Result<void> room = writer.value().make_room(1, text.size()); !room) return room;
    const mcap::MessageHead head{.channel = channels[row.table],
                                 .sequence = sequences[row.table]++,
                                 .log_time_ns = row.time_ns,
                                 .publish_time_ns = row.time_ns};
    if (Result<void> written = writer.value().write(head, bytes_of(text)); !written) return written;
  }
  return writer.value().finish();
}

}  // namespace lsv::cli
