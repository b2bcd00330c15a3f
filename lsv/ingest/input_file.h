// SPDX-License-Identifier: BSD-3-Clause
// Opening and reading input files with a bound: only regular files, never more bytes than asked
// for, no wait on a FIFO or a device. Errors name the file and say what it is instead.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "lsv/core/result.h"

namespace lsv {

/// Owner of a POSIX file descriptor.
class FileHandle {
 public:
  FileHandle() = default;
  explicit FileHandle(int fd) : fd_(fd) {}
  FileHandle(FileHandle&& other) noexcept : fd_(other.release()) {}
  FileHandle& operator=(FileHandle&& other) noexcept;
  ~FileHandle() { close(); }

  int fd() const { return fd_; }

 private:
  int release();
  void close();
  int fd_ = -1;
};

struct InputFile {
  FileHandle handle;
  std::int64_t size_bytes = 0;
};

Result<InputFile> open_regular_file(const std::string& path);

/// Reads until `into` is full or the input ends; returns the bytes read. Retries when a signal
/// interrupts. `name` is used in errors.
Result<std::size_t> read_fully(int fd, std::span<std::uint8_t> into, const std::string& name);

/// The whole file into `into` (memory is reused); a file above `max_bytes` is refused unread.
Result<void> read_regular_file(const std::string& path, std::int64_t max_bytes,
                               std::vector<std::uint8_t>& into);

}  // namespace lsv
