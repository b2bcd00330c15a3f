// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/output/output_file.h"

#include <fcntl.h>
#include <pthread.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <system_error>
#include <utility>

namespace lsv {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kBlock_bytes = std::size_t{64} << 10;

std::string reason(int error_number) { return std::generic_category().message(error_number); }

/// While it lives, a write to a closed pipe of this thread fails with EPIPE and raises nothing.
class SigpipeBlock {
 public:
  SigpipeBlock() {
    sigemptyset(&sigpipe_);
    sigaddset(&sigpipe_, SIGPIPE);
    sigset_t pending;
    sigpending(&pending);
    was_pending_ = sigismember(&pending, SIGPIPE) == 1;
    pthread_sigmask(SIG_BLOCK, &sigpipe_, &before_);
  }
  ~SigpipeBlock() {
    const timespec no_wait{};
    if (!was_pending_) sigtimedwait(&sigpipe_, nullptr, &no_wait);
    pthread_sigmask(SIG_SETMASK, &before_, nullptr);
  }
  SigpipeBlock(const SigpipeBlock&) = delete;
  SigpipeBlock& operator=(const SigpipeBlock&) = delete;

 private:
  sigset_t sigpipe_;
  sigset_t before_;
  bool was_pending_;
};

/// 0 or the errno of the write that failed.
int write_all(int fd, std::string_view text) {
  const SigpipeBlock no_signal;
  while (!text.empty()) {
    const ssize_t written = ::write(fd, text.data(), text.size());
    if (written > 0) {
      text.remove_prefix(static_cast<std::size_t>(written));
    } else if (written == 0) {
      return EIO;
    } else if (errno != EINTR) {
      return errno;
    }
  }
  return 0;
}

/// A link is followed, so that the file it names is replaced and not the link itself.
std::string resolved(const std::string& path) {
  std::error_code failed;
  const fs::path target = fs::canonical(path, failed);
  return failed ? path : target.string();
}

Error open_error(const std::string& path, int error_number) {
  std::error_code unknown;
  const fs::path directory = fs::path(path).parent_path();
  if (error_number == ENOENT && !directory.empty() && !fs::exists(directory, unknown)) {
    return {ErrorCode::output_failed, "cannot write " + path + ": the directory " +
                                          directory.string() + " does not exist; create it first"};
  }
  return {ErrorCode::output_failed, "cannot write " + path + ": " + reason(error_number)};
}

/// True while `fd` is the file now found at `path`: another writer may have renamed it meanwhile.
bool still_at(int fd, const std::string& path) {
  struct stat by_fd {};
  struct stat by_path {};
  return ::fstat(fd, &by_fd) == 0 && ::stat(path.c_str(), &by_path) == 0 &&
         by_fd.st_dev == by_path.st_dev && by_fd.st_ino == by_path.st_ino;
}

}  // namespace

Result<OutputFile> OutputFile::open(const std::string& path) {
  if (path.empty())
    return Error{ErrorCode::output_failed, "an output file name is empty: name a file or \"-\""};
  if (path == "-") return OutputFile("standard output", STDOUT_FILENO);

  struct stat target {};
  const bool exists = ::stat(path.c_str(), &target) == 0;
  if (exists && S_ISDIR(target.st_mode))
    return Error{ErrorCode::output_failed,
                 "cannot write " + path + ": it is a directory; name a file in it"};
  // A device or a pipe must not be replaced by a file of the same name.
  if (exists && !S_ISREG(target.st_mode)) return open_stream(path);
  return open_part(path);
}

Result<OutputFile> OutputFile::open_stream(const std::string& path) {
  const int fd = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
  if (fd < 0) return open_error(path, errno);
  return OutputFile(path, fd);
}

Result<OutputFile> OutputFile::open_part(const std::string& path) {
  const std::string target_path = resolved(path);
  const std::string part_path = target_path + ".part";
  const int fd = ::open(part_path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666);
  if (fd < 0) return open_error(path, errno);

  // The lock keeps two writers out of one part file; a part file left by a crash has none.
  if (::flock(fd, LOCK_EX | LOCK_NB) != 0 || !still_at(fd, part_path)) {
    ::close(fd);
    return Error{ErrorCode::output_failed,
                 "cannot write " + path + ": " + part_path +
                     " is being written already; give every output its own name"};
  }
  OutputFile file(path, fd);
  file.target_path_ = target_path;
  file.part_path_ = part_path;
  if (::ftruncate(fd, 0) != 0) return file.abandon("empty the part file of", errno);
  return file;
}

OutputFile::OutputFile(OutputFile&& other) noexcept
    : name_(std::move(other.name_)),
      fd_(std::exchange(other.fd_, -1)),
      target_path_(std::move(other.target_path_)),
      part_path_(std::exchange(other.part_path_, {})),
      pending_(std::move(other.pending_)) {}

OutputFile::~OutputFile() { discard(); }

void OutputFile::discard() {
  // Removed before the lock goes with the descriptor, so that no other writer's file is hit.
  if (fd_ >= 0 && !is_stream()) ::unlink(part_path_.c_str());
  if (fd_ >= 0 && fd_ != STDOUT_FILENO) ::close(fd_);
  fd_ = -1;
}

Result<void> OutputFile::write(std::string_view text) {
  if (fd_ < 0) return closed();
  pending_ += text;
  if (is_stream() || pending_.size() >= kBlock_bytes) return flush();
  return {};
}

Result<void> OutputFile::complete() {
  if (fd_ < 0) return closed();
  if (auto flushed = flush(); !flushed) return flushed;
  return sync();
}

Result<void> OutputFile::commit() {
  if (auto completed = complete(); !completed) return completed;
  if (is_stream()) return {};
  // Renamed before the lock goes with the descriptor; fsync has left close nothing to lose.
  if (::rename(part_path_.c_str(), target_path_.c_str()) != 0) return abandon("rename", errno);
  if (::close(std::exchange(fd_, -1)) != 0) return failure("close", errno);
  return {};
}

Result<void> OutputFile::flush() {
  const int error_number = write_all(fd_, pending_);
  pending_.clear();
  if (error_number != 0) return abandon("write", error_number);
  return {};
}

Result<void> OutputFile::sync() {
  // Without it a full or failing disk may lose the text after the rename has succeeded. Pipes
  // and terminals have nothing to sync and answer EINVAL.
  if (::fsync(fd_) == 0 || (is_stream() && (errno == EINVAL || errno == ENOTSUP))) return {};
  return abandon("write", errno);
}

Error OutputFile::closed() const {
  return {ErrorCode::output_failed, "cannot write " + name_ + ": it is closed already"};
}

Error OutputFile::abandon(const char* what, int error_number) {
  // A file with a hole in it must never be committed later.
  discard();
  return failure(what, error_number);
}

Error OutputFile::failure(const char* what, int error_number) const {
  std::string message = "cannot ";
  message += what;
  message += " " + name_ + ": " + reason(error_number);
  if (error_number == ENOSPC) message += "; free space and run again";
  if (error_number == EPIPE) message += "; the program that read it has ended";
  return {ErrorCode::output_failed, std::move(message)};
}

Result<void> write_file(const std::string& path, std::string_view text) {
  Result<OutputFile> file = OutputFile::open(path);
  if (!file) return file.error();
  if (Result<void> written = file.value().write(text); !written) return written;
  return file.value().commit();
}

}  // namespace lsv
