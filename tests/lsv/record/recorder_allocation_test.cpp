// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "tests/lsv/record/recorded_stream.h"
#include "tests/support/allocation_counter.h"

namespace lsv {
namespace {

TEST(RecorderAllocation, OnReportAllocatesNothing) {
  test::Disk disk;
  RecorderOptions options{.format = test::kSmallFormat, .queue_frames = 64};
  options.flush_ns = 1;
  auto recorder = Recorder::create(options, disk.sink());
  ASSERT_TRUE(recorder.ok());
  Frame frame;
  StreamReport report;
  test::fill(0, frame, report);
  // With the recorder's own thread stuck in a write, all that is counted is this one's.
  disk.stop(true);
  recorder.value()->on_report(report, frame);
  disk.wait_for_a_write();
  test::count_allocations(true);
  for (std::int64_t index = 1; index < 200; ++index) {
    test::fill(index, frame, report);
    recorder.value()->on_report(report, frame);
  }
  test::count_allocations(false);
  EXPECT_EQ(test::allocations(), 0);
  EXPECT_EQ(recorder.value()->frames_dropped(), 135) << "both when it fits and when it does not";
  disk.stop(false);
  EXPECT_TRUE(recorder.value()->close().ok());
}

}  // namespace
}  // namespace lsv
