// SPDX-License-Identifier: BSD-3-Clause
#include "bench/resident_memory.h"

#include <fcntl.h>
#include <unistd.h>

#include <cstdio>

namespace lsv::bench {

std::int64_t resident_bytes() {
  const int file = ::open("/proc/self/statm", O_RDONLY | O_CLOEXEC);
  if (file < 0) return -1;
  char text[128] = {};
  const ssize_t size = ::read(file, text, sizeof text - 1);
  ::close(file);
  long total = 0;
  long resident = 0;
  if (size <= 0 || std::sscanf(text, "%ld %ld", &total, &resident) != 2) return -1;
  return resident * ::sysconf(_SC_PAGESIZE);
}

double slope_bytes_per_h(const std::vector<std::int64_t>& per_second_bytes) {
  const auto n = static_cast<double>(per_second_bytes.size());
  if (per_second_bytes.size() < 2) return 0.0;
  const double middle_s = 0.5 * (n - 1.0);
  double product = 0.0;
  double square = 0.0;
  for (std::size_t i = 0; i < per_second_bytes.size(); ++i) {
    const double from_middle_s = static_cast<double>(i) - middle_s;
    product += from_middle_s * static_cast<double>(per_second_bytes[i]);
    square += from_middle_s * from_middle_s;
  }
  return 3600.0 * product / square;
}

}  // namespace lsv::bench
