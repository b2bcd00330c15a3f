// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/mcap/byte_sink.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>
#include <utility>

namespace lsv::mcap {
namespace {

Error failure(const char* what, const std::string& path, int error_number) {
  std::string message = "cannot ";
  message += what;
  message += " " + path + ": " + std::generic_category().message(error_number);
  if (error_number == EEXIST) message += "; remove it or choose another name";
  if (error_number == ENOSPC) message += "; free space";
  return {ErrorCode::output_failed, std::move(message)};
}

class FileSink : public ByteSink {
 public:
  FileSink(std::string path, int fd) : path_(std::move(path)), fd_(fd) {}
  FileSink(const FileSink&) = delete;
  FileSink& operator=(const FileSink&) = delete;
  ~FileSink() override { ::close(fd_); }

  const std::string& name() const override { return path_; }

  Result<void> append(ByteView bytes) override {
    while (!bytes.empty()) {
      const ssize_t written = ::pwrite(fd_, bytes.data(), bytes.size(), size_bytes_);
      if (written > 0) {
        size_bytes_ += written;
        bytes = bytes.subspan(static_cast<std::size_t>(written));
      } else if (written == 0) {
        return failure("write", path_, EIO);
      } else if (errno != EINTR) {
        return failure("write", path_, errno);
      }
    }
    return {};
  }

  Result<void> truncate(std::int64_t size_bytes) override {
    while (::ftruncate(fd_, size_bytes) != 0) {
      if (errno != EINTR) return failure("shorten", path_, errno);
    }
    size_bytes_ = size_bytes;
    return {};
  }

  Result<void> sync() override {
    // After EINTR nobody knows what reached the disk, so it is asked for again.
    while (::fdatasync(fd_) != 0) {
      if (errno != EINTR) return failure("sync", path_, errno);
    }
    return {};
  }

 private:
  std::string path_;
  int fd_;
  std::int64_t size_bytes_ = 0;
};

}  // namespace

Result<std::unique_ptr<ByteSink>> create_file(const std::string& path) {
  const int fd = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (fd < 0) return failure("create", path, errno);
  return std::unique_ptr<ByteSink>(std::make_unique<FileSink>(path, fd));
}

}  // namespace lsv::mcap
