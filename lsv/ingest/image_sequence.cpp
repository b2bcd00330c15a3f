// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/ingest/image_sequence.h"

#include <algorithm>
#include <filesystem>
#include <numeric>
#include <utility>

#include "lsv/ingest/numbered_names.h"

namespace lsv {
namespace {

std::string file_name(const std::string& path) {
  return std::filesystem::path(path).filename().string();
}

std::string describe(const ImageNotes& notes) {
  std::string text = notes.colour ? "colour" : "grey";
  if (notes.alpha) text += " with alpha";
  return text;
}

class ImageSequence : public FrameStream {
 public:
  ImageSequence(std::vector<std::string> paths, std::vector<std::int64_t> indices, ImageKind kind,
                const DecodeOptions& options, std::vector<std::string> warnings)
      : paths_(std::move(paths)),
        indices_(std::move(indices)),
        kind_(kind),
        reader_(options),
        warnings_(std::move(warnings)) {}

  std::string description() const override {
    const std::string kind(word(kind_));
    return paths_.size() == 1 ? kind + " image" : kind + " sequence";
  }
  std::string last_name() const override { return paths_[next_ > 0 ? next_ - 1 : 0]; }
  std::int64_t next_index() const override {
    return next_ < indices_.size() ? indices_[next_] : indices_.back() + 1;
  }
  std::optional<std::int64_t> count() const override {
    return static_cast<std::int64_t>(paths_.size());
  }
  const std::vector<std::int64_t>* indices() const override { return &indices_; }

  Result<bool> skip() override {
    if (next_ == paths_.size()) return false;
    ++next_;
    return true;
  }

  Result<bool> read(Frame& out) override {
    if (!skip().value()) return false;
    const auto notes = reader_.read(last_name(), kind_, out);
    if (!notes) return notes.error();
    if (!first_notes_) first_notes_ = notes.value();
    if (*first_notes_ != notes.value()) {
      return Error{ErrorCode::bad_input, last_name() + ": is " + describe(notes.value()) +
                                             " but the frames before it are " +
                                             describe(*first_notes_)};
    }
    return true;
  }

  std::vector<std::string> warnings() const override {
    std::vector<std::string> all = warnings_;
    if (first_notes_ && first_notes_->colour)
      all.push_back("The frames are in colour; lsv measures on their luma.");
    if (first_notes_ && first_notes_->alpha)
      all.push_back("The frames have a fourth (alpha) channel or transparency, which is ignored.");
    if (kind_ == ImageKind::jpeg)
      all.push_back(
          "JPEG is lossy and alters the speckle pattern; record PNG, TIFF, PGM or raw frames.");
    return all;
  }

 private:
  std::vector<std::string> paths_;
  std::vector<std::int64_t> indices_;
  ImageKind kind_;
  ImageReader reader_;
  std::vector<std::string> warnings_;
  std::optional<ImageNotes> first_notes_;
  std::size_t next_ = 0;
};

Result<void> check_increasing(const std::vector<std::string>& paths,
                              const std::vector<std::int64_t>& numbers) {
  for (std::size_t i = 1; i < numbers.size(); ++i) {
    if (numbers[i] > numbers[i - 1]) continue;
    return Error{ErrorCode::bad_input, paths[i] + ": has the same frame number as " +
                                           file_name(paths[i - 1]) +
                                           "; remove one, or give --ignore-numbers"};
  }
  return {};
}

/// Nothing when the numbers have no hole.
std::optional<std::string> warn_of_holes(const std::vector<std::string>& paths,
                                         const std::vector<std::int64_t>& indices) {
  const auto files = static_cast<std::int64_t>(indices.size());
  const std::int64_t missing = indices.back() + 1 - files;
  if (missing == 0) return std::nullopt;
  std::size_t first = 1;
  while (indices[first] == indices[first - 1] + 1) ++first;
  std::string text = std::to_string(missing) +
                     (missing == 1 ? " frame is missing" : " frames are missing") +
                     " by the numbers in the names, first between " + file_name(paths[first - 1]) +
                     " and " + file_name(paths[first]);
  const std::int64_t stride = indices[1] - indices[0];
  const bool even = indices.back() == stride * (files - 1) &&
                    std::adjacent_find(indices.begin(), indices.end(), [&](auto a, auto b) {
                      return b - a != stride;
                    }) == indices.end();
  if (even && files > 2) text += "; all numbers step by " + std::to_string(stride);
  return text + "; if the files follow each other without gaps, give --ignore-numbers.";
}

std::vector<std::int64_t> consecutive(std::size_t count) {
  std::vector<std::int64_t> indices(count);
  std::iota(indices.begin(), indices.end(), std::int64_t{0});
  return indices;
}

}  // namespace

Result<std::unique_ptr<FrameStream>> open_image_sequence(std::vector<std::string> paths,
                                                         ListOrder order, bool ignore_numbers,
                                                         const DecodeOptions& options) {
  const ImageKind kind = options.raw ? ImageKind::raw : image_kind_of(paths.front()).value();
  const bool family = !ignore_numbers && numbers_of_family(paths);
  if (family || order == ListOrder::natural) std::sort(paths.begin(), paths.end(), natural_less);

  std::vector<std::int64_t> indices = consecutive(paths.size());
  std::vector<std::string> warnings;
  if (family) {
    indices = numbers_of_family(paths).value();  // again, in sorted order
    const auto increasing = check_increasing(paths, indices);
    if (!increasing) return increasing.error();
    const std::int64_t first = indices.front();
    for (std::int64_t& index : indices) index -= first;
    if (auto warning = warn_of_holes(paths, indices)) warnings.push_back(std::move(*warning));
  }
  return std::unique_ptr<FrameStream>(std::make_unique<ImageSequence>(
      std::move(paths), std::move(indices), kind, options, std::move(warnings)));
}

}  // namespace lsv
