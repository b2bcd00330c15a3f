// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/stream/latency_histogram.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "lsv/core/stamp.h"

namespace lsv {
namespace {
constexpr int kBitsOfFirstBins = 7;  // of the numbers from 64 to 127
}  // namespace

std::size_t LatencyHistogram::bin(std::uint64_t duration_ns) {
  if (duration_ns < kBinsPerOctave) return duration_ns;
  const int octave = static_cast<int>(std::bit_width(duration_ns)) - kBitsOfFirstBins;
  const std::uint64_t within = (duration_ns >> octave) - kBinsPerOctave;
  return std::min(kBins - 1, static_cast<std::size_t>(kBinsPerOctave * (octave + 1)) + within);
}

double LatencyHistogram::centre_s(std::size_t bin) {
  if (bin < kBinsPerOctave) return static_cast<double>(bin) / static_cast<double>(kNsPerS);
  const int octave = static_cast<int>(bin / kBinsPerOctave) - 1;
  const auto within = static_cast<double>(bin % kBinsPerOctave);
  return std::ldexp(kBinsPerOctave + within + 0.5, octave) / static_cast<double>(kNsPerS);
}

void LatencyHistogram::add(std::int64_t duration_ns) {
  const std::int64_t taken_ns = std::max(std::int64_t{0}, duration_ns);
  counts_[bin(static_cast<std::uint64_t>(taken_ns))].fetch_add(1, std::memory_order_relaxed);
  if (taken_ns > max_ns_.load(std::memory_order_relaxed))
    max_ns_.store(taken_ns, std::memory_order_relaxed);
}

LatencySummary LatencyHistogram::summary() const {
  LatencySummary out;
  for (const auto& count : counts_) out.count += count.load(std::memory_order_relaxed);
  if (out.count == 0) return out;
  out.max_s =
      static_cast<double>(max_ns_.load(std::memory_order_relaxed)) / static_cast<double>(kNsPerS);
  // The value that a share of all is not above.
  const auto quantile_s = [&](double share) {
    const auto rank = static_cast<std::int64_t>(std::ceil(share * static_cast<double>(out.count)));
    std::int64_t below = 0;
    for (std::size_t i = 0; i < kBins; ++i) {
      below += counts_[i].load(std::memory_order_relaxed);
      if (below >= rank) return std::min(centre_s(i), out.max_s);
    }
    return out.max_s;
  };
  out.p50_s = quantile_s(0.5);
  out.p99_s = quantile_s(0.99);
  out.p999_s = quantile_s(0.999);
  return out;
}

}  // namespace lsv
