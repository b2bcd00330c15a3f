// SPDX-License-Identifier: BSD-3-Clause
// The run as one HTML file that needs no network: summary, trajectory, velocity with its sigma
// band, quality against the gates, refused frames with their reasons, the correlation plane of
// one pair and the frame it came from, and all settings. D3 3.5 draws it in the browser.
// Memory and file size are bounded for any length of run (report_series.h). All text from outside
// is data in the page, never markup. The same run gives the same bytes.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "lsv/core/frame.h"
#include "lsv/output/output_file.h"
#include "lsv/output/report_series.h"
#include "lsv/output/summary.h"
#include "lsv/output/track_sink.h"

namespace lsv {

/// The correlation plane of one pair.
struct PlaneSnapshot {
  std::int64_t frame = 0;  // index of the later frame of the pair
  int max_dx_px = 0;
  int max_dy_px = 0;
  std::vector<float> zncc{};  // row-major, (2 * max_dy_px + 1) rows of 2 * max_dx_px + 1 lags
  double dx_px = kUnknown;    // the sub-pixel peak; NaN when the shift was refused
  double dy_px = kUnknown;
  std::string status{};  // word(ShiftStatus)
  std::string engine{};  // word(Engine)
};

/// A frame in 8-bit grey, row-major, for the eye only.
struct FramePreview {
  std::int64_t frame = 0;
  int width_px = 0;
  int height_px = 0;
  int reduction = 1;  // a preview pixel is the mean of reduction x reduction frame pixels
  std::vector<std::uint8_t> grey{};
};

/// Full scale becomes 255; larger frames are reduced until no side exceeds 512 px.
FramePreview preview_of(const FrameView& frame);

class ReportBuilder : public TrackSink {
 public:
  ReportBuilder(OutputFile file, RunInfo info);

  /// The pair shown; without them the page says that none was kept. A plane whose size does not
  /// match its lags is an error (invalid_argument).
  Result<void> set_plane(PlaneSnapshot plane);
  void set_preview(FramePreview preview) { preview_ = std::move(preview); }

  Result<void> write(const StepReport& report) override;
  Result<void> finish(const RunEnd& end) override;
  Result<void> commit() override { return file_.commit(); }

 private:
  std::string page() const;

  OutputFile file_;
  RunInfo info_;
  SummaryBuilder summary_;
  ReportSeries series_;
  std::optional<PlaneSnapshot> plane_;
  std::optional<FramePreview> preview_;
};

}  // namespace lsv
