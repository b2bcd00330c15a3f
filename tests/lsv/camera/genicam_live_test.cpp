// SPDX-License-Identifier: BSD-3-Clause
// GenicamSource over the real protocol: against `lsv simulate camera`, a process of its own, which
// tells afterwards every frame that it sent. Nothing here asks for a rate: a busy machine may lose
// frames anywhere, but none may be lost in silence or come out wrong.
#include <gtest/gtest.h>

#include <chrono>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <set>
#include <thread>

#include "lsv/camera/genicam_list.h"
#include "lsv/camera/genicam_source.h"
#include "lsv/camera/gige_probe.h"
#include "tests/support/own_network.h"
#include "tests/support/run_program.h"
#include "tests/support/simulated_camera_process.h"
#include "tools/camera_simulator/pixel_checksum.h"

namespace lsv {
namespace {

using Clock = std::chrono::steady_clock;
using test::SentRow;
using test::SimulatedCameraProcess;

constexpr const char* kAddress = "127.0.0.1";
constexpr std::int64_t kMs = 1'000'000;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

struct Received {
  FrameLabel label{};
  FrameFormat format{};
  std::uint64_t checksum = 0;
};

/// What came within `seconds`, or until the camera was gone.
std::vector<Received> receive(LiveSource& source, double seconds) {
  std::vector<Received> out;
  Frame frame;
  FrameLabel label;
  for (const auto start = Clock::now(); seconds_since(start) < seconds;) {
    const Result<Grab> got = source.grab(frame, label, 100 * kMs);
    if (!got) break;
    if (got.value() == Grab::frame)
      out.push_back({label, frame.view().format, cli::pixel_checksum(frame.view())});
  }
  return out;
}

/// Frames that the ids say are missing between two: 16 bits, 65535 is followed by 1.
std::int64_t missing_between(std::uint64_t before, std::uint64_t after) {
  const auto place = [](std::uint64_t id) { return static_cast<std::int64_t>(id) - 1; };
  constexpr std::int64_t kIds = 65535;
  return (place(after) - place(before) + kIds) % kIds - 1;
}

/// Every frame between the first and the last that came was sent, once, and came as it was sent
/// or damaged, or is missed by the gaps in the ids.
struct Reckoning {
  std::int64_t whole = 0;
  std::int64_t damaged = 0;
  std::int64_t missing = 0;
};

Reckoning reckon(const std::vector<Received>& received, const SimulatedCameraProcess& camera) {
  Reckoning out;
  const auto& sent = camera.sent();
  std::map<std::uint64_t, SentRow> by_id;
  for (const auto& [stamp_ns, row] : sent) by_id[row.camera_id] = row;
  std::set<std::uint64_t> seen;
  for (std::size_t i = 0; i < received.size(); ++i) {
    const Received& frame = received[i];
    const std::uint64_t id = frame.label.camera_id;
    EXPECT_TRUE(seen.insert(id).second) << "twice: " << id;
    if (i > 0) out.missing += missing_between(received[i - 1].label.camera_id, id);
    const auto row = by_id.find(id);
    if (row == by_id.end()) {
      ADD_FAILURE() << "never sent: " << id;
      continue;
    }
    if (frame.label.camera_ns) {
      EXPECT_EQ(*frame.label.camera_ns, row->second.stamp_ns) << id;
    } else {
      EXPECT_TRUE(frame.label.damaged) << id;
    }
    if (frame.label.damaged) {
      ++out.damaged;
    } else {
      ++out.whole;
      EXPECT_EQ(frame.checksum, row->second.checksum) << "other pixels than sent: " << id;
    }
  }
  if (received.empty()) return out;
  const auto first = sent.find(by_id[received.front().label.camera_id].stamp_ns);
  const auto last = sent.find(by_id[received.back().label.camera_id].stamp_ns);
  EXPECT_EQ(out.whole + out.damaged + out.missing, std::distance(first, last) + 1);
  return out;
}

class GenicamLive : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    if (const std::string why = test::enter_own_network(); !why.empty())
      std::printf("shared loopback, %s\n", why.c_str());
  }

  /// Null, and the test skipped, where this machine has no loopback to listen on.
  std::unique_ptr<SimulatedCameraProcess> start(std::vector<std::string> args) {
    args.insert(args.end(), {"--loop-frames", "40"});
    auto camera = std::make_unique<SimulatedCameraProcess>(LSV_SIMULATOR, args);
    if (camera->is_ready()) return camera;
    if (camera->messages().find("no camera can be at") == std::string::npos)
      ADD_FAILURE() << camera->messages();
    why_not_ = camera->messages();
    return nullptr;
  }

  std::string why_not_;
};

#define START_CAMERA(camera, ...)                    \
  const auto camera = start(__VA_ARGS__);            \
  if ((camera) == nullptr) GTEST_SKIP() << why_not_; \
  static_assert(true)

TEST_F(GenicamLive, EveryFrameSentIsReceivedOrCounted) {
  START_CAMERA(camera, {"--rate-hz", "250", "--size", "128x128"});
  auto source = open_genicam(kAddress, {});
  ASSERT_TRUE(source) << source.error().message;
  const LiveSourceInfo info = source.value()->info();
  EXPECT_EQ(info.format, (FrameFormat{.width_px = 128, .height_px = 128}));
  EXPECT_EQ(info.period_ns, 4 * kMs);
  EXPECT_EQ(info.id_bits, 16);
  EXPECT_TRUE(info.id_skips_zero);
  EXPECT_EQ(info.description, "GenICam camera Aravis Fake LSV01 at 127.0.0.1");

  const std::int64_t before_ns = Clock::now().time_since_epoch().count();
  const std::vector<Received> received = receive(*source.value(), 3.0);
  const std::int64_t after_ns = Clock::now().time_since_epoch().count();
  source.value().reset();
  camera->finish();

  const Reckoning out = reckon(received, *camera);
  std::printf("%zu sent; %lld whole, %lld damaged, %lld missing; simulator: %s\n",
              camera->sent().size(), static_cast<long long>(out.whole),
              static_cast<long long>(out.damaged), static_cast<long long>(out.missing),
              camera->printed().c_str());
  EXPECT_GT(out.whole, 0);
  // The camera of Aravis begins near the end of the ids on purpose.
  ASSERT_FALSE(received.empty());
  EXPECT_GT(received.front().label.camera_id, 60000U);
  EXPECT_LT(received.back().label.camera_id, 60000U) << "too slow to see the ids wrap";
  std::int64_t last_arrival_ns = before_ns - kNsPerS;  // frames before the first grab
  for (const Received& frame : received) {
    EXPECT_EQ(frame.format, info.format);
    EXPECT_GE(frame.label.arrival_ns, last_arrival_ns - 10 * kMs);
    EXPECT_LE(frame.label.arrival_ns, after_ns);
    last_arrival_ns = frame.label.arrival_ns;
  }
  const auto summary = nlohmann::json::parse(camera->printed());
  EXPECT_EQ(summary["frames_sent"].get<std::size_t>(), camera->sent().size());
}

TEST_F(GenicamLive, LostPacketsAreNeverSilent) {
  START_CAMERA(camera, {"--rate-hz", "250", "--packet-loss", "20", "--seed", "3"});
  auto source = open_genicam(kAddress, {});
  ASSERT_TRUE(source) << source.error().message;
  const std::vector<Received> received = receive(*source.value(), 2.0);
  const std::int64_t losses = source.value()->transport_losses();
  source.value().reset();
  camera->finish();

  const Reckoning out = reckon(received, *camera);
  std::printf("%zu sent; %lld whole, %lld damaged, %lld missing, %lld packets lost\n",
              camera->sent().size(), static_cast<long long>(out.whole),
              static_cast<long long>(out.damaged), static_cast<long long>(out.missing),
              static_cast<long long>(losses));
  EXPECT_GT(out.whole, 0);
  EXPECT_GT(out.damaged, 0);
  EXPECT_GT(losses, 0);
}

TEST_F(GenicamLive, SixteenBitPixelsOfARegionComeAsTheyWere) {
  START_CAMERA(camera, {"--rate-hz", "100", "--bit-depth", "12", "--size", "64x48"});
  CameraOptions options;
  options.region = Roi{.x_px = 8, .y_px = 4, .width_px = 40, .height_px = 24};
  options.pixel_format = "Mono16";
  options.rate_hz = 200.0;
  options.exposure_s = 0.0002;
  options.packet_size_bytes = 500;
  auto source = open_genicam(kAddress, options);
  ASSERT_TRUE(source) << source.error().message;
  EXPECT_EQ(source.value()->info().period_ns, 5 * kMs);
  const std::vector<Received> received = receive(*source.value(), 0.3);
  source.value().reset();
  camera->finish();
  const Reckoning out = reckon(received, *camera);
  EXPECT_GT(out.whole, 0);
  for (const Received& frame : received) {
    EXPECT_EQ(
        frame.format,
        (FrameFormat{.width_px = 40, .height_px = 24, .type = PixelType::mono16, .bit_depth = 16}));
  }
}

TEST_F(GenicamLive, ACameraThatGoesAwayIsNoticedAndOpenedAnew) {
  START_CAMERA(camera, {"--rate-hz", "250", "--unplug-after-s", "0.5", "--unplug-for-s", "1.5"});
  auto source = open_genicam(kAddress, {});
  ASSERT_TRUE(source) << source.error().message;
  Frame frame;
  FrameLabel label;
  auto last_frame = Clock::now();
  std::int64_t frames = 0;
  bool noticed = false;
  Result<Grab> got = Grab::frame;
  for (const auto start = Clock::now(); seconds_since(start) < 60.0;) {
    got = source.value()->grab(frame, label, 100 * kMs);
    if (!got) break;
    if (got.value() == Grab::frame) {
      noticed = false;
      ++frames;
      last_frame = Clock::now();
    } else if (!noticed) {
      noticed = true;
      // 100 ms is the time-out asked for; a busy machine may take longer to wake up.
      EXPECT_LT(seconds_since(last_frame), 2.0);
    }
  }
  EXPECT_GT(frames, 0);
  EXPECT_TRUE(noticed);
  ASSERT_FALSE(got);
  EXPECT_NE(got.error().message.find("genicam:127.0.0.1: the camera has sent nothing for"),
            std::string::npos)
      << got.error().message;
  const auto closing = Clock::now();
  source.value().reset();
  EXPECT_LT(seconds_since(closing), 2.0) << "a camera that is gone holds its program up";

  std::int64_t refused = 0;
  std::vector<Received> again;
  for (const auto start = Clock::now(); again.empty() && seconds_since(start) < 60.0;) {
    auto opened = open_genicam(kAddress, {});
    if (opened) {
      again = receive(*opened.value(), 0.3);
    } else {
      ++refused;
      EXPECT_NE(opened.error().message.find("no camera answers at 127.0.0.1"), std::string::npos)
          << opened.error().message;
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  }
  camera->finish();
  EXPECT_GT(refused, 0);
  EXPECT_GT(reckon(again, *camera).whole, 0);
}

TEST_F(GenicamLive, AKilledCameraHoldsNobodyUp) {
  START_CAMERA(camera, {"--rate-hz", "100"});
  auto source = open_genicam(kAddress, {});
  ASSERT_TRUE(source) << source.error().message;
  EXPECT_FALSE(receive(*source.value(), 0.2).empty());
  camera->kill();
  const auto closing = Clock::now();
  source.value().reset();
  // Aravis alone takes 12 s here.
  EXPECT_LT(seconds_since(closing), 2.0);
}

TEST_F(GenicamLive, ASecondProgramIsRefusedAndDisturbsNothing) {
  START_CAMERA(camera, {"--rate-hz", "100"});
  auto first = open_genicam(kAddress, {});
  ASSERT_TRUE(first) << first.error().message;
  EXPECT_EQ(probe_gige(kAddress), GigeAnswer::controlled);
  auto second = open_genicam(kAddress, {});
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().code, ErrorCode::bad_input);
  EXPECT_NE(second.error().message.find("genicam:127.0.0.1: another program controls"),
            std::string::npos)
      << second.error().message;
  const std::vector<Received> received = receive(*first.value(), 0.3);
  first.value().reset();
  EXPECT_EQ(probe_gige(kAddress), GigeAnswer::free);
  camera->finish();
  EXPECT_GT(reckon(received, *camera).whole, 0);
}

TEST_F(GenicamLive, StopEndsAWaitSoon) {
  START_CAMERA(camera, {"--rate-hz", "0.1"});
  auto source = open_genicam(kAddress, {});
  ASSERT_TRUE(source) << source.error().message;
  Frame frame;
  FrameLabel label;
  // The camera sends its first frame at once, or one of the grid; none follows for 10 s.
  while (source.value()->grab(frame, label, 200 * kMs).value() == Grab::frame) {
  }
  const auto start = Clock::now();
  std::thread stopper([&source] {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    source.value()->stop();
  });
  const Result<Grab> got = source.value()->grab(frame, label, 9 * kNsPerS);
  stopper.join();
  ASSERT_TRUE(got);
  EXPECT_EQ(got.value(), Grab::nothing);
  EXPECT_LT(seconds_since(start), 2.0);
}

TEST_F(GenicamLive, WhatTheCameraCannotDoIsRefusedByName) {
  START_CAMERA(camera, {"--size", "64x64"});
  const auto refusal = [](const CameraOptions& options) {
    auto source = open_genicam(kAddress, options);
    return source ? "opened" : source.error().message;
  };
  CameraOptions region;
  region.region = Roi{.x_px = 0, .y_px = 0, .width_px = 65, .height_px = 64};
  EXPECT_EQ(refusal(region),
            "genicam:127.0.0.1: the region 65x64 at (0, 0) is not inside the sensor of 64x64 px");
  CameraOptions rate;
  rate.rate_hz = 2000.0;
  EXPECT_NE(refusal(rate).find("genicam:127.0.0.1: AcquisitionFrameRate is 1000 Hz where 2000 Hz"),
            std::string::npos)
      << refusal(rate);
  CameraOptions packed;
  packed.pixel_format = "Mono12Packed";
  EXPECT_EQ(refusal(packed),
            "genicam:127.0.0.1: the pixel format is Mono12Packed but lsv reads Mono8, Mono10, "
            "Mono12, Mono14 and Mono16");
  CameraOptions deep;
  deep.pixel_format = "Mono12";
  EXPECT_NE(refusal(deep).find("genicam:127.0.0.1: PixelFormat cannot be set to Mono12"),
            std::string::npos)
      << refusal(deep);
  CameraOptions spinning;
  spinning.packet_timeout_ns = kMs / 2;
  EXPECT_NE(refusal(spinning).find("packet time-out must be between 1 ms"), std::string::npos);
  CameraOptions buffers;
  buffers.buffers = 1;
  EXPECT_NE(refusal(buffers).find("number of buffers is 1"), std::string::npos);
}

TEST_F(GenicamLive, ASilentAddressIsRefusedSoon) {
  const auto start = Clock::now();
  auto source = open_genicam("127.0.0.1", {});
  ASSERT_FALSE(source);
  EXPECT_NE(source.error().message.find("no camera answers at 127.0.0.1"), std::string::npos)
      << source.error().message;
  // Aravis alone takes 2.5 s here.
  EXPECT_LT(seconds_since(start), 2.0);
}

TEST_F(GenicamLive, CamerasAreFoundByNameToo) {
  START_CAMERA(camera, {"--serial", "LSV77"});
  const auto cameras = list_genicam_cameras();
  ASSERT_EQ(cameras.size(), 1U);
  EXPECT_EQ(cameras[0].id, "Aravis-Fake-LSV77");
  EXPECT_EQ(cameras[0].address, "127.0.0.1");
  EXPECT_EQ(cameras[0].protocol, "GigEVision");
  const test::ProgramResult listed = test::run_program({LSV_PROGRAM, "info", "genicam:"});
  EXPECT_EQ(listed.out, "genicam:Aravis-Fake-LSV77  Aravis Fake LSV77, GigEVision, 127.0.0.1\n");
  auto source = open_genicam("LSV77", {});
  EXPECT_TRUE(source) << source.error().message;
  auto other = open_genicam("LSV78", {});
  ASSERT_FALSE(other);
  EXPECT_EQ(other.error().message,
            "genicam:LSV78: there is no such camera; these answer: Aravis-Fake-LSV77 at 127.0.0.1");
}

TEST_F(GenicamLive, TheSimulatorIsPartOfLsvAndStopsWhenAsked) {
  SimulatedCameraProcess camera(LSV_PROGRAM, {"simulate", "camera", "--size", "32x32"});
  if (!camera.is_ready()) {
    // Only where another program holds the address; a simulator that fails is a failure.
    ASSERT_NE(camera.messages().find("no camera can be at"), std::string::npos)
        << camera.messages();
    GTEST_SKIP() << camera.messages();
  }
  EXPECT_NE(camera.messages().find("lsv: camera LSV01 is ready at 127.0.0.1: 32x32 px, 250 Hz"),
            std::string::npos)
      << camera.messages();
  camera.finish();
  EXPECT_EQ(camera.exit_code(), 0);
  EXPECT_LT(camera.stopped_after_s(), 2.0);
  EXPECT_EQ(nlohmann::json::parse(camera.printed())["frames_sent"], 0);
  EXPECT_TRUE(camera.sent().empty());
}

TEST_F(GenicamLive, TheSimulatorRefusesWhatCannotBe) {
  const auto refusal = [](std::vector<std::string> args) {
    args.insert(args.begin(), LSV_SIMULATOR);
    const test::ProgramResult result = test::run_program(args);
    EXPECT_EQ(result.exit_code, 2) << result.err;
    return result.err;
  };
  EXPECT_NE(refusal({"--jitter-us", "3000"}).find("half a period"), std::string::npos);
  EXPECT_NE(refusal({"--packet-loss", "1001"}).find("--packet-loss"), std::string::npos);
  EXPECT_NE(refusal({"--profile", "dance"}).find("\"dance\""), std::string::npos);
  EXPECT_NE(refusal({"--address", "203.0.113.1", "--loop-frames", "2"})
                .find("no camera can be at 203.0.113.1"),
            std::string::npos);
}

}  // namespace
}  // namespace lsv
