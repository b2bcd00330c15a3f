// SPDX-License-Identifier: BSD-3-Clause
// Gives every block allocated in a scope a chosen content, so that a result that depends on memory
// nobody wrote differs between two values each time, not once in a million runs: AddressSanitizer
// by itself fills only the first 4096 bytes, always alike.
#pragma once

#include <sanitizer/allocator_interface.h>

#include <cstddef>
#include <cstring>

namespace lsv::fuzz {

/// One at a time, on one thread.
class HeapFill {
 public:
  explicit HeapFill(int value) {
    static const int hooked = __sanitizer_install_malloc_and_free_hooks(fill, ignore);
    static_cast<void>(hooked);
    value_ = value;
  }
  HeapFill(const HeapFill&) = delete;
  HeapFill& operator=(const HeapFill&) = delete;
  ~HeapFill() { value_ = kOff; }

 private:
  static constexpr int kOff = -1;
  // Larger blocks are mapped from the system, and calloc trusts that they are zero.
  static constexpr std::size_t kMaxBlock_bytes = std::size_t{64} << 10;

  static void fill(const volatile void* block, std::size_t size_bytes) {
    if (value_ != kOff && size_bytes <= kMaxBlock_bytes)
      std::memset(const_cast<void*>(block), value_, size_bytes);
  }
  static void ignore(const volatile void*) {}

  static inline int value_ = kOff;
};

}  // namespace lsv::fuzz
