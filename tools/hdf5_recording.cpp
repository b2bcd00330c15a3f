// SPDX-License-Identifier: BSD-3-Clause
#include "tools/hdf5_recording.h"

#include <hdf5.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <filesystem>
#include <type_traits>
#include <utility>
#include <vector>

#include "lsv/mcap/message_fields.h"

namespace lsv::cli {
namespace {

constexpr hsize_t kRowsAtOnce = 1024;

/// Owner of an HDF5 identifier; `how` to close it depends on its kind.
class Handle {
 public:
  using Close = herr_t (*)(hid_t);
  Handle() = default;
  Handle(hid_t id, Close how) : id_(id), close_(how) {}
  Handle(Handle&& other) noexcept
      : id_(std::exchange(other.id_, H5I_INVALID_HID)), close_(other.close_) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(id_, other.id_);
    std::swap(close_, other.close_);
    return *this;
  }
  ~Handle() { static_cast<void>(close()); }

  hid_t id() const { return id_; }
  bool close() {
    if (id_ < 0) return true;
    return close_(std::exchange(id_, H5I_INVALID_HID)) >= 0;
  }

 private:
  hid_t id_ = H5I_INVALID_HID;
  Close close_ = nullptr;
};

Handle shape(const std::vector<hsize_t>& now, const std::vector<hsize_t>& most) {
  return {H5Screate_simple(static_cast<int>(now.size()), now.data(), most.data()), H5Sclose};
}

const char* units_of(std::string_view field) {
  constexpr std::array<std::pair<std::string_view, const char*>, 7> kUnits = {{{"_px2", "px^2"},
                                                                               {"_px", "px"},
                                                                               {"_m_s", "m/s"},
                                                                               {"_m", "m"},
                                                                               {"_rad", "rad"},
                                                                               {"_ns", "ns"},
                                                                               {"_s", "s"}}};
  for (const auto& [ending, units] : kUnits) {
    if (field.ends_with(ending)) return units;
  }
  return "1";
}

bool set_text(hid_t object, const char* name, const std::string& text) {
  const Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  if (H5Tset_size(type.id(), text.size() + 1) < 0) return false;
  H5Tset_cset(type.id(), H5T_CSET_UTF8);
  const Handle scalar(H5Screate(H5S_SCALAR), H5Sclose);
  const Handle attribute(H5Acreate2(object, name, type.id(), scalar.id(), H5P_DEFAULT, H5P_DEFAULT),
                         H5Aclose);
  return H5Awrite(attribute.id(), type.id(), text.c_str()) >= 0;
}

bool set_number(hid_t object, const char* name, int value) {
  const Handle scalar(H5Screate(H5S_SCALAR), H5Sclose);
  const Handle attribute(
      H5Acreate2(object, name, H5T_STD_I32LE, scalar.id(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  return H5Awrite(attribute.id(), H5T_NATIVE_INT, &value) >= 0;
}

/// A dataset that grows along its first axis.
class GrowingDataset {
 public:
  bool create(hid_t file, const char* name, hid_t type, std::vector<hsize_t> chunk) {
    std::vector<hsize_t> now = chunk;
    std::vector<hsize_t> most = chunk;
    now[0] = 0;
    most[0] = H5S_UNLIMITED;
    const Handle space = shape(now, most);
    const Handle plan(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    if (H5Pset_chunk(plan.id(), static_cast<int>(chunk.size()), chunk.data()) < 0) return false;
    dataset_ = {H5Dcreate2(file, name, type, space.id(), H5P_DEFAULT, plan.id(), H5P_DEFAULT),
                H5Dclose};
    extent_ = std::move(now);
    return dataset_.id() >= 0;
  }

  bool append(hid_t memory_type, const void* data, hsize_t rows) {
    std::vector<hsize_t> start(extent_.size(), 0);
    std::vector<hsize_t> count = extent_;
    start[0] = extent_[0];
    count[0] = rows;
    extent_[0] += rows;
    if (H5Dset_extent(dataset_.id(), extent_.data()) < 0) return false;
    const Handle in_file(H5Dget_space(dataset_.id()), H5Sclose);
    const Handle in_memory = shape(count, count);
    return H5Sselect_hyperslab(in_file.id(), H5S_SELECT_SET, start.data(), nullptr, count.data(),
                               nullptr) >= 0 &&
           H5Dwrite(dataset_.id(), memory_type, in_memory.id(), in_file.id(), H5P_DEFAULT, data) >=
               0;
  }

  hid_t id() const { return dataset_.id(); }
  bool close() { return dataset_.close(); }

 private:
  Handle dataset_;
  std::vector<hsize_t> extent_;
};

/// One field, gathered until many rows can be written at once.
class Column {
 public:
  Column(std::string name, Handle type) : name_(std::move(name)), type_(std::move(type)) {
    size_ = H5Tget_size(type_.id());
  }

  bool create(hid_t file) {
    return dataset_.create(file, name_.c_str(), type_.id(), {kRowsAtOnce}) &&
           set_text(dataset_.id(), "units", units_of(name_));
  }
  template <typename Value>
  void add(const Value& value) {
    const auto* const bytes = reinterpret_cast<const std::byte*>(&value);
    rows_.insert(rows_.end(), bytes, bytes + sizeof value);
  }
  bool flush() {
    const hsize_t rows = rows_.size() / size_;
    if (rows == 0) return true;
    const bool written = dataset_.append(type_.id(), rows_.data(), rows);
    rows_.clear();
    return written;
  }
  bool close() { return dataset_.close(); }

 private:
  std::string name_;
  Handle type_;
  std::size_t size_ = 0;
  GrowingDataset dataset_;
  std::vector<std::byte> rows_;
};

template <typename Value>
Handle type_of() {
  if constexpr (std::is_enum_v<Value>) {
    Handle type(H5Tenum_create(H5T_NATIVE_UINT8), H5Tclose);
    std::uint8_t number = 0;
    for (const Value value : mcap::AllOf<Value>::kValues) {
      H5Tenum_insert(type.id(), std::string(word(value)).c_str(), &number);
      ++number;
    }
    return type;
  } else {
    static_assert(std::is_same_v<Value, double> || std::is_same_v<Value, std::int64_t>);
    return {H5Tcopy(std::is_same_v<Value, double> ? H5T_NATIVE_DOUBLE : H5T_NATIVE_INT64),
            H5Tclose};
  }
}

/// The number that type_of() gave the word of `value`.
template <typename Enum>
std::uint8_t number_of(Enum value) {
  const auto& values = mcap::AllOf<Enum>::kValues;
  return static_cast<std::uint8_t>(std::find(values.begin(), values.end(), value) - values.begin());
}

}  // namespace

struct Hdf5Recording::File {
  std::string path;
  bool finished = false;
  bool has_steps = false;
  FrameFormat format;
  std::vector<std::byte> pixels;
  hsize_t frames_since_flush = 0;
  Handle file;
  GrowingDataset frames;
  std::vector<Column> columns;  // those of the step, or index and stamp alone

  ~File() {
    std::error_code ignored;
    if (!finished && file.id() >= 0) std::filesystem::remove(path, ignored);
  }

  Error failure() const {
    return {ErrorCode::output_failed, "cannot write " + path + ": the disk may be full"};
  }
  hid_t pixel_type() const {
    return format.type == PixelType::mono8 ? H5T_NATIVE_UINT8 : H5T_NATIVE_UINT16;
  }
  bool create_datasets(const RecordingNotes& notes);
  bool write_columns();
};

namespace {

/// `visit(name, value)` for each column of a frame.
template <typename Visit>
void visit_columns(const RecordedFrame& frame, Visit&& visit) {
  visit("index", frame.frame.index);
  if (!frame.step) {
    visit("stamp_ns", frame.frame.stamp.ns);
    return;
  }
  mcap::visit_fields(*frame.step, [&visit](std::string_view name, const auto& value) {
    if (name != "frame") visit(name, value);  // the index again
  });
}

}  // namespace

bool Hdf5Recording::File::create_datasets(const RecordingNotes& notes) {
  const auto height = static_cast<hsize_t>(format.height_px);
  const auto width = static_cast<hsize_t>(format.width_px);
  bool ok = frames.create(file.id(), "frames", pixel_type(), {1, height, width}) &&
            set_text(frames.id(), "units", "counts") &&
            set_number(frames.id(), "bit_depth", format.bit_depth);
  for (Column& column : columns) ok = ok && column.create(file.id());
  ok = ok && set_text(file.id(), "schema", "lsv.hdf5/1") &&
       set_text(file.id(), "program", notes.program) && set_text(file.id(), "source", notes.source);
  if (notes.config_toml) ok = ok && set_text(file.id(), "config.toml", *notes.config_toml);
  if (notes.calibration_toml)
    ok = ok && set_text(file.id(), "calibration.toml", *notes.calibration_toml);
  return ok && H5Fstart_swmr_write(file.id()) >= 0;
}

bool Hdf5Recording::File::write_columns() {
  bool ok = true;
  for (Column& column : columns) ok = column.flush() && ok;
  frames_since_flush = 0;
  return ok && H5Fflush(file.id(), H5F_SCOPE_GLOBAL) >= 0;
}

Hdf5Recording::Hdf5Recording(std::unique_ptr<File> file) : file_(std::move(file)) {}
Hdf5Recording::Hdf5Recording(Hdf5Recording&&) noexcept = default;
Hdf5Recording::~Hdf5Recording() = default;

Result<Hdf5Recording> Hdf5Recording::create(const std::string& path, const RecordedFrame& first,
                                            const RecordingNotes& notes) {
  // On a full disk the library's own clean-up at exit would crash; files are closed here.
  H5dont_atexit();
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // errors are values here
  std::error_code unknown;
  if (std::filesystem::exists(path, unknown)) {
    return Error{ErrorCode::output_failed,
                 path + ": exists already; remove it or choose another name"};
  }
  auto file = std::make_unique<File>();
  file->path = path;
  file->has_steps = first.step.has_value();
  file->format = first.frame.view().format;
  visit_columns(first, [&file](std::string_view name, const auto& value) {
    file->columns.emplace_back(std::string(name), type_of<std::remove_cvref_t<decltype(value)>>());
  });
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_libver_bounds(access.id(), H5F_LIBVER_LATEST, H5F_LIBVER_LATEST);  // as SWMR needs
  file->file = {H5Fcreate(path.c_str(), H5F_ACC_EXCL, H5P_DEFAULT, access.id()), H5Fclose};
  if (file->file.id() < 0) {
    return Error{ErrorCode::output_failed,
                 "cannot create " + path + ": the folder is missing or may not be written to"};
  }
  if (!file->create_datasets(notes)) return file->failure();
  return Hdf5Recording(std::move(file));
}

Result<void> Hdf5Recording::add(const RecordedFrame& recorded) {
  const FrameView frame = recorded.frame.view();
  if (frame.format != file_->format) {
    return Error{ErrorCode::bad_input, "frame " + std::to_string(frame.index) +
                                           " has another size or depth than those before it"};
  }
  if (recorded.step.has_value() != file_->has_steps) {
    return Error{ErrorCode::bad_input, "only some frames have what the odometer said; frame " +
                                           std::to_string(frame.index) + " differs from the first"};
  }
  const std::size_t row_bytes =
      static_cast<std::size_t>(frame.width_px()) * bytes_per_pixel(frame.format.type);
  file_->pixels.resize(row_bytes * static_cast<std::size_t>(frame.height_px()));
  for (int y = 0; y < frame.height_px(); ++y)
    std::memcpy(file_->pixels.data() + static_cast<std::size_t>(y) * row_bytes,
                frame.data + y * frame.stride_bytes, row_bytes);
  if (!file_->frames.append(file_->pixel_type(), file_->pixels.data(), 1)) return file_->failure();
  auto column = file_->columns.begin();
  visit_columns(recorded, [&column](std::string_view, const auto& value) {
    if constexpr (std::is_enum_v<std::remove_cvref_t<decltype(value)>>)
      (column++)->add(number_of(value));
    else
      (column++)->add(value);
  });
  if (++file_->frames_since_flush == kRowsAtOnce && !file_->write_columns())
    return file_->failure();
  return {};
}

Result<void> Hdf5Recording::finish() {
  bool ok = file_->write_columns();
  for (Column& column : file_->columns) ok = column.close() && ok;
  ok = file_->frames.close() && ok;
  ok = ok && file_->file.close();
  if (!ok) return file_->failure();
  file_->finished = true;
  return {};
}

}  // namespace lsv::cli
