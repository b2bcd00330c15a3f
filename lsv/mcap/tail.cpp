// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/mcap/tail.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <system_error>
#include <utility>

#include "lsv/mcap/crc32.h"
#include "lsv/mcap/reader.h"

namespace lsv::mcap {
namespace {

constexpr std::array kTailMagic = {std::byte{0x89}, std::byte{'L'}, std::byte{'S'},
                                   std::byte{'V'},  std::byte{'T'}, std::byte{'1'},
                                   std::byte{'\r'}, std::byte{'\n'}};
// Apart, so that no write to one can touch the other.
constexpr std::array<std::size_t, 2> kSlotAt_bytes = {1024, 2048};
constexpr std::size_t kRecordsAt_bytes = 4096;

struct Slot {
  std::uint64_t chunk = 0;
  std::uint64_t length_bytes = 0;
  std::uint32_t records_crc = 0;
  std::uint32_t slot_crc = 0;  // of the three before; 0 is never written, it is an empty file's
};
static_assert(sizeof(Slot) == 24);

std::uint32_t crc_of(const Slot& slot) {
  const std::uint32_t crc =
      crc32(ByteView(reinterpret_cast<const std::byte*>(&slot), offsetof(Slot, slot_crc)));
  return crc == 0 ? 1 : crc;
}

Error failure(const char* what, const std::string& path, int error_number) {
  return {ErrorCode::output_failed, std::string("cannot ") + what + " " + path + ": " +
                                        std::generic_category().message(error_number)};
}

}  // namespace

std::string tail_path(const std::string& recording_path) { return recording_path + ".tail"; }

Result<std::unique_ptr<TailFile>> TailFile::create(const std::string& path,
                                                   std::size_t chunk_bytes) {
  const int fd = ::open(path.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (fd < 0 && errno == EEXIST) {
    return Error{ErrorCode::output_failed,
                 path +
                     ": is left from a recording that was cut short; save it with lsv recover, "
                     "then remove both files"};
  }
  if (fd < 0) return failure("create", path, errno);
  const std::size_t map_bytes = kRecordsAt_bytes + chunk_bytes;
  const auto give_up = [&](const char* what, int error_number) {
    ::close(fd);
    ::unlink(path.c_str());
    return failure(what, path, error_number);
  };
  int reserved = 0;
  do {
    reserved = ::posix_fallocate(fd, 0, static_cast<off_t>(map_bytes));
  } while (reserved == EINTR);
  if (reserved != 0) return give_up("reserve space for", reserved);
  void* const map =
      ::mmap(nullptr, map_bytes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_POPULATE, fd, 0);
  if (map == MAP_FAILED) return give_up("map", errno);
  ::close(fd);
  auto* const bytes = static_cast<std::byte*>(map);
  std::ranges::copy(kTailMagic, bytes);
  return std::unique_ptr<TailFile>(new TailFile(path, bytes, map_bytes));
}

TailFile::TailFile(std::string path, std::byte* map, std::size_t map_bytes)
    : path_(std::move(path)), map_(map), map_bytes_(map_bytes) {}

TailFile::~TailFile() { ::munmap(map_, map_bytes_); }

std::span<std::byte> TailFile::bytes() {
  return {map_ + kRecordsAt_bytes, map_bytes_ - kRecordsAt_bytes};
}

void TailFile::commit(std::uint64_t number, std::size_t length_bytes, std::uint32_t crc) {
  Slot slot{.chunk = number, .length_bytes = length_bytes, .records_crc = crc};
  slot.slot_crc = crc_of(slot);
  // A killed process has made its stores in the order of the program, and so must the compiler.
  std::atomic_signal_fence(std::memory_order_seq_cst);
  std::memcpy(map_ + kSlotAt_bytes[next_slot_], &slot, sizeof slot);
  std::atomic_signal_fence(std::memory_order_seq_cst);
  next_slot_ ^= 1U;
}

void TailFile::remove() { ::unlink(path_.c_str()); }

Result<std::optional<TailContent>> read_tail(ByteSource& source) {
  if (source.size_bytes() < kRecordsAt_bytes) return std::optional<TailContent>();
  std::array<std::byte, kRecordsAt_bytes> page{};
  if (Result<void> read = source.read(0, page); !read) return read.error();
  if (!std::equal(kTailMagic.begin(), kTailMagic.end(), page.begin()))
    return std::optional<TailContent>();
  std::array<Slot, 2> slots;
  for (std::size_t i = 0; i < slots.size(); ++i)
    std::memcpy(&slots[i], page.data() + kSlotAt_bytes[i], sizeof(Slot));
  std::ranges::sort(slots, [](const Slot& a, const Slot& b) {
    return std::pair(a.chunk, a.length_bytes) > std::pair(b.chunk, b.length_bytes);
  });
  for (const Slot& slot : slots) {
    const std::uint64_t most_bytes =
        std::min(source.size_bytes() - kRecordsAt_bytes, kMaxRecord_bytes);
    if (slot.slot_crc != crc_of(slot) || slot.length_bytes > most_bytes) continue;
    TailContent content{.chunk = slot.chunk, .records = {}};
    content.records.resize(static_cast<std::size_t>(slot.length_bytes));
    if (Result<void> read = source.read(kRecordsAt_bytes, content.records); !read)
      return read.error();
    if (crc32(content.records) == slot.records_crc)
      return std::optional<TailContent>(std::move(content));
  }
  return std::optional<TailContent>();
}

}  // namespace lsv::mcap
