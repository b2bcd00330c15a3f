// SPDX-License-Identifier: BSD-3-Clause
// `lsv simulate camera`: becomes the program lsv_camera_simulator that stands beside this one. It
// is a program of its own because it brings its own g_poll() (camera_simulator/g_poll.cpp), which
// must not be that of the program that measures.
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <string>
#include <system_error>
#include <vector>

#include "tools/commands.h"

namespace lsv::cli {
namespace {

constexpr const char* kProgram = "lsv_camera_simulator";

Error become_simulator(const std::vector<std::string>& words) {
  std::error_code error;
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", error);
  const std::string program = (self.parent_path() / kProgram).string();
  std::vector<char*> argv = {const_cast<char*>(program.c_str())};
  for (const std::string& word : words) argv.push_back(const_cast<char*>(word.c_str()));
  argv.push_back(nullptr);
  ::execv(program.c_str(), argv.data());
  return {ErrorCode::unsupported,
          program + " cannot be run: " + std::strerror(errno) + "; it belongs beside lsv"};
}

}  // namespace

void add_simulate_camera(CLI::App& simulate, int& exit_code) {
  CLI::App* const camera = simulate.add_subcommand(
      "camera", "A GigE Vision camera on the loopback interface that sends laser speckle");
  // Every word, --help as well, is for the simulator.
  camera->set_help_flag();
  camera->prefix_command();
  camera->callback(
      [camera, &exit_code] { exit_code = report_error(become_simulator(camera->remaining())); });
}

}  // namespace lsv::cli
