// SPDX-License-Identifier: BSD-3-Clause
// Broken, lying and surprising input files, each with what is wrong about it. The same set serves
// the library tests and the tests of the program.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tests/support/test_images.h"

namespace lsv::test {

enum class HostileRole { frames, timestamps, calibration };

struct HostileFile {
  std::filesystem::path path;
  std::string what;
  std::vector<std::string> args;  // for the command line, e.g. {"--raw", "64x64:mono8"}
  HostileRole role = HostileRole::frames;
  bool valid = false;      // looks odd but must be accepted
  bool bad_usage = false;  // what is wrong was typed: exit code 2, and the file is not to blame
};

/// Writes the whole set into `folder`, which exists and is empty.
std::vector<HostileFile> write_hostile_set(const std::filesystem::path& folder);

struct Seed {
  std::string name;  // with the extension of its format
  Bytes bytes;
  bool exact = true;  // false: decoding does not give back `image` bit for bit
  TestImage image;
};

/// One small valid file of every kind that lsv reads.
std::vector<Seed> image_seeds(const std::filesystem::path& scratch_folder);

/// A calibration file as it should be.
std::string valid_calibration();

}  // namespace lsv::test
