// SPDX-License-Identifier: BSD-3-Clause
// A recording: read strictly it ends with an error that names it or gives what it gives when read
// leniently, and that never fails.
#include "lsv/mcap/reader.h"
#include "tests/fuzz/frame_checks.h"

namespace {

using lsv::fuzz::require;

struct Outcome {
  bool failed = false;
  std::uint64_t messages = 0;
  std::uint64_t bytes = 0;
};

Outcome read(const std::uint8_t* data, std::size_t size, lsv::mcap::Damage damage) {
  const auto* const bytes = reinterpret_cast<const std::byte*>(data);
  Outcome outcome;
  const auto fail = [&outcome](const lsv::Error& error) {
    require(error.message.find("fuzz.mcap") != std::string::npos, "an error names the file");
    outcome.failed = true;
    return outcome;
  };
  auto reader =
      lsv::mcap::Reader::open(lsv::mcap::memory_source("fuzz.mcap", {bytes, bytes + size}), damage);
  if (!reader) return fail(reader.error());
  for (;;) {
    const auto item = reader.value().next();
    if (!item) return fail(item.error());
    if (item.value() == lsv::mcap::Item::end) return outcome;
    if (item.value() != lsv::mcap::Item::message) continue;
    ++outcome.messages;
    for (const std::byte each : reader.value().message().payload)
      outcome.bytes += static_cast<std::uint64_t>(each);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const Outcome strict = read(data, size, lsv::mcap::Damage::refuse);
  const Outcome lenient = read(data, size, lsv::mcap::Damage::skip);
  require(!lenient.failed, "salvaging never fails");
  require(strict.failed || strict.messages >= lenient.messages,
          "salvaging finds nothing that a sound file does not have");
  return 0;
}
