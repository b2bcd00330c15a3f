// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/run_program.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace lsv::test {
namespace {

std::string unique_name() {
  const testing::TestInfo* const test = testing::UnitTest::GetInstance()->current_test_info();
  std::string name = std::string("lsv_") + test->test_suite_name() + "_" + test->name() + "_" +
                     std::to_string(::getpid());
  std::replace(name.begin(), name.end(), '/', '_');
  return name;
}

[[noreturn]] void become(const std::vector<std::string>& args, const std::string& files,
                         const std::vector<std::string>& environment) {
  if (std::freopen((files + ".in").c_str(), "r", stdin) == nullptr ||
      std::freopen((files + ".out").c_str(), "w", stdout) == nullptr ||
      std::freopen((files + ".err").c_str(), "w", stderr) == nullptr)
    ::_exit(126);
  for (const std::string& entry : environment) ::putenv(const_cast<char*>(entry.c_str()));
  std::vector<char*> argv;
  for (const std::string& arg : args) argv.push_back(const_cast<char*>(arg.c_str()));
  argv.push_back(nullptr);
  ::execv(argv[0], argv.data());
  ::_exit(127);
}

}  // namespace

std::string fresh_directory() {
  const std::filesystem::path path = std::filesystem::path(testing::TempDir()) / unique_name();
  std::filesystem::remove_all(path);
  std::filesystem::create_directories(path);
  return path.string();
}

std::string read_text(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

void write_text(const std::string& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

ProgramResult run_program(const std::vector<std::string>& args, const std::string& input,
                          const std::vector<std::string>& environment) {
  const std::string files = testing::TempDir() + unique_name() + "_streams";
  std::ofstream(files + ".in", std::ios::binary) << input;
  const auto start = std::chrono::steady_clock::now();
  std::fflush(nullptr);  // or the child prints what is still buffered here once more
  const pid_t child = ::fork();
  if (child == 0) become(args, files, environment);
  int status = 0;
  struct rusage usage = {};
  ::wait4(child, &status, 0, &usage);

  ProgramResult out;
  out.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  out.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  out.peak_rss_mib = static_cast<double>(usage.ru_maxrss) / 1024.0;
  out.out = read_text(files + ".out");
  out.err = read_text(files + ".err");
  for (const char* suffix : {".in", ".out", ".err"}) std::filesystem::remove(files + suffix);
  return out;
}

}  // namespace lsv::test
