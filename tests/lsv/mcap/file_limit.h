// SPDX-License-Identifier: BSD-3-Clause
// A full disk that needs no disk.
#pragma once

#include <sys/resource.h>

#include <csignal>

namespace lsv::test {

/// While it lives, files of this process and of those that it starts may not grow beyond a size.
class FileLimit {
 public:
  explicit FileLimit(rlim_t size_bytes) : before_signal_(std::signal(SIGXFSZ, SIG_IGN)) {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{.rlim_cur = size_bytes, .rlim_max = before_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  FileLimit(const FileLimit&) = delete;
  FileLimit& operator=(const FileLimit&) = delete;
  ~FileLimit() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, before_signal_);
  }

 private:
  void (*before_signal_)(int);
  rlimit before_{};
};

}  // namespace lsv::test
