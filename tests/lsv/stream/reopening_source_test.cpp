// SPDX-License-Identifier: BSD-3-Clause
// R1: a camera that is unplugged and plugged in again.
#include "lsv/stream/reopening_source.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <thread>

#include "lsv/stream/stream.h"
#include "tests/lsv/stream/test_camera.h"

namespace lsv {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

/// The cable, and what the cameras at its end do.
struct Cable {
  std::atomic<bool> plugged{true};
  std::atomic<bool> silent{false};  // unplugged cameras do not fail, they say nothing
  std::atomic<bool> blocks{false};  // opening one takes for ever
  std::atomic<int> failures{0};     // that many attempts to open one will fail
  std::atomic<int> hiccups{0};      // that many times a camera fails although plugged
  std::atomic<int> cameras{0};      // open now
  std::atomic<int> attempts{0};
};

/// 2,000 frames per second while plugged. Holds a file, as cameras do.
class CableCamera : public LiveSource {
 public:
  explicit CableCamera(std::shared_ptr<Cable> cable)
      : cable_(std::move(cable)), info_(test::loop_info()), file_(::open("/dev/null", O_RDONLY)) {
    ++cable_->cameras;
  }
  ~CableCamera() override {
    ::close(file_);
    --cable_->cameras;
  }
  const LiveSourceInfo& info() const override { return info_; }
  Result<Grab> grab(Frame& out, FrameLabel& label, std::int64_t timeout_ns) override {
    std::this_thread::sleep_for(std::chrono::nanoseconds(std::min(timeout_ns, 500'000L)));
    if (!cable_->plugged) {
      if (cable_->silent) return Grab::nothing;
      return Error{ErrorCode::bad_input, "control lost"};
    }
    if (cable_->hiccups > 0) {
      --cable_->hiccups;
      return Error{ErrorCode::bad_input, "control lost"};
    }
    const FrameView picture = test::loop().frame(next_);
    out.reset(picture.format);
    for (int y = 0; y < picture.height_px(); ++y)
      std::copy_n(picture.row8(y), picture.width_px(), out.row8(y));
    label = {.camera_id = static_cast<std::uint64_t>(++next_),  // from 1 on in every life
             .camera_ns = 1000 + next_ * test::kPeriod_ns,
             .arrival_ns = host_now_ns()};
    return Grab::frame;
  }
  void stop() override {}
  std::int64_t transport_losses() const override { return 7; }

 private:
  std::shared_ptr<Cable> cable_;
  LiveSourceInfo info_;
  int file_;
  std::int64_t next_ = 0;
};

ReopeningSource::Factory factory(const std::shared_ptr<Cable>& cable) {
  return [cable]() -> Result<std::unique_ptr<LiveSource>> {
    ++cable->attempts;
    while (cable->blocks) std::this_thread::sleep_for(milliseconds(1));
    if (cable->failures > 0) {
      --cable->failures;
      return Error{ErrorCode::bad_input, "no camera there"};
    }
    if (!cable->plugged && !cable->silent) return Error{ErrorCode::bad_input, "no camera there"};
    return std::unique_ptr<LiveSource>(std::make_unique<CableCamera>(cable));
  };
}

constexpr ReopenPolicy kQuick{.attempts = 4,
                              .first_pause_ns = 1'000'000,
                              .longest_pause_ns = 2'000'000,
                              .silence_ns = 5'000'000,
                              .first_frame_ns = 5'000'000};

/// For ever is 20 s here.
template <typename Condition>
bool soon(const Condition& holds) {
  const auto until = steady_clock::now() + std::chrono::seconds(20);
  while (!holds() && steady_clock::now() < until) std::this_thread::sleep_for(milliseconds(1));
  return holds();
}

std::ptrdiff_t open_files() {
  const std::filesystem::directory_iterator files("/proc/self/fd");
  return std::distance(begin(files), end(files));
}

TEST(ReopeningSource, FollowsAHundredUnplugsWithoutALeak) {
  ReopenPolicy patient = kQuick;
  patient.attempts = 1'000'000;
  for (const bool silent : {false, true}) {
    const auto cable = std::make_shared<Cable>();
    cable->silent = silent;
    const std::ptrdiff_t files_before = open_files();
    test::KeepingSink sink;
    {
      auto stream = Stream::start(ReopeningSource::open(factory(cable), patient).value(),
                                  test::loop_config(), {.lost_after_ns = 4'000'000}, {&sink})
                        .value();
      std::int64_t received = 0;
      for (int cycle = 0; cycle < 100; ++cycle) {
        ASSERT_TRUE(soon([&] { return stream->health().received > received; })) << cycle;
        cable->plugged = false;
        const std::int64_t restarts = stream->health().restarts;
        const int attempts = cable->attempts;
        ASSERT_TRUE(soon([&] { return cable->attempts > attempts; })) << cycle;
        received = stream->health().received;
        cable->plugged = true;
        ASSERT_TRUE(soon([&] { return stream->health().restarts > restarts; })) << cycle;
      }
      ASSERT_TRUE(soon([&] { return stream->health().received > received; }));
      stream->stop();
      EXPECT_GE(stream->health().restarts, 100);
      EXPECT_GE(stream->health().transport_losses, 7 * 101) << "of all the cameras there were";
      test::expect_balanced(stream->health());
      EXPECT_EQ(test::rejected(stream->health(), FrameRejection::late), 0);
      EXPECT_EQ(test::rejected(stream->health(), FrameRejection::duplicate), 0);
    }
    EXPECT_EQ(cable->cameras, 0);
    EXPECT_EQ(open_files(), files_before);
    EXPECT_GE(sink.count("source_reopened"), 100);
    // A new life of the camera is no step back in time, nor in the frames.
    for (std::size_t i = 1; i < sink.reports.size(); ++i) {
      ASSERT_GT(sink.reports[i].step.frame, sink.reports[i - 1].step.frame);
      ASSERT_GT(sink.reports[i].step.stamp, sink.reports[i - 1].step.stamp);
    }
  }
}

// Every frame refills it, so trouble may come any number of times.
TEST(ReopeningSource, GivesUpWhenItsBudgetIsSpent) {
  const auto cable = std::make_shared<Cable>();
  test::KeepingSink sink;
  auto stream = Stream::start(ReopeningSource::open(factory(cable), kQuick).value(),
                              test::loop_config(), {}, {&sink})
                    .value();
  for (int cycle = 0; cycle < 5; ++cycle) {
    const std::int64_t received = stream->health().received;
    ASSERT_TRUE(soon([&] { return stream->health().received > received; })) << cycle;
    cable->failures = kQuick.attempts - 1;
    cable->hiccups = 1;
    ASSERT_TRUE(soon([&] { return stream->health().restarts == cycle + 1; })) << cycle;
  }
  const std::int64_t received = stream->health().received;
  ASSERT_TRUE(soon([&] { return stream->health().received > received; }));
  EXPECT_FALSE(stream->finished());
  const int attempts = cable->attempts;
  cable->plugged = false;
  ASSERT_TRUE(soon([&] { return stream->finished(); }));
  EXPECT_EQ(stream->health().state, StreamState::degraded);
  EXPECT_EQ(cable->attempts, attempts + kQuick.attempts);
  ASSERT_EQ(sink.count("source_failed"), 1);
  const std::string why = sink.text("source_failed");
  EXPECT_NE(why.find("given up after 4 attempts"), std::string::npos) << why;
  EXPECT_NE(why.find("no camera there"), std::string::npos) << why;
}

// It opens every time and never sends anything.
TEST(ReopeningSource, ACameraThatOpensButSendsNothingSpendsTheBudgetToo) {
  const auto cable = std::make_shared<Cable>();
  cable->silent = true;
  auto stream =
      Stream::start(ReopeningSource::open(factory(cable), kQuick).value(), test::loop_config(), {})
          .value();
  cable->plugged = false;
  ASSERT_TRUE(soon([&] { return stream->finished(); }));
  EXPECT_EQ(stream->health().state, StreamState::degraded);
  EXPECT_EQ(cable->attempts, 1 + 4);
}

TEST(ReopeningSource, StopsWithinHalfASecondWhileOpeningBlocks) {
  const auto cable = std::make_shared<Cable>();
  auto stream =
      Stream::start(ReopeningSource::open(factory(cable), kQuick).value(), test::loop_config(), {})
          .value();
  cable->blocks = true;
  cable->plugged = false;
  ASSERT_TRUE(soon([&] { return cable->attempts == 2; }));
  const auto begin = steady_clock::now();
  stream.reset();
  EXPECT_LT(steady_clock::now() - begin, milliseconds(500));
  cable->blocks = false;
  ASSERT_TRUE(soon([&] { return cable.use_count() == 1; })) << "nothing is left behind";
}

TEST(ReopeningSource, OpensAnewOnRequest) {
  const auto cable = std::make_shared<Cable>();
  const auto source = ReopeningSource::open(factory(cable), kQuick).value();
  Frame frame;
  FrameLabel label;
  EXPECT_EQ(source->grab(frame, label, 1'000'000).value(), Grab::frame);
  EXPECT_TRUE(source->reopen());
  ASSERT_TRUE(soon([&] { return source->grab(frame, label, 1'000'000).value() == Grab::frame; }));
  EXPECT_EQ(source->restarts(), 1);
  EXPECT_EQ(cable->cameras, 1);
}

TEST(ReopeningSource, SaysWhyTheFirstOpeningFailed) {
  const auto cable = std::make_shared<Cable>();
  cable->plugged = false;
  const auto source = ReopeningSource::open(factory(cable), kQuick);
  ASSERT_FALSE(source);
  EXPECT_EQ(source.error().message, "no camera there");
}

}  // namespace
}  // namespace lsv
