// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/hostile_files.h"

#include <algorithm>

namespace lsv::test {
namespace {

namespace fs = std::filesystem;

class HostileSet {
 public:
  explicit HostileSet(fs::path folder) : folder_(std::move(folder)) {}

  void add(const std::string& name, const Bytes& bytes, const std::string& what,
           std::vector<std::string> args = {}, HostileRole role = HostileRole::frames,
           bool valid = false) {
    const fs::path path = folder_ / name;
    write_bytes(path, bytes);
    files_.push_back({path, what, std::move(args), role, valid, false});
  }

  /// The one added last is a mistake on the command line, not in the file.
  void last_is_bad_usage() { files_.back().bad_usage = true; }

  void add_text(const std::string& name, const std::string& text, const std::string& what,
                HostileRole role, bool valid = false) {
    add(name, bytes_of(text), what, {}, role, valid);
  }

  const fs::path& folder() const { return folder_; }
  std::vector<HostileFile> take() { return std::move(files_); }

 private:
  fs::path folder_;
  std::vector<HostileFile> files_;
};

std::string with_extension(const std::string& name, const std::string& stem) {
  return stem + fs::path(name).extension().string();
}

void add_cut_images(HostileSet& set) {
  for (const Seed& seed : image_seeds(set.folder())) {
    for (const int percent : {0, 1, 10, 50, 90}) {
      const std::size_t keep = seed.bytes.size() * static_cast<std::size_t>(percent) / 100;
      const Bytes cut(seed.bytes.begin(), seed.bytes.begin() + static_cast<std::ptrdiff_t>(keep));
      set.add(with_extension(seed.name, "cut_" + std::to_string(percent) + "_" +
                                            fs::path(seed.name).stem().string()),
              cut, "cut to " + std::to_string(percent) + " % of its length");
    }
  }
}

void add_wrong_names(HostileSet& set) {
  const TestImage image = random_image(8, 8, 1);
  const Bytes png = encode_png(image);
  const Bytes pgm = encode_pgm(image, 255);
  for (const char* name :
       {"is_png.pgm", "is_png.tif", "is_png.bmp", "is_png.jpg", "is_png.avi", "is_png.mcap"})
    set.add(name, png, "a PNG under another name");
  set.add("is_pgm.png", pgm, "a PGM under another name");
  set.add("text.png", bytes_of("hello\n"), "text named PNG");
  set.add("unknown.xyz", png, "an extension that lsv does not know");
}

void add_lying_png(HostileSet& set) {
  const Bytes row(9, 0);
  set.add("png_65535.png", png_with_header(65535, 65535, 8, 0, 0, row), "declares 65535 x 65535");
  set.add("png_large.png", png_with_header(8000, 8000, 8, 0, 0, row), "declares 8000 x 8000");
  set.add("png_max.png", png_with_header(0x7FFFFFFF, 0x7FFFFFFF, 16, 6, 0, row), "declares 2^31");
  set.add("png_zero_width.png", png_with_header(0, 8, 8, 0, 0, row), "zero width");
  set.add("png_zero_height.png", png_with_header(8, 0, 8, 0, 0, row), "zero height");
  set.add("png_short.png", png_with_header(8, 8, 8, 0, 0, row), "one row where 8 are declared");
  set.add("png_1_bit.png", png_with_header(8, 1, 1, 0, 0, {0, 0xFF}), "1-bit pixels");
  set.add("png_bad_type.png", png_with_header(8, 1, 8, 5, 0, row), "colour type 5");
  set.add("png_text_bomb.png",
          encode_png(random_image(8, 8, 2), {.hidden_text_bytes = std::size_t{64} << 20}),
          "64 MiB of text packed small");
  set.add("png_unscaled_sbit.png",
          encode_png(random_image(8, 8, 3, 4095), {.significant_bits = 12}),
          "sBIT says 12 but the pixels are not scaled");
  Bytes damaged = encode_png(random_image(32, 32, 4));
  damaged[damaged.size() / 2] ^= 0x10U;
  set.add("png_checksum.png", damaged, "a flipped bit under a checksum");
}

void add_lying_pgm(HostileSet& set) {
  const auto add = [&](const char* name, const std::string& text, const char* what) {
    set.add(name, bytes_of(text), what);
  };
  const std::string pixels(64, '\x20');
  add("pgm_65535.pgm", "P5\n65535 65535\n255\n" + pixels, "declares 65535 x 65535");
  add("pgm_zero.pgm", "P5\n0 8\n255\n" + pixels, "zero width");
  add("pgm_negative.pgm", "P5\n-8 8\n255\n" + pixels, "negative width");
  add("pgm_huge_number.pgm", "P5\n99999999999999999999 8\n255\n" + pixels, "a 20-digit width");
  add("pgm_maxval_0.pgm", "P5\n8 8\n0\n" + pixels, "maxval 0");
  add("pgm_maxval_65536.pgm", "P5\n8 8\n65536\n" + pixels, "maxval 65536");
  add("pgm_above_maxval.pgm", "P5\n8 8\n15\n" + pixels, "pixels above maxval");
  add("pgm_extra.pgm", "P5\n8 8\n255\n" + pixels + "more", "bytes after the pixels");
  add("pgm_endless_comment.pgm", "P5\n#" + std::string(100'000, 'x'), "a comment without end");
  add("pgm_text_junk.pgm", "P2\n2 2\n255\n1 2 x 4\n", "a letter among the pixels");
  add("pgm_text_large.pgm", "P2\n2 2\n255\n1 2 256 4\n", "a text pixel above maxval");
  add("pgm_text_extra.pgm", "P2\n2 2\n255\n1 2 3 4 5\n", "one text pixel too many");
  add("pgm_colour.pgm", "P6\n8 8\n255\n" + pixels, "a PPM named PGM");
}

void put_little_endian(Bytes& bytes, std::size_t at, std::uint32_t value) {
  for (std::size_t i = 0; i < 4; ++i) bytes[at + i] = static_cast<std::uint8_t>(value >> (8 * i));
}

void add_lying_bmp(HostileSet& set) {
  const Bytes good = encode_bmp(random_image(8, 8, 5));
  const auto add = [&](const char* name, std::size_t at, std::uint32_t value, const char* what) {
    Bytes bytes = good;
    put_little_endian(bytes, at, value);
    set.add(name, bytes, what);
  };
  add("bmp_pixels_outside.bmp", 10, 0xFFFFFFFFU, "pixels far behind the end");
  add("bmp_header_size.bmp", 14, 12, "a header of another kind");
  add("bmp_65535.bmp", 18, 65535, "65535 columns");
  add("bmp_negative_width.bmp", 18, 0xFFFFFFF8U, "negative width");
  add("bmp_zero.bmp", 22, 0, "zero height");
  add("bmp_min_height.bmp", 22, 0x80000000U, "height -2^31");
  add("bmp_rle.bmp", 30, 1, "RLE compression");
  add("bmp_palette.bmp", 46, 0xFFFFFFFFU, "2^32 palette entries");
  add("bmp_bits.bmp", 28, 3, "3 bits per pixel");
}

void add_lying_jpeg(HostileSet& set) {
  const Bytes good = encode_jpeg(random_image(16, 16, 6));
  Bytes large = good;
  for (std::size_t i = 0; i + 8 < large.size(); ++i) {
    if (large[i] != 0xFF || large[i + 1] != 0xC0) continue;
    for (std::size_t at = i + 5; at < i + 9; ++at) large[at] = 0xFF;  // height, width
    break;
  }
  set.add("jpeg_65535.jpg", large, "declares 65535 x 65535");
  Bytes blank(200'000, 0xFF);
  std::copy_n(good.begin(), 20, blank.begin());
  set.add("jpeg_markers.jpg", blank, "nothing but fill bytes");
}

void add_lying_tiff(HostileSet& set) {
  const auto add = [&](const char* name, const HandmadeTiff& tiff, const char* what) {
    set.add(name, encode(tiff), what);
  };
  add("tiff_loop_self.tif", {.last_next = page_offset(0)}, "the page chain bites its tail");
  add("tiff_loop_long.tif", {.pages = 5, .last_next = page_offset(1)}, "a loop of 4 pages");
  add("tiff_next_outside.tif", {.last_next = 0x7FFFFFF0U}, "the next page is behind the end");
  add("tiff_next_inside_pixels.tif", {.last_next = page_offset(1)}, "the next page is pixels");
  add("tiff_65535.tif", {.width = 65535, .height = 65535}, "declares 65535 x 65535");
  add("tiff_large.tif", {.width = 8000, .height = 8000}, "declares 8000 x 8000");
  add("tiff_zero.tif", {.width = 0}, "zero width");
  add("tiff_strip_short.tif", {.strip_bytes = 10, .stored_bytes = 10},
      "a strip of 10 bytes for 64 pixels");
  add("tiff_strip_zero.tif", {.strip_bytes = 0, .stored_bytes = 0}, "a strip of 0 bytes");
  add("tiff_strip_huge.tif", {.width = 64, .height = 64, .strip_bytes = 0xFFFFFFFFU},
      "a strip of 4 GB");
  Bytes claimed = encode({.pages = 10'000});
  claimed.resize(page_offset(20));
  set.add("tiff_10000_pages_cut.tif", claimed, "10,000 pages of which 20 are there");

  const auto refused = [&](const char* name, const TestImage& image, const TiffLayout& layout,
                           const char* what) {
    write_tiff(set.folder() / name, {image}, layout);
    set.add(name, read_bytes(set.folder() / name), what);
  };
  refused("tiff_white_is_zero.tif", random_image(8, 8, 7), {.photometric = 0}, "MinIsWhite");
  refused("tiff_signed.tif", random_image(8, 8, 8, 4095), {.sample_format = 2}, "signed pixels");
  refused("tiff_rgb.tif", random_image(8, 8, 9, 255, 3), {}, "RGB");
  refused("tiff_flipped.tif", random_image(8, 8, 10), {.orientation = 4}, "bottom row first");
}

void add_lying_raw(HostileSet& set) {
  const Bytes frame_and_a_half(6144, 7);
  const auto add = [&](const char* name, const char* format, const char* what) {
    set.add(name, frame_and_a_half, what, {"--raw", format});
  };
  add("half_frame.raw", "64x64:mono8", "one frame and a half");
  add("header.raw", "64x64:mono8:100000", "a header longer than the file");
  add("depth.raw", "64x48:mono10", "words above 10 bits");
  add("zero.raw", "0x64:mono8", "no columns");
  set.last_is_bad_usage();
  add("huge.raw", "65535x65535:mono16", "65535 x 65535");
  set.last_is_bad_usage();
  add("word.raw", "64x48:mono9", "an unknown pixel word");
  set.last_is_bad_usage();
  set.add("no_format.raw", frame_and_a_half, "raw without --raw");
  set.last_is_bad_usage();
  set.add("empty.raw", {}, "no byte at all", {"--raw", "64x64:mono8"});
}

void add_timestamps(HostileSet& set) {
  const auto add = [&](const char* name, const std::string& text, const char* what,
                       bool valid = false) {
    set.add_text(name, text, what, HostileRole::timestamps, valid);
  };
  add("time_empty.csv", "", "empty");
  add("time_no_header.csv", "0.0\n0.1\n", "no header");
  add("time_other_header.csv", "t,frame\n0,0\n", "no time column");
  add("time_both.csv", "time_s,time_ns\n0,0\n", "both time columns");
  add("time_twice.csv", "time_s,time_s\n0,0\n", "the same column twice");
  add("time_no_rows.csv", "time_s\n", "no row");
  add("time_nan.csv", "time_s\n0\nnan\n", "NaN");
  add("time_inf.csv", "time_s\n0\ninf\n", "infinite");
  add("time_back.csv", "time_s\n0\n0.2\n0.1\n", "backwards");
  add("time_equal.csv", "time_s\n0\n0.1\n0.1\n", "equal stamps");
  add("time_huge.csv", "time_s\n0\n1e300\n", "1e300 s");
  add("time_word.csv", "time_s\n0\nsoon\n", "a word");
  add("time_columns.csv", "time_s,frame\n0,0\n0.1\n", "a row with one column less");
  add("time_frame_back.csv", "frame,time_s\n1,0\n0,0.1\n", "frame numbers backwards");
  add("time_binary.csv", std::string("time_s\n\0\1\2\n", 11), "binary zeros");
  add("time_bom_crlf.csv", "\xEF\xBB\xBF# a comment\r\ntime_s\r\n\r\n0\r\n0.1\r\n0.2\r\n0.3\r\n",
      "BOM, CRLF, comment, blank line", true);
}

std::string without(const std::string& text, const std::string& part) {
  std::string out = text;
  out.erase(out.find(part), part.size());
  return out;
}

std::string replaced(const std::string& text, const std::string& part, const std::string& by) {
  std::string out = text;
  out.replace(out.find(part), part.size(), by);
  return out;
}

void add_calibrations(HostileSet& set) {
  const std::string good = valid_calibration();
  const auto add = [&](const char* name, const std::string& text, const char* what,
                       bool valid = false) {
    set.add_text(name, text, what, HostileRole::calibration, valid);
  };
  const std::string pitch = "pixel_pitch_x_m = 3.45e-6";
  const auto pitch_is = [&](const char* value) {
    return replaced(good, pitch, std::string("pixel_pitch_x_m = ") + value);
  };
  add("cal_empty.toml", "", "empty");
  add("cal_unknown_key.toml", good + "colour = 3\n", "an unknown key");
  add("cal_unknown_table.toml", good + "[lens]\nf = 1\n", "an unknown table");
  add("cal_missing_key.toml", without(good, pitch), "a missing key");
  add("cal_missing_schema.toml", without(good, "schema = \"lsv.calibration/1\"\n"), "no schema");
  add("cal_other_schema.toml", replaced(good, "calibration/1", "calibration/9"), "other schema");
  add("cal_nan.toml", pitch_is("nan"), "NaN");
  add("cal_inf.toml", pitch_is("inf"), "infinite");
  add("cal_zero.toml", pitch_is("0.0"), "zero pitch");
  add("cal_negative.toml", pitch_is("-3.45e-6"), "negative pitch");
  add("cal_negative_noise.toml", replaced(good, "noise_sd_counts = 1.5", "noise_sd_counts = -1.5"),
      "negative noise");
  add("cal_text_number.toml", pitch_is("\"3.45e-6\""), "a number in quotes");
  add("cal_overflow.toml", pitch_is("1e999"), "1e999");
  add("cal_array.toml", pitch_is("[3.45e-6]"), "an array for a number");
  add("cal_duplicate.toml", replaced(good, pitch, pitch + "\n" + pitch), "a key twice");
  add("cal_nested.toml", "schema = " + std::string(20'000, '[') + std::string(20'000, ']') + "\n",
      "20,000 brackets deep");
  add("cal_cut.toml", good.substr(0, good.find("sc_x_ratio") + 14), "cut in the middle of a value");
  add("cal_junk.toml", std::string(std::size_t{2} << 20, '\xA5'), "2 MiB of junk");
  add("cal_spaces.toml", good + std::string(std::size_t{2} << 20, ' '), "2 MiB of spaces");
  add(
      "cal_bom_crlf.toml",
      "\xEF\xBB\xBF" +
          [&] {
            std::string text;
            for (const char c : good) text += c == '\n' ? std::string("\r\n") : std::string(1, c);
            return text;
          }(),
      "BOM and CRLF", true);
}

}  // namespace

std::string valid_calibration() {
  return "schema = \"lsv.calibration/1\"\n"
         "[sensor]\n"
         "name = \"bench\"\n"
         "pixel_pitch_x_m = 3.45e-6\n"
         "pixel_pitch_y_m = 3.45e-6\n"
         "sc_x_ratio = 1.25\n"
         "sc_y_ratio = 1.25\n"
         "[camera]\n"
         "noise_mean_counts = 4.0\n"
         "noise_sd_counts = 1.5\n";
}

std::vector<Seed> image_seeds(const fs::path& scratch_folder) {
  const TestImage grey8 = random_image(13, 9, 11);
  const TestImage grey16 = random_image(13, 9, 12, 65535);
  const TestImage grey12 = random_image(13, 9, 13, 4095);
  const TestImage colour = random_image(13, 9, 14, 255, 3);
  std::vector<Seed> seeds = {
      {"grey8.png", encode_png(grey8), true, grey8},
      {"grey16.png", encode_png(grey16), true, grey16},
      {"interlaced.png", encode_interlaced_png(grey8), true, grey8},
      {"colour.png", encode_png(colour), false, colour},
      {"palette.png", encode_palette_png(grey8), false, grey8},
      {"grey8.pgm", encode_pgm(grey8, 255), true, grey8},
      {"grey12.pgm", encode_pgm(grey12, 4095), true, grey12},
      {"text.pgm", encode_pgm(grey12, 4095, true), true, grey12},
      {"grey8.bmp", encode_bmp(grey8), true, grey8},
      {"colour.bmp", encode_bmp(colour), false, colour},
      {"grey8.jpg", encode_jpeg(grey8), false, grey8},
      {"progressive.jpeg", encode_jpeg(grey8, true), false, grey8},
  };
  const auto add_tiff = [&](const char* name, const TestImage& image, const TiffLayout& layout) {
    const fs::path path = scratch_folder / name;
    write_tiff(path, {image}, layout);
    seeds.push_back({name, read_bytes(path), true, image});
    fs::remove(path);
  };
  add_tiff("none.tif", grey8, {});
  add_tiff("lzw.tif", grey16, {.compression = 5, .predictor = 2});
  add_tiff("deflate_big_endian.tif", grey16, {.compression = 8, .mode = "wb"});
  add_tiff("packbits.tiff", grey8, {.compression = 32773});
  add_tiff("tiles.tif", grey8, {.compression = 8, .tile_px = 16});
  add_tiff("bigtiff.tif", grey12, {.max_sample_value = 4095, .mode = "w8"});
  return seeds;
}

std::vector<HostileFile> write_hostile_set(const fs::path& folder) {
  HostileSet set(folder);
  add_cut_images(set);
  add_wrong_names(set);
  add_lying_png(set);
  add_lying_pgm(set);
  add_lying_bmp(set);
  add_lying_jpeg(set);
  add_lying_tiff(set);
  add_lying_raw(set);
  add_timestamps(set);
  add_calibrations(set);
  return set.take();
}

}  // namespace lsv::test
