// SPDX-License-Identifier: BSD-3-Clause
// A disk in memory that can be full, stop in the middle of a write, or refuse to be cut.
#pragma once

#include <limits>
#include <memory>
#include <string>

#include "lsv/mcap/byte_sink.h"

namespace lsv::test {

/// Outlives the sink that writes to it.
struct MemoryDisk {
  mcap::Bytes bytes;
  std::size_t capacity_bytes = std::numeric_limits<std::size_t>::max();
  bool can_cut = true;
  int failures = 0;
  int syncs = 0;
};

class MemorySink : public mcap::ByteSink {
 public:
  explicit MemorySink(MemoryDisk& disk) : disk_(disk) {}

  const std::string& name() const override { return name_; }

  /// Like a real disk, keeps what still fits.
  Result<void> append(mcap::ByteView bytes) override {
    const std::size_t free_bytes =
        disk_.capacity_bytes - std::min(disk_.capacity_bytes, disk_.bytes.size());
    const mcap::ByteView kept = bytes.first(std::min(free_bytes, bytes.size()));
    disk_.bytes.insert(disk_.bytes.end(), kept.begin(), kept.end());
    if (kept.size() == bytes.size()) return {};
    ++disk_.failures;
    return Error{ErrorCode::output_failed, "the disk is full"};
  }
  Result<void> truncate(std::int64_t size_bytes) override {
    if (!disk_.can_cut) return Error{ErrorCode::output_failed, "the disk cannot cut"};
    disk_.bytes.resize(static_cast<std::size_t>(size_bytes));
    return {};
  }
  Result<void> sync() override {
    ++disk_.syncs;
    return {};
  }

 private:
  MemoryDisk& disk_;
  std::string name_ = "memory";
};

}  // namespace lsv::test
