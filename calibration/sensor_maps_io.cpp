// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/sensor_maps_io.h"

#include <tiffio.h>

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <new>
#include <utility>
#include <vector>

#include "calibration/sha256.h"
#include "calibration/text_file.h"

namespace lsv {
namespace {

constexpr int kPages = 3;
constexpr std::uint64_t kBytesPerPixel = kPages * sizeof(float);
// Directories of the pages and what libtiff puts around them.
constexpr std::uint64_t kMetadata_bytes = std::uint64_t{1} << 20;
constexpr std::uint64_t kBigTiffFrom_bytes = 3'500'000'000;
// Beyond these bounds a number is no property of a pixel.
constexpr float kMaxOffset_counts = 65535.0F;
constexpr float kMinGain_ratio = 0.01F;
constexpr float kMaxGain_ratio = 100.0F;

constexpr const char* kPageNames[kPages] = {"offset_counts", "gain_ratio", "defect"};

/// A file in memory, as libtiff's callbacks see it.
struct MemoryFile {
  std::string* written = nullptr;  // null: read only
  std::string_view bytes;          // of a file that is read
  std::uint64_t at = 0;
  std::string complaint;  // libtiff's last error

  std::string_view view() const { return written != nullptr ? std::string_view(*written) : bytes; }
};

MemoryFile& file_of(thandle_t handle) { return *static_cast<MemoryFile*>(handle); }

tmsize_t read_bytes(thandle_t handle, void* to, tmsize_t size) {
  MemoryFile& file = file_of(handle);
  const std::string_view all = file.view();
  if (size <= 0 || file.at >= all.size()) return 0;
  const std::size_t count = std::min(all.size() - file.at, static_cast<std::uint64_t>(size));
  std::memcpy(to, all.data() + file.at, count);
  file.at += count;
  return static_cast<tmsize_t>(count);
}

tmsize_t write_bytes(thandle_t handle, void* from, tmsize_t size) {
  MemoryFile& file = file_of(handle);
  if (file.written == nullptr || size < 0) return 0;
  const auto count = static_cast<std::uint64_t>(size);
  try {
    if (file.at + count > file.written->size()) file.written->resize(file.at + count);
  } catch (const std::bad_alloc&) {  // no exception may cross libtiff
    return 0;
  }
  std::memcpy(file.written->data() + file.at, from, count);
  file.at += count;
  return size;
}

toff_t seek(thandle_t handle, toff_t offset, int whence) {
  MemoryFile& file = file_of(handle);
  if (whence == SEEK_CUR) offset += file.at;
  if (whence == SEEK_END) offset += file.view().size();
  return file.at = offset;
}

int close_nothing(thandle_t) { return 0; }
toff_t size_of(thandle_t handle) { return file_of(handle).view().size(); }

int keep_complaint(TIFF*, void* user, const char*, const char* format, va_list args) {
  char text[200];
  std::vsnprintf(text, sizeof text, format, args);
  for (char& c : text) {
    if (c == '\n' || c == '\r') c = ' ';
  }
  *static_cast<std::string*>(user) = text;
  return 1;  // handled: nothing is printed
}
int ignore_warning(TIFF*, void*, const char*, const char*, va_list) { return 1; }

struct CloseTiff {
  void operator()(TIFF* tiff) const { TIFFClose(tiff); }
};
using TiffHandle = std::unique_ptr<TIFF, CloseTiff>;

/// `file` must outlive the handle.
TiffHandle open_tiff(MemoryFile& file, const std::string& name, const char* mode) {
  const std::unique_ptr<TIFFOpenOptions, void (*)(TIFFOpenOptions*)> options(TIFFOpenOptionsAlloc(),
                                                                             TIFFOpenOptionsFree);
  if (!options) return nullptr;
  // Whatever a file claims, libtiff takes no block larger than the file.
  TIFFOpenOptionsSetMaxSingleMemAlloc(options.get(),
                                      static_cast<tmsize_t>(file.view().size() + kMetadata_bytes));
  TIFFOpenOptionsSetErrorHandlerExtR(options.get(), keep_complaint, &file.complaint);
  TIFFOpenOptionsSetWarningHandlerExtR(options.get(), ignore_warning, nullptr);
  return TiffHandle(TIFFClientOpenExt(name.c_str(), mode, &file, read_bytes, write_bytes, seek,
                                      close_nothing, size_of, nullptr, nullptr, options.get()));
}

bool write_page(TIFF* tiff, const SensorMaps& maps, int number, std::vector<float> values) {
  const auto bytes = static_cast<tmsize_t>(values.size() * sizeof(float));
  return TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, static_cast<std::uint32_t>(maps.width_px)) &&
         TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, static_cast<std::uint32_t>(maps.height_px)) &&
         TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, static_cast<std::uint32_t>(maps.height_px)) &&
         TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, 32) &&
         TIFFSetField(tiff, TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_IEEEFP) &&
         TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, 1) &&
         TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK) &&
         TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG) &&
         TIFFSetField(tiff, TIFFTAG_COMPRESSION, COMPRESSION_NONE) &&
         TIFFSetField(tiff, TIFFTAG_SUBFILETYPE, FILETYPE_PAGE) &&
         TIFFSetField(tiff, TIFFTAG_PAGENUMBER, number, kPages) &&
         TIFFSetField(tiff, TIFFTAG_PAGENAME, kPageNames[number]) &&
         TIFFWriteEncodedStrip(tiff, 0, values.data(), bytes) == bytes &&
         TIFFWriteDirectory(tiff) == 1;
}

bool consistent(const SensorMaps& maps) {
  if (maps.width_px < 1 || maps.height_px < 1) return false;
  const auto pixels =
      static_cast<std::size_t>(maps.width_px) * static_cast<std::size_t>(maps.height_px);
  return maps.offset_counts.size() == pixels && maps.gain_ratio.size() == pixels &&
         maps.defect.size() == pixels;
}

template <typename Number>
Number tag(TIFF* tiff, std::uint32_t which, Number otherwise) {
  Number value{};
  return TIFFGetFieldDefaulted(tiff, which, &value) == 1 ? value : otherwise;
}

/// Reads one file page by page and remembers its name for messages.
class Reader {
 public:
  Reader(std::string_view bytes, const std::string& name) : name_(name) { file_.bytes = bytes; }

  Result<SensorMaps> read() {
    // m: no memory map; c: strips are not cut into smaller ones.
    tiff_ = open_tiff(file_, name_, "rmc");
    if (!tiff_) return refuse("is not a readable TIFF file: " + file_.complaint);
    SensorMaps out;
    for (int number = 0; number < kPages; ++number) {
      if (number > 0 && TIFFReadDirectory(tiff_.get()) != 1) return no_page(number);
      if (Result<void> fits = check_layout(number, out); !fits) return fits.error();
      Result<std::vector<float>> values = read_page(number, out);
      if (!values) return values.error();
      if (Result<void> kept = keep(number, std::move(values).value(), out); !kept)
        return kept.error();
    }
    if (TIFFLastDirectory(tiff_.get()) == 0) return refuse("has more than three pages");
    return out;
  }

 private:
  Error refuse(const std::string& why) const {
    return {ErrorCode::bad_input,
            name_ + ": " + why + "; sensor maps are written by lsv calibrate camera"};
  }
  Error no_page(int number) const {
    return refuse(std::string("the page ") + kPageNames[number] + " is missing" +
                  (file_.complaint.empty() ? "" : ": " + file_.complaint));
  }
  Error bad_page(int number, const std::string& why) const {
    return refuse(std::string("the page ") + kPageNames[number] + " " + why);
  }

  Result<void> check_layout(int number, SensorMaps& out) const {
    TIFF* const tiff = tiff_.get();
    const auto width = tag<std::uint32_t>(tiff, TIFFTAG_IMAGEWIDTH, 0);
    const auto height = tag<std::uint32_t>(tiff, TIFFTAG_IMAGELENGTH, 0);
    const bool right_type =
        tag<std::uint16_t>(tiff, TIFFTAG_BITSPERSAMPLE, 1) == 32 &&
        tag<std::uint16_t>(tiff, TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_UINT) == SAMPLEFORMAT_IEEEFP &&
        tag<std::uint16_t>(tiff, TIFFTAG_SAMPLESPERPIXEL, 1) == 1 &&
        tag<std::uint16_t>(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISWHITE) ==
            PHOTOMETRIC_MINISBLACK &&
        tag<std::uint16_t>(tiff, TIFFTAG_ORIENTATION, ORIENTATION_TOPLEFT) == ORIENTATION_TOPLEFT &&
        tag<std::uint16_t>(tiff, TIFFTAG_COMPRESSION, COMPRESSION_NONE) == COMPRESSION_NONE &&
        TIFFIsTiled(tiff) == 0 && TIFFNumberOfStrips(tiff) == 1;
    if (!right_type)
      return bad_page(number, "must be 32-bit float, grey, uncompressed and in one strip");
    constexpr std::uint32_t kMaxSide_px = 65535;
    const std::uint64_t page_bytes = std::uint64_t{width} * height * sizeof(float);
    if (width < 1 || height < 1 || width > kMaxSide_px || height > kMaxSide_px ||
        page_bytes > file_.bytes.size())
      return bad_page(number, "claims a size that the file does not hold");
    if (number == 0) {
      out.width_px = static_cast<int>(width);
      out.height_px = static_cast<int>(height);
    } else if (static_cast<int>(width) != out.width_px ||
               static_cast<int>(height) != out.height_px) {
      return bad_page(number, "has another size than the first page");
    }
    return {};
  }

  Result<std::vector<float>> read_page(int number, const SensorMaps& size) {
    std::vector<float> out(static_cast<std::size_t>(size.width_px) *
                           static_cast<std::size_t>(size.height_px));
    const auto bytes = static_cast<tmsize_t>(out.size() * sizeof(float));
    file_.complaint.clear();
    if (TIFFReadEncodedStrip(tiff_.get(), 0, out.data(), bytes) != bytes) {
      return bad_page(number, "is damaged" + (file_.complaint.empty() ? std::string(": it is cut")
                                                                      : ": " + file_.complaint));
    }
    return out;
  }

  Result<void> keep(int number, std::vector<float> values, SensorMaps& out) const {
    const auto bad = std::ranges::find_if_not(values, [number](float value) {
      if (number == 0) return std::abs(value) <= kMaxOffset_counts;
      if (number == 1) return value >= kMinGain_ratio && value <= kMaxGain_ratio;
      return value == 0.0F || value == 1.0F;
    });
    if (bad != values.end()) {
      const char* const rules[kPages] = {"must hold counts", "must hold gains of 0.01 to 100",
                                         "must hold 0 or 1"};
      const auto at = bad - values.begin();
      return bad_page(number, std::string(rules[number]) + " but does not at column " +
                                  std::to_string(at % out.width_px) + ", row " +
                                  std::to_string(at / out.width_px));
    }
    if (number == 0)
      out.offset_counts = std::move(values);
    else if (number == 1)
      out.gain_ratio = std::move(values);
    else
      out.defect.assign(values.begin(), values.end());
    return {};
  }

  std::string name_;
  MemoryFile file_;
  TiffHandle tiff_;
};

}  // namespace

Result<std::string> sensor_maps_tiff(const SensorMaps& maps) {
  if (!consistent(maps)) {
    return Error{ErrorCode::invalid_argument,
                 "the sensor maps do not have a value for each of their pixels"};
  }
  const std::uint64_t map_bytes = maps.defect.size() * kBytesPerPixel;
  std::string out;
  MemoryFile file;
  file.written = &out;
  {
    // l: little-endian on every machine.
    const TiffHandle tiff =
        open_tiff(file, "sensor maps", map_bytes > kBigTiffFrom_bytes ? "wl8" : "wl");
    const bool whole = tiff != nullptr && write_page(tiff.get(), maps, 0, maps.offset_counts) &&
                       write_page(tiff.get(), maps, 1, maps.gain_ratio) &&
                       write_page(tiff.get(), maps, 2, {maps.defect.begin(), maps.defect.end()});
    if (!whole) {
      return Error{ErrorCode::invalid_argument,
                   "the sensor maps cannot be encoded: " + file.complaint};
    }
  }
  return out;
}

Result<SensorMaps> parse_sensor_maps(std::string_view bytes, const std::string& name) {
  try {
    return Reader(bytes, name).read();
  } catch (const std::bad_alloc&) {
    return Error{ErrorCode::bad_input, name + ": there is not enough memory for these sensor maps"};
  }
}

std::string sensor_maps_path(const Calibration& calibration, const std::string& calibration_path) {
  if (!calibration.maps) return {};
  return (std::filesystem::path(calibration_path).parent_path() / calibration.maps->file).string();
}

Calibration with_maps_seen_from(const std::string& folder, Calibration calibration,
                                const std::string& calibration_path) {
  if (!calibration.maps) return calibration;
  const std::string path = sensor_maps_path(calibration, calibration_path);
  std::error_code failed;
  const std::filesystem::path seen = std::filesystem::proximate(path, folder, failed);
  calibration.maps->file =
      failed ? std::filesystem::absolute(path, failed).string() : seen.string();
  return calibration;
}

Result<std::shared_ptr<const SensorMaps>> load_sensor_maps(const Calibration& calibration,
                                                           const std::string& calibration_path) {
  if (!calibration.maps) return std::shared_ptr<const SensorMaps>();
  if (!calibration.format) {
    return Error{ErrorCode::bad_input, calibration_path +
                                           ": [maps] needs the section [format], which says for "
                                           "which frames the maps are"};
  }
  const SensorFormat& format = *calibration.format;
  const std::string path = sensor_maps_path(calibration, calibration_path);
  const std::uint64_t map_bytes = static_cast<std::uint64_t>(format.width_px) *
                                  static_cast<std::uint64_t>(format.height_px) * kBytesPerPixel;
  try {
    const Result<std::string> bytes =
        read_whole_file(path, "sensor maps", map_bytes + kMetadata_bytes);
    if (!bytes) {
      return Error{bytes.error().code,
                   bytes.error().message + " (named by [maps] of " + calibration_path + ")"};
    }
    if (sha256_hex(bytes.value()) != calibration.maps->sha256) {
      return Error{ErrorCode::bad_input, path + ": is not the file that " + calibration_path +
                                             " was written with (its SHA-256 differs); restore "
                                             "it or calibrate the camera again"};
    }
    Result<SensorMaps> maps = parse_sensor_maps(bytes.value(), path);
    if (!maps) return maps.error();
    if (maps.value().width_px != format.width_px || maps.value().height_px != format.height_px) {
      return Error{ErrorCode::bad_input,
                   path + ": holds maps of " + std::to_string(maps.value().width_px) + " x " +
                       std::to_string(maps.value().height_px) + " px, but [format] of " +
                       calibration_path + " says " + std::to_string(format.width_px) + " x " +
                       std::to_string(format.height_px)};
    }
    return std::make_shared<const SensorMaps>(std::move(maps).value());
  } catch (const std::bad_alloc&) {
    return Error{ErrorCode::bad_input, path + ": there is not enough memory for these sensor maps"};
  }
}

}  // namespace lsv
