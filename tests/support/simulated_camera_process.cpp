// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/simulated_camera_process.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <fstream>
#include <sstream>

#include "tests/support/run_program.h"

namespace lsv::test {
namespace {

constexpr int kReadyWithin_ms = 60'000;

std::string read_all(int fd) {
  std::string text;
  std::array<char, 4096> block{};
  ssize_t got = 0;
  while ((got = ::read(fd, block.data(), block.size())) > 0)
    text.append(block.data(), static_cast<std::size_t>(got));
  return text;
}

}  // namespace

SimulatedCameraProcess::SimulatedCameraProcess(const std::string& program,
                                               std::vector<std::string> args)
    : truth_path_(fresh_directory() + "/truth.csv") {
  args.insert(args.begin(), program);
  args.insert(args.end(), {"--truth", truth_path_});
  std::vector<char*> argv;
  for (std::string& arg : args) argv.push_back(arg.data());
  argv.push_back(nullptr);
  std::array<int, 2> err{};
  std::array<int, 2> out{};
  if (::pipe2(err.data(), O_CLOEXEC) != 0 || ::pipe2(out.data(), O_CLOEXEC) != 0) return;
  pid_ = ::fork();
  if (pid_ == 0) {
    ::dup2(err[1], STDERR_FILENO);
    ::dup2(out[1], STDOUT_FILENO);
    ::execv(argv[0], argv.data());
    ::_exit(127);
  }
  ::close(err[1]);
  ::close(out[1]);
  err_ = err[0];
  out_ = out[0];
  await_ready();
}

SimulatedCameraProcess::~SimulatedCameraProcess() {
  kill();
  if (err_ >= 0) ::close(err_);
  if (out_ >= 0) ::close(out_);
}

void SimulatedCameraProcess::await_ready() {
  const auto start = std::chrono::steady_clock::now();
  pollfd wait = {.fd = err_, .events = POLLIN, .revents = 0};
  while (std::chrono::steady_clock::now() - start < std::chrono::milliseconds(kReadyWithin_ms)) {
    if (::poll(&wait, 1, 100) <= 0) continue;
    std::array<char, 512> block{};
    const ssize_t got = ::read(err_, block.data(), block.size());
    if (got <= 0) return;
    messages_.append(block.data(), static_cast<std::size_t>(got));
    ready_ = messages_.find("is ready") != std::string::npos;
    if (ready_) return;
  }
}

void SimulatedCameraProcess::kill() {
  if (pid_ <= 0) return;
  ::kill(pid_, SIGKILL);
  ::waitpid(pid_, nullptr, 0);
  pid_ = -1;
}

void SimulatedCameraProcess::finish() {
  if (pid_ <= 0) return;
  const auto start = std::chrono::steady_clock::now();
  ::kill(pid_, SIGINT);
  printed_ = read_all(out_);
  int status = 0;
  ::waitpid(pid_, &status, 0);
  pid_ = -1;
  stopped_after_s_ =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  exit_code_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  messages_ += read_all(err_);
  read_truth();
}

void SimulatedCameraProcess::read_truth() {
  std::ifstream file(truth_path_);
  std::string line;
  while (std::getline(file, line)) {
    if (line.empty() || line[0] == '#' || line[0] == 'c') continue;
    std::vector<std::string> cells;
    std::istringstream row(line);
    for (std::string cell; std::getline(row, cell, ',');) cells.push_back(cell);
    if (cells.size() != 7) continue;
    const SentRow sent{.camera_id = std::stoull(cells[0]),
                       .stamp_ns = std::stoll(cells[1]),
                       .x_px = std::stod(cells[2]),
                       .y_px = std::stod(cells[3]),
                       .checksum = std::stoull(cells[6], nullptr, 16)};
    sent_.emplace(sent.stamp_ns, sent);
  }
}

}  // namespace lsv::test
