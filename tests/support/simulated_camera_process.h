// SPDX-License-Identifier: BSD-3-Clause
// `lsv simulate camera` as a process of its own, and what it says that it sent.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace lsv::test {

struct SentRow {
  std::uint64_t camera_id = 0;
  std::int64_t stamp_ns = 0;
  double x_px = 0.0;
  double y_px = 0.0;
  std::uint64_t checksum = 0;
};

class SimulatedCameraProcess {
 public:
  /// Starts it and waits until it is ready; `program` is lsv_camera_simulator or lsv. A directory
  /// of the test keeps the truth.
  SimulatedCameraProcess(const std::string& program, std::vector<std::string> args);
  SimulatedCameraProcess(const SimulatedCameraProcess&) = delete;
  SimulatedCameraProcess& operator=(const SimulatedCameraProcess&) = delete;
  ~SimulatedCameraProcess();

  bool is_ready() const { return ready_; }
  /// What it said on stderr so far.
  const std::string& messages() const { return messages_; }

  /// The cable is pulled: killed without a farewell.
  void kill();
  /// Ctrl-C; then its exit code, what it printed and the truth are known.
  void finish();

  int exit_code() const { return exit_code_; }
  double stopped_after_s() const { return stopped_after_s_; }
  const std::string& printed() const { return printed_; }
  /// By stamp; what was sent first is first.
  const std::map<std::int64_t, SentRow>& sent() const { return sent_; }
  const std::string& truth_path() const { return truth_path_; }

 private:
  void await_ready();
  void read_truth();

  pid_t pid_ = -1;
  int err_ = -1;
  int out_ = -1;
  bool ready_ = false;
  std::string messages_;
  std::string printed_;
  std::string truth_path_;
  int exit_code_ = -1;
  double stopped_after_s_ = 0.0;
  std::map<std::int64_t, SentRow> sent_;
};

}  // namespace lsv::test
