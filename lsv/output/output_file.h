// SPDX-License-Identifier: BSD-3-Clause
// A file that appears under its name only when it is complete: text goes to NAME.part beside it,
// and commit() writes it to disk and renames it. Destroyed without commit(), the part file is
// removed and an older file of that name stays as it was. "-" is standard output; standard
// output and other streams (pipes, devices) are written to directly and row by row.
// Errors: output_failed, naming the file. A closed pipe is an error, never a signal.
#pragma once

#include <string>
#include <string_view>
#include <utility>

#include "lsv/core/result.h"

namespace lsv {

class OutputFile {
 public:
  static Result<OutputFile> open(const std::string& path);

  OutputFile(OutputFile&& other) noexcept;
  OutputFile& operator=(OutputFile&&) = delete;
  ~OutputFile();

  /// Gathers text into blocks; on a stream each call is passed on at once. After an error the
  /// file is given up: the part file is gone and every further call fails.
  Result<void> write(std::string_view text);

  /// Everything written so far reaches the disk, still under the part name.
  Result<void> complete();

  /// complete(), then the name. Nothing may be written afterwards.
  Result<void> commit();

 private:
  OutputFile(std::string name, int fd) : name_(std::move(name)), fd_(fd) {}

  static Result<OutputFile> open_stream(const std::string& path);
  static Result<OutputFile> open_part(const std::string& path);
  bool is_stream() const { return part_path_.empty(); }
  Result<void> flush();
  Result<void> sync();
  void discard();
  Error closed() const;
  Error abandon(const char* what, int error_number);
  Error failure(const char* what, int error_number) const;

  std::string name_;  // for messages
  int fd_;            // -1 once closed
  std::string target_path_;
  std::string part_path_;  // empty for a stream
  std::string pending_;
};

/// A whole file in one call: open(), write(), commit().
Result<void> write_file(const std::string& path, std::string_view text);

}  // namespace lsv
