// SPDX-License-Identifier: BSD-3-Clause
// lsv convert: what the HDF5 file holds, read with the HDF5 library itself.
#include <gtest/gtest.h>
#include <hdf5.h>

#include <cmath>
#include <filesystem>

#include "lsv/record/recorder.h"
#include "tests/lsv/mcap/file_limit.h"
#include "tests/lsv/mcap/scratch.h"
#include "tests/lsv/record/recorded_stream.h"
#include "tests/support/run_program.h"
#include "tests/tools/run_lsv.h"

namespace lsv {
namespace {

using test::lsv_run;
using test::ProgramResult;

constexpr std::int64_t kFrames = 1100;  // more than are written at once

void write_recording(const std::string& path) {
  RecorderOptions options = test::recorder_options(path);
  options.queue_frames = kFrames;
  auto recorder = Recorder::create(options).value();
  Frame frame;
  for (std::int64_t index = 0; index < kFrames; ++index) test::push(*recorder, index, frame);
  ASSERT_TRUE(recorder->close().ok());
}

class Hdf5File {
 public:
  explicit Hdf5File(const std::string& path)
      : id_(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT)) {}
  Hdf5File(const Hdf5File&) = delete;
  Hdf5File& operator=(const Hdf5File&) = delete;
  ~Hdf5File() { H5Fclose(id_); }

  std::vector<hsize_t> shape(const char* name) const {
    const hid_t dataset = H5Dopen2(id_, name, H5P_DEFAULT);
    const hid_t space = H5Dget_space(dataset);
    std::vector<hsize_t> out(static_cast<std::size_t>(H5Sget_simple_extent_ndims(space)));
    H5Sget_simple_extent_dims(space, out.data(), nullptr);
    H5Sclose(space);
    H5Dclose(dataset);
    return out;
  }

  template <typename T>
  std::vector<T> read(const char* name, hid_t type) const {
    hsize_t count = 1;
    for (const hsize_t side : shape(name)) count *= side;
    std::vector<T> out(count);
    const hid_t dataset = H5Dopen2(id_, name, H5P_DEFAULT);
    EXPECT_GE(H5Dread(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, out.data()), 0) << name;
    H5Dclose(dataset);
    return out;
  }

  std::string attribute(const char* object, const char* name) const {
    const hid_t attribute = H5Aopen_by_name(id_, object, name, H5P_DEFAULT, H5P_DEFAULT);
    const hid_t type = H5Aget_type(attribute);
    std::string text(H5Tget_size(type), '\0');
    H5Aread(attribute, type, text.data());
    H5Tclose(type);
    H5Aclose(attribute);
    return text.c_str();
  }

  /// The word of a number of an enumeration.
  std::string word(const char* name, int value) const {
    const hid_t dataset = H5Dopen2(id_, name, H5P_DEFAULT);
    const hid_t type = H5Dget_type(dataset);
    const auto number = static_cast<std::uint8_t>(value);
    char text[40] = {};
    H5Tenum_nameof(type, &number, text, sizeof text);
    H5Tclose(type);
    H5Dclose(dataset);
    return text;
  }

 private:
  hid_t id_;
};

TEST(Convert, HoldsFramesStepsUnitsAndSettings) {
  const test::Scratch scratch;
  write_recording(scratch.file("rec.mcap"));
  const std::string path = scratch.file("rec.h5");
  const ProgramResult converted = lsv_run({"convert", scratch.file("rec.mcap"), path});
  ASSERT_EQ(converted.exit_code, 0) << converted.err;
  const Hdf5File file(path);
  EXPECT_EQ(file.shape("frames"), (std::vector<hsize_t>{kFrames, 5, 9}));
  const auto pixels = file.read<std::uint8_t>("frames", H5T_NATIVE_UINT8);
  const auto index = file.read<std::int64_t>("index", H5T_NATIVE_INT64);
  const auto stamp_ns = file.read<std::int64_t>("stamp_ns", H5T_NATIVE_INT64);
  const auto dx_px = file.read<double>("dx_px", H5T_NATIVE_DOUBLE);
  const auto dy_px = file.read<double>("dy_px", H5T_NATIVE_DOUBLE);
  const auto y_m = file.read<double>("y_m", H5T_NATIVE_DOUBLE);
  const auto status = file.read<std::uint8_t>("status", H5T_NATIVE_UINT8);
  ASSERT_EQ(dx_px.size(), static_cast<std::size_t>(kFrames));
  for (std::int64_t i = 0; i < kFrames; ++i) {
    const auto at = static_cast<std::size_t>(i);
    ASSERT_EQ(index[at], i);
    ASSERT_EQ(stamp_ns[at], 1'000'000 * i);
    ASSERT_EQ(dx_px[at], 0.1 * static_cast<double>(i));
    ASSERT_TRUE(std::isnan(dy_px[at]));
    ASSERT_EQ(y_m[at], -1e-6);
    ASSERT_EQ(pixels[at * 45 + 2 * 9 + 4], test::pixel(i, 4, 2));
  }
  EXPECT_EQ(file.word("status", status[2]), "ok");
  EXPECT_EQ(file.word("status", status[3]), "dark");
  EXPECT_EQ(file.attribute("dx_px", "units"), "px");
  EXPECT_EQ(file.attribute("cov_xx_px2", "units"), "px^2");
  EXPECT_EQ(file.attribute("vx_m_s", "units"), "m/s");
  EXPECT_EQ(file.attribute("stamp_ns", "units"), "ns");
  EXPECT_EQ(file.attribute("q", "units"), "1");
  EXPECT_EQ(file.attribute("/", "config.toml"), "preset = \"precise\"\n");
  EXPECT_EQ(file.attribute("/", "source"), "made up");
}

TEST(Convert, OverwritesNothingAndLeavesNothingOfAFailure) {
  const test::Scratch scratch;
  write_recording(scratch.file("rec.mcap"));
  const std::string path = scratch.file("rec.h5");
  test::write_bytes(path, mcap::Bytes(3));
  EXPECT_EQ(lsv_run({"convert", scratch.file("rec.mcap"), path}).exit_code, 1);
  EXPECT_EQ(test::file_bytes(path).size(), 3U);
  EXPECT_EQ(lsv_run({"convert", scratch.file("rec.mcap"), scratch.file("no/x.h5")}).exit_code, 1);
  mcap::Bytes bytes = test::file_bytes(scratch.file("rec.mcap"));
  bytes[bytes.size() / 2] ^= std::byte{1};
  test::write_bytes(scratch.file("bad.mcap"), bytes);
  const ProgramResult bad = lsv_run({"convert", scratch.file("bad.mcap"), scratch.file("bad.h5")});
  EXPECT_EQ(bad.exit_code, 3);
  EXPECT_FALSE(std::filesystem::exists(scratch.file("bad.h5")));
}

TEST(Convert, SaysThatTheDiskIsFullWhereverThatHappens) {
  const test::Scratch scratch;
  write_recording(scratch.file("rec.mcap"));
  for (const rlim_t size_bytes : {1'000U, 5'000U, 20'000U, 60'000U}) {
    const test::FileLimit full(size_bytes);
    const ProgramResult result =
        lsv_run({"convert", "-q", scratch.file("rec.mcap"), scratch.file("rec.h5")});
    EXPECT_EQ(result.exit_code, 1) << size_bytes << ": " << result.err;
    EXPECT_NE(result.err.find("rec.h5: the disk may be full"), std::string::npos) << result.err;
    EXPECT_FALSE(std::filesystem::exists(scratch.file("rec.h5")));
  }
}

TEST(Convert, ShowsAnExample) {
  const ProgramResult help = lsv_run({"convert", "--help"});
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_NE(help.out.find("Example"), std::string::npos);
}

}  // namespace
}  // namespace lsv
