// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/ingest/mcap_stream.h"

#include <utility>

namespace lsv {
namespace {

class McapStream : public FrameStream {
 public:
  McapStream(std::string path, RecordingReader reader)
      : path_(std::move(path)), reader_(std::move(reader)) {
    read_ahead();
  }

  std::string description() const override {
    const std::string& topic = reader_.notes().image_topic;
    return topic.empty() ? "MCAP recording" : "MCAP recording, " + topic;
  }
  std::string last_name() const override {
    return last_index_ < 0 ? path_ : path_ + ", frame " + std::to_string(last_index_);
  }
  std::int64_t next_index() const override { return ahead_.frame.index; }
  std::optional<Stamp> own_stamp() const override { return last_stamp_; }

  Result<bool> read(Frame& out) override {
    auto there = pass();
    if (!there || !there.value()) return there;
    std::swap(out, ahead_.frame);
    read_ahead();
    return true;
  }

  Result<bool> skip() override {
    auto there = pass();
    if (there && there.value()) read_ahead();
    return there;
  }

 private:
  void read_ahead() { is_ahead_ = reader_.next(ahead_); }

  Result<bool> pass() {
    if (!is_ahead_ || !is_ahead_.value()) return is_ahead_;
    const std::int64_t index = ahead_.frame.index;
    if (index <= last_index_) {
      return Error{ErrorCode::bad_input, path_ + ": frame " + std::to_string(index) +
                                             " follows frame " + std::to_string(last_index_) +
                                             "; lsv reads recordings of one run"};
    }
    last_index_ = index;
    last_stamp_ = ahead_.frame.stamp;
    return true;
  }

  std::string path_;
  RecordingReader reader_;
  RecordedFrame ahead_;  // the frame to come
  Result<bool> is_ahead_ = false;
  std::int64_t last_index_ = -1;
  std::optional<Stamp> last_stamp_;
};

}  // namespace

Result<std::unique_ptr<FrameStream>> open_mcap_stream(const std::string& path,
                                                      const RecordingOptions& options) {
  Result<RecordingReader> reader = RecordingReader::open(path, options);
  if (!reader) return reader.error();
  return std::unique_ptr<FrameStream>(
      std::make_unique<McapStream>(path, std::move(reader).value()));
}

}  // namespace lsv
