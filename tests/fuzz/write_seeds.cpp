// SPDX-License-Identifier: BSD-3-Clause
// fuzz_seeds FOLDER: writes a corpus for each fuzz target into FOLDER/<target>/.
#include <algorithm>
#include <cstdio>

#include "calibration/sensor_maps_io.h"
#include "lsv/mcap/tail.h"
#include "tests/lsv/mcap/small_recording.h"
#include "tests/lsv/record/recorded_stream.h"
#include "tests/support/hostile_files.h"

namespace {

namespace fs = std::filesystem;
using lsv::test::Bytes;

/// The first byte of a case of fuzz_image_decode.
std::uint8_t selector(const fs::path& path) {
  const std::string extension = path.extension().string();
  if (extension == ".png") return 0;
  if (extension == ".tif" || extension == ".tiff") return 1;
  if (extension == ".pgm") return 2;
  if (extension == ".bmp") return 3;
  return 4;
}

void write_image(const fs::path& folder, const std::string& name, const Bytes& file) {
  Bytes bytes = {selector(name)};
  bytes.insert(bytes.end(), file.begin(), file.end());
  lsv::test::write_bytes(folder / "image_decode" / name, bytes);
  if (selector(name) == 1) lsv::test::write_bytes(folder / "tiff_stack" / name, file);
}

/// Every way of storing TIFF pixels that lsv reads. The large ones outgrow a block of 4096 bytes,
/// below which AddressSanitizer fills what is allocated.
void write_tiff_layouts(const fs::path& folder, const fs::path& scratch) {
  struct Packing {
    const char* name;
    int compression;
    int predictor;
  };
  constexpr Packing kPackings[] = {
      {"none", 1, 0},         {"lzw", 5, 0},      {"lzw_predictor", 5, 2},     {"deflate", 8, 0},
      {"packbits", 32773, 0}, {"zstd", 50000, 0}, {"zstd_predictor", 50000, 2}};
  const fs::path path = scratch / "layout.tif";
  const auto add = [&](const std::string& name, const lsv::test::TestImage& image,
                       const lsv::test::TiffLayout& layout) {
    lsv::test::write_tiff(path, {image}, layout);
    write_image(folder, name + ".tif", lsv::test::read_bytes(path));
  };
  for (const Packing& packing : kPackings) {
    const std::string name = packing.name;
    const lsv::test::TiffLayout layout{.compression = packing.compression,
                                       .predictor = packing.predictor};
    lsv::test::TiffLayout tiles = layout;
    tiles.tile_px = 16;
    lsv::test::TiffLayout big_endian = layout;
    big_endian.mode = "wb";
    lsv::test::TiffLayout one_strip = layout;
    one_strip.rows_per_strip = 70;
    add(name + "_strips", lsv::test::random_image(9, 7, 1), layout);
    add(name + "_tiles", lsv::test::random_image(19, 17, 2, 65535), tiles);
    add(name + "_big_endian", lsv::test::random_image(9, 7, 3, 65535), big_endian);
    add(name + "_large", lsv::test::random_image(97, 70, 4, 3), one_strip);
  }
}

void write_images(const fs::path& folder, const fs::path& scratch) {
  for (const auto& seed : lsv::test::image_seeds(scratch))
    write_image(folder, seed.name, seed.bytes);
  const auto page = lsv::test::random_image(9, 5, 1);
  lsv::test::write_tiff(scratch / "stack.tif", {page, page, page});
  write_image(folder, "stack.tif", lsv::test::read_bytes(scratch / "stack.tif"));
}

void write_colours(const fs::path& folder) {
  using lsv::test::random_image;
  write_image(folder, "colour.jpg", lsv::test::encode_jpeg(random_image(19, 21, 1, 255, 3)));
  write_image(folder, "colour_progressive.jpg",
              lsv::test::encode_jpeg(random_image(19, 21, 2, 255, 3), true));
  write_image(folder, "large_progressive.jpg",
              lsv::test::encode_jpeg(random_image(75, 83, 3, 63), true));
  write_image(folder, "alpha.png", lsv::test::encode_png(random_image(7, 5, 4, 255, 4)));
  write_image(folder, "alpha.bmp", lsv::test::encode_bmp(random_image(7, 5, 5, 255, 4)));
  write_image(folder, "top_down.bmp", lsv::test::encode_bmp(random_image(7, 5, 6), true));
}

void write_hostile(const fs::path& folder, const fs::path& scratch) {
  constexpr std::uintmax_t kLargest_bytes = 100'000;
  for (const auto& file : lsv::test::write_hostile_set(scratch)) {
    if (fs::file_size(file.path) > kLargest_bytes) continue;
    const Bytes bytes = lsv::test::read_bytes(file.path);
    if (file.role == lsv::test::HostileRole::frames)
      write_image(folder, file.path.filename().string(), bytes);
    if (file.role == lsv::test::HostileRole::timestamps)
      lsv::test::write_bytes(folder / "timestamps" / file.path.filename(), bytes);
    if (file.role == lsv::test::HostileRole::calibration)
      lsv::test::write_bytes(folder / "calibration" / file.path.filename(), bytes);
  }
}

void write_texts(const fs::path& folder) {
  const auto add = [&](const char* target, const char* name, const char* text) {
    lsv::test::write_bytes(folder / target / name, lsv::test::bytes_of(text));
  };
  add("timestamps", "seconds", "time_s\n0\n0.1\n1.5e0\n");
  add("timestamps", "frames", "frame,time_ns\n0,100\n3,200\n");
  add("timestamps", "number", "1700000000.123456789");
  add("csv_table", "track", "# unit: m\nframe,dx_px,status\n1,0.25,ok\n2,,dark\n");
  add("trajectory", "csv",
      "0time_s,x_m,y_m,yaw_rad,cov_xx_m2,cov_xy_m2,cov_yy_m2\n0,1,2,0.5,1,0,1\n1,,,,,,\n");
  add("trajectory", "tum", "1# t x y z\n0.5 1 2 3 0 0 0 1\n1.5 1 2 3 0 0 1 0\n");
  add("trajectory", "kitti", "21 0 0 5 0 1 0 6 0 0 1 7\n0 -1 0 5 1 0 0 6 0 0 1 7\n");
  add("option_text", "raw", "640x480:mono12:1024");
  add("option_text", "roi", "0,0,256,256");
}

void write_sensor_maps(const fs::path& folder) {
  for (const int side_px : {1, 5, 40}) {
    lsv::SensorMaps maps{.width_px = side_px, .height_px = side_px + 2};
    const auto pixels = static_cast<std::size_t>(side_px * (side_px + 2));
    maps.offset_counts.assign(pixels, 15.5F);
    maps.gain_ratio.assign(pixels, 1.02F);
    maps.defect.assign(pixels, 0);
    maps.defect.back() = 1;
    lsv::test::write_bytes(folder / "sensor_maps" / ("maps" + std::to_string(side_px)),
                           lsv::test::bytes_of(lsv::sensor_maps_tiff(maps).value()));
  }
}

Bytes plain_bytes(lsv::mcap::ByteView view) {
  Bytes out(view.size());
  std::ranges::transform(view, out.begin(), [](std::byte b) { return std::uint8_t(b); });
  return out;
}

/// Also without CRCs, which a fuzzer cannot mend.
void write_recordings(const fs::path& folder) {
  using lsv::mcap::Compression;
  for (const Compression compression : {Compression::none, Compression::zstd}) {
    const lsv::mcap::Bytes file = lsv::test::small_file(12, compression);
    const std::string name = compression == Compression::zstd ? "zstd" : "plain";
    lsv::test::write_bytes(folder / "mcap" / name, plain_bytes(file));
    lsv::test::write_bytes(folder / "mcap" / (name + "_no_crc"),
                           plain_bytes(lsv::test::without_crcs(file)));
  }
}

/// As lsv makes them, without the CRCs.
void write_recorded_streams(const fs::path& folder, const fs::path& scratch) {
  for (const lsv::mcap::Compression compression :
       {lsv::mcap::Compression::none, lsv::mcap::Compression::zstd}) {
    const fs::path path = scratch / "stream.mcap";
    fs::remove(path);
    lsv::RecorderOptions options = lsv::test::recorder_options(path.string());
    options.compression = compression;
    auto recorder = lsv::Recorder::create(options).value();
    lsv::Frame frame;
    for (std::int64_t index = 0; index < 3; ++index) lsv::test::push(*recorder, index, frame);
    recorder->on_event(lsv::test::some_event());
    recorder->on_health(lsv::test::some_health());
    static_cast<void>(recorder->close());
    const bool packed = compression == lsv::mcap::Compression::zstd;
    const Bytes bytes = lsv::test::read_bytes(path);
    const auto* const first = reinterpret_cast<const std::byte*>(bytes.data());
    lsv::test::write_bytes(folder / "recording" / (packed ? "zstd" : "plain"),
                           plain_bytes(lsv::test::without_crcs({first, first + bytes.size()})));
  }
}

/// A tail, and the records in it alone.
void write_tails(const fs::path& folder, const fs::path& scratch) {
  const std::string path = (scratch / "rec.mcap.tail").string();
  {
    auto tail = lsv::mcap::TailFile::create(path, 400).value();
    lsv::mcap::TailFile& kept = *tail;
    lsv::test::MemoryDisk disk;
    auto writer = lsv::mcap::Writer::create(std::make_unique<lsv::test::MemorySink>(disk),
                                            std::move(tail), {})
                      .value();
    const auto channel = writer.add_channel(lsv::test::channel("image")).value();
    static_cast<void>(writer.write({.channel = channel}, lsv::mcap::Bytes(20)));
    writer.commit();
    lsv::test::write_bytes(folder / "mcap_tail" / "records", plain_bytes(kept.bytes().first(150)));
  }
  lsv::test::write_bytes(folder / "mcap_tail" / "tail", lsv::test::read_bytes(path));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: fuzz_seeds FOLDER\n", stderr);
    return 2;
  }
  const fs::path folder = argv[1];
  for (const char* target :
       {"image_decode", "tiff_stack", "timestamps", "option_text", "calibration", "csv_table",
        "sensor_maps", "mcap", "mcap_tail", "recording", "trajectory"})
    fs::create_directories(folder / target);
  const fs::path scratch = lsv::test::fresh_folder(folder, "scratch");
  write_images(folder, scratch);
  write_tiff_layouts(folder, scratch);
  write_colours(folder);
  write_hostile(folder, scratch);
  write_texts(folder);
  write_sensor_maps(folder);
  write_recordings(folder);
  write_tails(folder, scratch);
  write_recorded_streams(folder, scratch);
  fs::remove_all(scratch);
  return 0;
}
