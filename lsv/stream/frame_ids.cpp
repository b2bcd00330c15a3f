// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/stream/frame_ids.h"

namespace lsv {
namespace {
constexpr std::int64_t kHistory = 64;
}  // namespace

FrameIds::FrameIds(int bits, bool skips_zero)
    : mask_(bits >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << bits) - 1),
      count_(mask_ + (skips_zero ? 0 : 1)),
      skips_zero_(skips_zero) {}

std::uint64_t FrameIds::position(std::uint64_t id) const {
  const std::uint64_t masked = id & mask_;
  if (!skips_zero_) return masked;
  return masked == 0 ? (newest_ + 1) % count_ : masked - 1;
}

std::int64_t FrameIds::step(std::uint64_t id) const {
  if (!has_newest_) return 1;
  const std::uint64_t at = position(id);
  std::uint64_t ahead = at - newest_;
  if (count_ == 0) return static_cast<std::int64_t>(ahead);
  if (at < newest_) ahead += count_;
  return ahead <= count_ / 2 ? static_cast<std::int64_t>(ahead)
                             : -static_cast<std::int64_t>(count_ - ahead);
}

bool FrameIds::seen(std::int64_t step) const {
  return step > -kHistory && step <= 0 && ((history_ >> -step) & 1U) != 0;
}

void FrameIds::accept(std::uint64_t id, std::int64_t step) {
  history_ = has_newest_ && step < kHistory ? history_ << step | 1U : 1U;
  newest_ = position(id);
  has_newest_ = true;
}

void FrameIds::mark(std::int64_t step) {
  if (step > -kHistory && step <= 0) history_ |= std::uint64_t{1} << -step;
}

void FrameIds::forget() {
  has_newest_ = false;
  history_ = 0;
}

}  // namespace lsv
