// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/ingest/tiff_stack.h"

#include <utility>

#include "lsv/ingest/tiff_reader.h"

namespace lsv {
namespace {

class TiffStack : public FrameStream {
 public:
  TiffStack(std::unique_ptr<TiffReader> reader, std::int64_t page_count)
      : reader_(std::move(reader)), page_count_(page_count) {}

  std::string description() const override { return "TIFF stack"; }
  std::string last_name() const override { return reader_->page_name(); }
  std::int64_t next_index() const override { return next_page_; }
  std::optional<std::int64_t> count() const override { return page_count_; }

  Result<bool> read(Frame& out) override {
    auto there = skip();
    if (!there || !there.value()) return there;
    const auto page = reader_->read_page(out);
    if (!page) return page.error();
    return true;
  }

  Result<bool> skip() override {
    if (next_page_ == page_count_) return false;
    if (next_page_ > 0) {
      const auto moved = reader_->go_to_next_page();
      if (!moved) return moved.error();
    }
    ++next_page_;
    return true;
  }

 private:
  std::unique_ptr<TiffReader> reader_;
  std::int64_t page_count_;
  std::int64_t next_page_ = 0;
};

}  // namespace

Result<std::unique_ptr<FrameStream>> open_tiff_stack(const std::string& path,
                                                     const DecodeOptions& options) {
  auto reader = TiffReader::open(path, options);
  if (!reader) return reader.error();
  const auto count = reader.value()->count_pages();
  if (!count) return count.error();
  return std::unique_ptr<FrameStream>(
      std::make_unique<TiffStack>(std::move(reader).value(), count.value()));
}

}  // namespace lsv
