// SPDX-License-Identifier: BSD-3-Clause
// A clean file out of one that was cut short or damaged, with what its tail holds.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>

#include "lsv/core/result.h"
#include "lsv/mcap/byte_sink.h"
#include "lsv/mcap/byte_source.h"
#include "lsv/mcap/reader.h"

namespace lsv::mcap {

struct Recovered {
  FileCondition file;  // as it was found
  std::uint64_t messages = 0;
  std::map<std::string, std::uint64_t> by_topic{};
  std::uint64_t tail_messages = 0;  // of these, out of the tail
  /// Chunks before the tail that the file lacks, as after a power cut, or has damaged.
  std::uint64_t chunks_before_tail = 0;
  bool has_tail = false;
  std::string tail_refused{};  // why a tail was not taken; empty when it was or there is none
  /// Never closed, and no tail tells what came after the last chunk.
  bool end_unknown = false;

  /// Something is known to be missing: a chunk torn at the end is not where the tail has it.
  bool lost_something() const {
    const std::uint64_t mended = file.torn_end && tail_messages > 0 ? 1 : 0;
    return file.damages > mended || chunks_before_tail > 0;
  }
};

/// `tail` may be null. bad_input when nothing of a recording is found.
Result<Recovered> recover(std::unique_ptr<ByteSource> file, std::unique_ptr<ByteSource> tail,
                          std::unique_ptr<ByteSink> to);

/// The tail beside a recording; null where there is none.
Result<std::unique_ptr<ByteSource>> open_tail(const std::string& recording_path);

}  // namespace lsv::mcap
