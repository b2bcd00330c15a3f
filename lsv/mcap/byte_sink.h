// SPDX-License-Identifier: BSD-3-Clause
// Where the bytes of a recording go. Every answer of the system is checked.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "lsv/core/result.h"
#include "lsv/mcap/bytes.h"

namespace lsv::mcap {

/// Grows at its end. Errors: output_failed, naming the file.
class ByteSink {
 public:
  virtual ~ByteSink() = default;

  virtual const std::string& name() const = 0;
  /// All of `bytes`, or an error after which any part of them may be there: truncate() then.
  virtual Result<void> append(ByteView bytes) = 0;
  /// Cuts back to the first `size_bytes`; the next append() goes there.
  virtual Result<void> truncate(std::int64_t size_bytes) = 0;
  /// What was appended outlives a power cut.
  virtual Result<void> sync() = 0;
};

/// A new file; one that exists is never overwritten.
Result<std::unique_ptr<ByteSink>> create_file(const std::string& path);

}  // namespace lsv::mcap
