// SPDX-License-Identifier: BSD-3-Clause
// Records a stream to an MCAP file: frames, what the odometer said about each, health and events,
// with the settings that a replay needs. docs/recording.md describes the file.
//
// on_report() swaps the frame into a queue and returns; everything else is done by a thread of the
// recorder's own. What the queue or the disk cannot take is counted and becomes a dropout record.
// A killed process loses nothing that had left the queue (lsv recover); a power cut costs about a
// second.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "lsv/core/result.h"
#include "lsv/mcap/byte_sink.h"
#include "lsv/mcap/chunk_memory.h"
#include "lsv/mcap/compression.h"
#include "lsv/stream/stream_sink.h"

namespace lsv {

namespace mcap {
class TailFile;
}

struct RecorderOptions {
  std::string path{};  // of a file that does not exist
  FrameFormat format{};
  std::string program = "lsv";     // and its version
  std::string source{};            // LiveSourceInfo::description
  std::string config_toml{};       // all settings, resolved
  std::string calibration_toml{};  // the whole file
  /// sensor_maps_tiff() of the maps as the odometer has them, cut to its region; empty without.
  mcap::Bytes sensor_maps_tiff{};
  mcap::Compression compression = mcap::Compression::none;

  /// 0: as many as 64 MiB hold, at least 8 and at most 1024.
  std::size_t queue_frames = 0;
  /// The larger, the smaller the index that is kept until the end: 1 MB an hour at 1000 frames of
  /// 128 x 128 px per second.
  std::size_t chunk_bytes = std::size_t{4} << 20;
  std::int64_t flush_ns = 500'000'000;   // a chunk is written at the latest after this
  std::int64_t sync_ns = 1'000'000'000;  // and outlives a power cut after this
  std::int64_t retry_ns = 1'000'000'000;

  /// Told once when writing fails ("recording_failing") and once when it works again
  /// ("recording_resumed"), on the recorder's thread. Both are also in the recording, once it can
  /// be written.
  std::function<void(const StreamEvent&)> alarm{};
};

class Recorder : public StreamSink {
 public:
  /// output_failed when the file, or FILE.tail beside it, exists or cannot be made.
  static Result<std::unique_ptr<Recorder>> create(const RecorderOptions& options);
  /// The same to `sink`, without a tail: what is in no whole chunk dies with the process.
  static Result<std::unique_ptr<Recorder>> create(const RecorderOptions& options,
                                                  std::unique_ptr<mcap::ByteSink> sink);
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;
  /// close(), its error unheard.
  ~Recorder() override;

  void on_report(const StreamReport& report, Frame& frame) override;
  void on_event(const StreamEvent& event) override;
  void on_health(const HealthSnapshot& health) override;
  std::int64_t frames_dropped() const override;

  /// Writes what is queued and ends the file well. No on_...() may run or follow. When it fails the
  /// tail stays, and lsv recover saves what the disk did not take.
  Result<void> close();

 private:
  class Worker;
  explicit Recorder(std::unique_ptr<Worker> worker);
  static Result<std::unique_ptr<Recorder>> create(const RecorderOptions& options,
                                                  std::unique_ptr<mcap::ByteSink> sink,
                                                  std::unique_ptr<mcap::ChunkMemory> chunk,
                                                  mcap::TailFile* tail);
  std::unique_ptr<Worker> worker_;
};

}  // namespace lsv
