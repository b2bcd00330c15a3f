// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/ingest/input_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

namespace lsv {
namespace {

Error cannot_open(const std::string& path, int error_number) {
  return {ErrorCode::bad_input, path + ": cannot be opened: " + std::strerror(error_number)};
}

const char* kind_of(mode_t mode) {
  if (S_ISDIR(mode)) return "a directory";
  if (S_ISFIFO(mode)) return "a named pipe; read it as raw frames with `lsv ... - < pipe`";
  return "a device or a socket";
}

}  // namespace

FileHandle& FileHandle::operator=(FileHandle&& other) noexcept {
  if (this != &other) {
    close();
    fd_ = other.release();
  }
  return *this;
}

int FileHandle::release() { return std::exchange(fd_, -1); }

void FileHandle::close() {
  if (fd_ >= 0) ::close(fd_);
  fd_ = -1;
}

Result<InputFile> open_regular_file(const std::string& path) {
  // O_NONBLOCK: opening a FIFO nobody writes to would otherwise wait for ever.
  FileHandle handle(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOCTTY | O_NONBLOCK));
  if (handle.fd() < 0) return cannot_open(path, errno);
  struct stat status {};
  if (::fstat(handle.fd(), &status) != 0) return cannot_open(path, errno);
  if (!S_ISREG(status.st_mode)) {
    return Error{ErrorCode::bad_input,
                 path + ": is not a regular file but " + kind_of(status.st_mode)};
  }
  return InputFile{std::move(handle), static_cast<std::int64_t>(status.st_size)};
}

Result<std::size_t> read_fully(int fd, std::span<std::uint8_t> into, const std::string& name) {
  std::size_t done = 0;
  while (done < into.size()) {
    const ssize_t got = ::read(fd, into.data() + done, into.size() - done);
    if (got == 0) break;
    if (got > 0) {
      done += static_cast<std::size_t>(got);
    } else {
      // EINTR too: the caller installed a handler because it wants to be let out of a pipe.
      return Error{ErrorCode::bad_input, name + ": cannot be read: " + std::strerror(errno)};
    }
  }
  return done;
}

Result<void> read_regular_file(const std::string& path, std::int64_t max_bytes,
                               std::vector<std::uint8_t>& into) {
  auto file = open_regular_file(path);
  if (!file) return file.error();
  const std::int64_t size_bytes = file.value().size_bytes;
  if (size_bytes > max_bytes) {
    return Error{ErrorCode::bad_input, path + ": holds " + std::to_string(size_bytes) +
                                           " bytes, more than the " + std::to_string(max_bytes) +
                                           " that such a file can need"};
  }
  into.resize(static_cast<std::size_t>(size_bytes));
  const auto got = read_fully(file.value().handle.fd(), into, path);
  if (!got) return got.error();
  if (got.value() != into.size()) {
    return Error{ErrorCode::bad_input, path + ": became shorter while it was read"};
  }
  return {};
}

}  // namespace lsv
