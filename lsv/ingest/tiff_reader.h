// SPDX-License-Identifier: BSD-3-Clause
// One open TIFF file, read page by page through libtiff. Each step costs the same however many
// pages there are, and memory does not grow with them. Grey pages of 8 or 16 unsigned bits,
// dark = 0, strips or tiles, uncompressed or LZW, deflate, PackBits, Zstandard. libtiff prints
// nothing: its message goes into the error.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "lsv/core/frame.h"
#include "lsv/core/result.h"
#include "lsv/ingest/image_decode.h"
#include "lsv/ingest/input_file.h"

struct tiff;  // libtiff's TIFF

namespace lsv {

class TiffReader {
 public:
  /// Stands on the first page.
  static Result<std::unique_ptr<TiffReader>> open(const std::string& path,
                                                  const DecodeOptions& options);
  TiffReader(const TiffReader&) = delete;  // libtiff points into the reader
  TiffReader& operator=(const TiffReader&) = delete;
  ~TiffReader();

  /// Walks the chain of pages once, without reading them, and goes back to the first; a chain
  /// that loops or breaks is an error.
  Result<std::int64_t> count_pages();

  std::string page_name() const;  // "file.tif, page 3"; pages count from 0
  bool on_last_page() const;
  Result<void> go_to_next_page();
  /// The current page, once.
  Result<void> read_page(Frame& out);

 private:
  TiffReader(const std::string& path, const DecodeOptions& options, FileHandle file);
  Error damaged() const;

  std::string path_;
  DecodeOptions options_;
  FileHandle file_;
  std::string complaint_;  // libtiff's last error
  std::int64_t page_ = 0;
  std::vector<std::uint8_t> tile_;
  ::tiff* tiff_ = nullptr;
};

}  // namespace lsv
