// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/mcap/byte_source.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <system_error>
#include <utility>

namespace lsv::mcap {
namespace {

Error bad_input(const std::string& name, const std::string& what) {
  return {ErrorCode::bad_input, name + ": " + what};
}

std::string reason(int error_number) { return std::generic_category().message(error_number); }

class FileSource : public ByteSource {
 public:
  FileSource(std::string path, int fd, std::uint64_t size_bytes)
      : path_(std::move(path)), fd_(fd), size_bytes_(size_bytes) {}
  FileSource(const FileSource&) = delete;
  FileSource& operator=(const FileSource&) = delete;
  ~FileSource() override { ::close(fd_); }

  const std::string& name() const override { return path_; }
  std::uint64_t size_bytes() const override { return size_bytes_; }

  Result<void> read(std::uint64_t offset, std::span<std::byte> into) override {
    while (!into.empty()) {
      const ssize_t got = ::pread(fd_, into.data(), into.size(), static_cast<off_t>(offset));
      if (got > 0) {
        offset += static_cast<std::uint64_t>(got);
        into = into.subspan(static_cast<std::size_t>(got));
      } else if (got == 0) {
        return bad_input(path_, "became shorter while it was read");
      } else if (errno != EINTR) {
        return bad_input(path_, "cannot be read: " + reason(errno));
      }
    }
    return {};
  }

 private:
  std::string path_;
  int fd_;
  std::uint64_t size_bytes_;
};

class MemorySource : public ByteSource {
 public:
  MemorySource(std::string name, Bytes bytes) : name_(std::move(name)), bytes_(std::move(bytes)) {}

  const std::string& name() const override { return name_; }
  std::uint64_t size_bytes() const override { return bytes_.size(); }
  Result<void> read(std::uint64_t offset, std::span<std::byte> into) override {
    if (!into.empty())
      std::memcpy(into.data(), bytes_.data() + static_cast<std::size_t>(offset), into.size());
    return {};
  }

 private:
  std::string name_;
  Bytes bytes_;
};

}  // namespace

Result<std::unique_ptr<ByteSource>> open_file(const std::string& path) {
  // O_NONBLOCK: opening a FIFO nobody writes to would otherwise wait for ever.
  const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOCTTY | O_NONBLOCK);
  if (fd < 0) return bad_input(path, "cannot be opened: " + reason(errno));
  struct stat status {};
  const bool known = ::fstat(fd, &status) == 0;
  if (!known || !S_ISREG(status.st_mode)) {
    ::close(fd);
    return bad_input(path, "is not a regular file");
  }
  return std::unique_ptr<ByteSource>(
      std::make_unique<FileSource>(path, fd, static_cast<std::uint64_t>(status.st_size)));
}

std::unique_ptr<ByteSource> memory_source(std::string name, Bytes bytes) {
  return std::make_unique<MemorySource>(std::move(name), std::move(bytes));
}

}  // namespace lsv::mcap
