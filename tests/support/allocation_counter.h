// SPDX-License-Identifier: BSD-3-Clause
// Counts the allocations of the whole program, by taking the place of malloc's entry points. Link
// allocation_counter.cpp; not under a sanitizer, which brings its own allocator.
#pragma once

namespace lsv::test {

/// Begins at 0, or ends.
void count_allocations(bool on);
long allocations();

}  // namespace lsv::test
