// SPDX-License-Identifier: BSD-3-Clause
#include "sim/speckle_field.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/core.hpp>

#include "sim/speckle_optics.h"

namespace lsv::sim {
namespace {

// The point spread reaches kKernelRadius * s, and half a sample more once shifted.
int margin_for(double s) { return static_cast<int>(std::ceil(kKernelRadius * s + 0.5)); }

cv::Mat as_matrix(std::vector<std::complex<double>>& values, int rows, int columns) {
  return {rows, columns, CV_64FC2, values.data()};
}

/// Signed frequency of bin `n` in cycles per sample.
double frequency(int n, int size) {
  return static_cast<double>(2 * n <= size ? n : n - size) / size;
}

/// Factors that move a transform of `ramp.size()` samples by `shift` towards the origin.
void fill_ramp(double shift, std::vector<std::complex<double>>& ramp) {
  const int size = static_cast<int>(ramp.size());
  for (int n = 0; n < size; ++n) {
    ramp[static_cast<std::size_t>(n)] =
        std::polar(1.0, 2.0 * std::numbers::pi * frequency(n, size) * shift);
  }
}

}  // namespace

int patch_side(int samples, double s) { return cv::getOptimalDFTSize(samples + 2 * margin_for(s)); }

SpeckleField::SpeckleField(const FieldGeometry& geometry, std::uint64_t seed,
                           double field_correlation)
    : geometry_(geometry),
      margin_(margin_for(geometry.s)),
      patch_columns_(patch_side(geometry.columns, geometry.s)),
      patch_rows_(patch_side(geometry.rows, geometry.s)),
      ground_(seed, field_correlation) {
  const std::size_t samples =
      static_cast<std::size_t>(patch_columns_) * static_cast<std::size_t>(patch_rows_);
  transfer_.resize(samples);
  spectrum_.resize(samples);
  field_.resize(samples);
  ramp_x_.resize(static_cast<std::size_t>(patch_columns_));
  ramp_y_.resize(static_cast<std::size_t>(patch_rows_));
  fill_transfer();
}

void SpeckleField::fill_transfer() {
  double energy = 0.0;
  for (int r = 0; r < patch_rows_; ++r) {
    for (int c = 0; c < patch_columns_; ++c) {
      const double distance =
          std::hypot(std::min(c, patch_columns_ - c), std::min(r, patch_rows_ - r));
      const double value = point_spread(distance, geometry_.s);
      field_[static_cast<std::size_t>(r * patch_columns_ + c)] = value;
      energy += value * value;
    }
  }
  cv::Mat kernel = as_matrix(field_, patch_rows_, patch_columns_);
  cv::dft(kernel, kernel);
  // Mean intensity 1 after an inverse transform that does not divide by the number of samples.
  const double scale = 1.0 / (std::sqrt(energy) * static_cast<double>(field_.size()));
  for (std::size_t n = 0; n < field_.size(); ++n) transfer_[n] = field_[n].real() * scale;
}

void SpeckleField::load_patch(std::int64_t frame, std::int64_t column, std::int64_t row) {
  const bool same_frame = !ground_.boils() || frame == loaded_frame_;
  if (loaded_ && same_frame && column == loaded_column_ && row == loaded_row_) return;
  loaded_ = false;
  ground_.read(column, row, patch_columns_, patch_rows_, frame, spectrum_.data());
  cv::Mat patch = as_matrix(spectrum_, patch_rows_, patch_columns_);
  cv::dft(patch, patch);
  loaded_frame_ = frame;
  loaded_column_ = column;
  loaded_row_ = row;
  loaded_ = true;
}

void SpeckleField::transform(std::int64_t frame, double x, double y) {
  const double cell_x = std::floor(x + 0.5);
  const double cell_y = std::floor(y + 0.5);
  load_patch(frame, static_cast<std::int64_t>(cell_x) - margin_,
             static_cast<std::int64_t>(cell_y) - margin_);
  fill_ramp(x - cell_x + margin_, ramp_x_);
  fill_ramp(y - cell_y + margin_, ramp_y_);

  std::size_t n = 0;
  for (const std::complex<double> ramp_y : ramp_y_) {
    for (const std::complex<double> ramp_x : ramp_x_) {
      // Written out: the library's complex product tests for NaN on every sample.
      const double a =
          transfer_[n] * (ramp_x.real() * ramp_y.real() - ramp_x.imag() * ramp_y.imag());
      const double b =
          transfer_[n] * (ramp_x.real() * ramp_y.imag() + ramp_x.imag() * ramp_y.real());
      const std::complex<double> g = spectrum_[n];
      field_[n] = {a * g.real() - b * g.imag(), a * g.imag() + b * g.real()};
      ++n;
    }
  }
  // The ramps include the margin, so that the samples asked for are the first of the patch.
  cv::Mat field = as_matrix(field_, patch_rows_, patch_columns_);
  cv::dft(field, field, cv::DFT_INVERSE);
}

void SpeckleField::add_intensity(std::int64_t frame, double x, double y, double weight,
                                 double* sum) {
  transform(frame, x, y);
  for (int r = 0; r < geometry_.rows; ++r) {
    const std::complex<double>* row = field_.data() + std::ptrdiff_t{r} * patch_columns_;
    for (int c = 0; c < geometry_.columns; ++c) *sum++ += weight * std::norm(row[c]);
  }
}

void SpeckleField::read(std::int64_t frame, std::int64_t column, std::int64_t row,
                        std::complex<float>* out) {
  transform(frame, static_cast<double>(column), static_cast<double>(row));
  for (int r = 0; r < geometry_.rows; ++r) {
    const std::complex<double>* from = field_.data() + std::ptrdiff_t{r} * patch_columns_;
    out = std::transform(from, from + geometry_.columns, out, [](const std::complex<double>& z) {
      return std::complex<float>(static_cast<float>(z.real()), static_cast<float>(z.imag()));
    });
  }
}

}  // namespace lsv::sim
