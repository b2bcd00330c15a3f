// SPDX-License-Identifier: BSD-3-Clause
// A tail of a recording, and records as a tail hands them to the reader of one that was never
// closed: they are taken as a whole or not at all.
#include "lsv/mcap/tail.h"
#include "tests/fuzz/frame_checks.h"
#include "tests/lsv/mcap/small_recording.h"

namespace {

using namespace lsv;
using fuzz::require;

const mcap::Bytes& unclosed_file() {
  static const mcap::Bytes bytes = [] {
    test::MemoryDisk disk;
    const mcap::Writer writer = test::write_small(disk, 12, {}, [](const Error&) { std::abort(); });
    return disk.bytes;
  }();
  return bytes;
}

void add_to_file(mcap::Bytes records) {
  auto reader =
      mcap::Reader::open(mcap::memory_source("rec.mcap", unclosed_file()), mcap::Damage::skip);
  while (reader.value().next().value() != mcap::Item::end) {
  }
  if (!reader.value().add_chunk(std::move(records))) return;
  for (;;) {
    const auto item = reader.value().next();
    require(item.ok(), "records that were let in can be read");
    if (item.value() == mcap::Item::end) return;
    require(reader.value().message().channel != nullptr, "a message has a channel");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto* const bytes = reinterpret_cast<const std::byte*>(data);
  const mcap::Bytes input(bytes, bytes + size);
  const auto source = mcap::memory_source("rec.mcap.tail", input);
  auto tail = mcap::read_tail(*source);
  require(tail.ok(), "a tail in memory can be read");
  if (tail.value()) add_to_file(std::move(tail.value()->records));
  add_to_file(input);
  return 0;
}
