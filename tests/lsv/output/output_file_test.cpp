// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/output/output_file.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <optional>

#include "tests/lsv/output/track_samples.h"

namespace lsv {
namespace {

using namespace testing_samples;
namespace fs = std::filesystem;

TEST(OutputFile, AppearsUnderItsNameOnlyAfterCommit) {
  const ScratchDirectory scratch;
  const std::string path = scratch.file("a.csv");
  OutputFile file = opened(path);
  ASSERT_TRUE(file.write("one\n").ok());
  EXPECT_FALSE(fs::exists(path));
  EXPECT_TRUE(fs::exists(path + ".part"));
  ASSERT_TRUE(file.commit().ok());
  EXPECT_EQ(text_of(path), "one\n");
  EXPECT_EQ(scratch.names(), std::vector<std::string>{"a.csv"});
}

TEST(OutputFile, WithoutCommitLeavesTheOldFileAndNoPart) {
  const ScratchDirectory scratch;
  const std::string path = scratch.file("a.csv");
  std::ofstream(path) << "old";
  {
    OutputFile file = opened(path);
    ASSERT_TRUE(file.write(std::string(200'000, 'x')).ok());
  }
  EXPECT_EQ(text_of(path), "old");
  EXPECT_EQ(scratch.names(), std::vector<std::string>{"a.csv"});
}

void write_and_be_killed(const std::string& path) {
  OutputFile file = opened(path);
  if (!file.write(std::string(200'000, 'x')).ok()) ::_exit(1);
  ::raise(SIGKILL);
}

TEST(OutputFile, AKilledProgramLeavesNoTarget) {
  const ScratchDirectory scratch;
  const std::string path = scratch.file("a.csv");
  EXPECT_EXIT(write_and_be_killed(path), ::testing::KilledBySignal(SIGKILL), "");
  EXPECT_FALSE(fs::exists(path));
  ASSERT_TRUE(fs::exists(path + ".part"));

  // What it left must neither block the next run nor show through in it.
  OutputFile file = opened(path);
  ASSERT_TRUE(file.write("new").ok());
  ASSERT_TRUE(file.commit().ok());
  EXPECT_EQ(text_of(path), "new");
  EXPECT_FALSE(fs::exists(path + ".part"));
}

TEST(OutputFile, LargeTextArrivesWhole) {
  const ScratchDirectory scratch;
  const std::string path = scratch.file("a");
  std::string expected;
  OutputFile file = opened(path);
  for (int i = 0; i < 50'000; ++i) {
    const std::string line = std::to_string(i) + "\n";
    expected += line;
    ASSERT_TRUE(file.write(line).ok());
  }
  ASSERT_TRUE(file.commit().ok());
  EXPECT_EQ(text_of(path), expected);
}

TEST(OutputFile, MovedFromTouchesNothing) {
  const ScratchDirectory scratch;
  const std::string path = scratch.file("a");
  std::optional<OutputFile> first = opened(path);
  OutputFile second = std::move(*first);
  first.reset();
  EXPECT_TRUE(fs::exists(path + ".part"));
  ASSERT_TRUE(second.write("text").ok());
  ASSERT_TRUE(second.commit().ok());
  EXPECT_EQ(text_of(path), "text");
}

TEST(OutputFile, MissingDirectoryIsNamed) {
  const ScratchDirectory scratch;
  const auto file = OutputFile::open(scratch.file("missing/a.csv"));
  ASSERT_FALSE(file.ok());
  EXPECT_EQ(file.error().code, ErrorCode::output_failed);
  EXPECT_NE(file.error().message.find("directory " + scratch.file("missing") + " does not exist"),
            std::string::npos)
      << file.error().message;
}

TEST(OutputFile, ADirectoryOrAnEmptyNameIsRefused) {
  const ScratchDirectory scratch;
  EXPECT_FALSE(OutputFile::open(scratch.file(".")).ok());
  EXPECT_FALSE(OutputFile::open("").ok());
}

TEST(OutputFile, TwoWritersOfOneFileAreRefused) {
  const ScratchDirectory scratch;
  const std::string path = scratch.file("a.csv");
  OutputFile file = opened(path);
  const auto second = OutputFile::open(path);
  ASSERT_FALSE(second.ok());
  EXPECT_EQ(second.error().code, ErrorCode::output_failed);
  ASSERT_TRUE(file.write("first").ok());
  ASSERT_TRUE(file.commit().ok());
  EXPECT_EQ(text_of(path), "first");
}

TEST(OutputFile, ALinkIsFollowedNotReplaced) {
  const ScratchDirectory scratch;
  std::ofstream(scratch.file("real")) << "old";
  fs::create_symlink("real", scratch.file("link"));
  OutputFile file = opened(scratch.file("link"));
  ASSERT_TRUE(file.write("new").ok());
  ASSERT_TRUE(file.commit().ok());
  EXPECT_TRUE(fs::is_symlink(scratch.file("link")));
  EXPECT_EQ(text_of(scratch.file("real")), "new");
}

TEST(OutputFile, AFullDeviceIsAnErrorThatNamesIt) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full";
  OutputFile file = opened("/dev/full");
  const Result<void> written = file.write("text");
  ASSERT_FALSE(written.ok());
  EXPECT_EQ(written.error().code, ErrorCode::output_failed);
  EXPECT_NE(written.error().message.find("/dev/full"), std::string::npos);
  EXPECT_FALSE(file.commit().ok());
  EXPECT_TRUE(fs::is_character_file("/dev/full"));
  EXPECT_FALSE(fs::exists("/dev/full.part"));
}

/// Exits with 0 if the failed write is told and cannot be committed.
void write_past_the_limit(const std::string& path) {
  // A file size limit stands in for a full disk: the write ends short, then fails.
  std::signal(SIGXFSZ, SIG_IGN);
  const rlimit limit{100'000, 100'000};
  ::setrlimit(RLIMIT_FSIZE, &limit);
  OutputFile file = opened(path);
  const Result<void> written = file.write(std::string(150'000, 'x'));
  const bool named = !written.ok() && written.error().message.find(path) != std::string::npos;
  const bool refused = !file.write("y").ok() && !file.commit().ok();
  ::_exit(named && refused ? 0 : 1);
}

TEST(OutputFile, AfterAFailedWriteNothingCanBeCommitted) {
  const ScratchDirectory scratch;
  const std::string path = scratch.file("a.csv");
  EXPECT_EXIT(write_past_the_limit(path), ::testing::ExitedWithCode(0), "");
  EXPECT_TRUE(scratch.names().empty());
}

TEST(OutputFile, AClosedPipeIsAnErrorAndNoSignal) {
  int ends[2];
  ASSERT_EQ(::pipe(ends), 0);
  ::close(ends[0]);
  const int kept_stdout = ::dup(STDOUT_FILENO);
  ::dup2(ends[1], STDOUT_FILENO);
  std::string message;
  {
    OutputFile file = opened("-");
    const Result<void> written = file.write("text\n");
    if (!written.ok()) message = written.error().message;
  }
  ::dup2(kept_stdout, STDOUT_FILENO);
  ::close(kept_stdout);
  ::close(ends[1]);
  EXPECT_NE(message.find("standard output"), std::string::npos) << message;
  sigset_t pending;
  sigpending(&pending);
  EXPECT_EQ(sigismember(&pending, SIGPIPE), 0);
}

TEST(OutputFile, StandardOutputIsPassedOnAtOnceAndStaysOpen) {
  int ends[2];
  ASSERT_EQ(::pipe(ends), 0);
  const int kept_stdout = ::dup(STDOUT_FILENO);
  ::dup2(ends[1], STDOUT_FILENO);
  bool all_ok = false;
  char received[16] = {};
  {
    OutputFile file = opened("-");
    all_ok = file.write("row\n").ok();
    all_ok = ::read(ends[0], received, sizeof received) == 4 && all_ok;
    all_ok = file.commit().ok() && all_ok;
  }
  const bool still_open = ::fcntl(STDOUT_FILENO, F_GETFD) != -1;
  ::dup2(kept_stdout, STDOUT_FILENO);
  ::close(kept_stdout);
  ::close(ends[0]);
  ::close(ends[1]);
  EXPECT_TRUE(all_ok);
  EXPECT_TRUE(still_open);
  EXPECT_STREQ(received, "row\n");
}

}  // namespace
}  // namespace lsv
