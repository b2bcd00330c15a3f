// SPDX-License-Identifier: BSD-3-Clause
// Frames and what the odometer said about them as an HDF5 file for laboratories: /frames
// (frame, row, column), one chunk a frame, and one dataset for each field, /index, /stamp_ns,
// /dx_px, ..., with an attribute `units`; words are enumerations. Written in SWMR mode, so that
// another program may read the file while it grows.
// A new file; destroyed without finish() it is removed.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "lsv/core/result.h"
#include "lsv/ingest/recording.h"

namespace lsv::cli {

class Hdf5Recording {
 public:
  /// Frames to come look like `first`; there are steps for all of them or for none. `notes` become
  /// attributes.
  static Result<Hdf5Recording> create(const std::string& path, const RecordedFrame& first,
                                      const RecordingNotes& notes);
  Hdf5Recording(Hdf5Recording&&) noexcept;
  Hdf5Recording& operator=(Hdf5Recording&&) = delete;
  ~Hdf5Recording();

  Result<void> add(const RecordedFrame& frame);
  Result<void> finish();

 private:
  struct File;
  explicit Hdf5Recording(std::unique_ptr<File> file);
  std::unique_ptr<File> file_;
};

}  // namespace lsv::cli
