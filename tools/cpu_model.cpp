// SPDX-License-Identifier: BSD-3-Clause
#include "tools/cpu_model.h"

#include <fstream>
#include <thread>

namespace lsv::cli {

std::string cpu_model() {
  std::string name = "unknown";
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);) {
    const std::size_t colon = line.find(": ");
    if (!line.starts_with("model name") || colon == std::string::npos) continue;
    name = line.substr(colon + 2);
    break;
  }
  return name + ", " + std::to_string(std::thread::hardware_concurrency()) + " processors";
}

}  // namespace lsv::cli
