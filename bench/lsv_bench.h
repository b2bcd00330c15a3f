// SPDX-License-Identifier: BSD-3-Clause
// What the benchmarks of lsv_bench share: registration per file, and failing when an answer is
// wrong.
#pragma once

#include <benchmark/benchmark.h>

#include <string>

namespace lsv::bench {

void register_stages();
void register_pushes();
void register_tracks();
void register_opencv();
void register_fusion();

/// Marks the benchmark as failed unless `complaint` is empty; the program then ends with 1.
void require(benchmark::State& state, const std::string& complaint);

}  // namespace lsv::bench
