// SPDX-License-Identifier: BSD-3-Clause
// A folder that goes with the test, and whole files in and out of memory.
#pragma once

#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "lsv/mcap/bytes.h"

namespace lsv::test {

class Scratch {
 public:
  Scratch() {
    std::string name = (std::filesystem::temp_directory_path() / "lsv_mcap_XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) std::abort();
    folder_ = name;
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  ~Scratch() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  std::string file(const std::string& name) const { return (folder_ / name).string(); }

 private:
  std::filesystem::path folder_;
};

inline mcap::Bytes file_bytes(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  const mcap::ByteView view = mcap::bytes_of(text);
  return {view.begin(), view.end()};
}

inline void write_bytes(const std::string& path, mcap::ByteView bytes) {
  std::ofstream out(path, std::ios::binary);
  out << mcap::text_of(bytes);
}

}  // namespace lsv::test
