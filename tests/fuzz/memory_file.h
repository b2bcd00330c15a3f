// SPDX-License-Identifier: BSD-3-Clause
// Bytes as a file with a path, without touching a disk, so that the production path is fuzzed
// from opening on.
#pragma once

#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

namespace lsv::fuzz {

class MemoryFile {
 public:
  MemoryFile(const std::uint8_t* data, std::size_t size) : fd_(::memfd_create("fuzz", 0)) {
    if (fd_ < 0) give_up("memfd_create");
    if (::write(fd_, data, size) != static_cast<ssize_t>(size)) give_up("write to a memfd");
  }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  ~MemoryFile() { ::close(fd_); }

  std::string path() const { return "/proc/self/fd/" + std::to_string(fd_); }

 private:
  /// The machine has failed, not the code under test, and the log must say so.
  [[noreturn]] static void give_up(const char* call) {
    std::fprintf(stderr, "ERROR: no finding, %s failed: %s\n", call, std::strerror(errno));
    std::abort();
  }

  int fd_;
};

}  // namespace lsv::fuzz
