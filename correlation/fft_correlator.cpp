// SPDX-License-Identifier: BSD-3-Clause
// The three engines that correlate by FFT. They share padding, transform and the way lags are
// read out; they differ in what is transformed, in the product and in the normalisation.
#include <cmath>
#include <numbers>
#include <span>

#include "correlation/engines.h"
#include "correlation/fft.h"
#include "correlation/kernels.h"

namespace lsv {
namespace {

class FftCorrelator : public Correlator {
 public:
  FftCorrelator(const FrameFormat& format, const LagRange& lags)
      : Correlator(format, lags),
        fft_({.width = format.width_px,
              .height = format.height_px,
              .max_dx = lags.max_dx_px,
              .max_dy = lags.max_dy_px}),
        column_sums_(static_cast<std::size_t>(format.width_px)),
        column_squares_(static_cast<std::size_t>(format.width_px)) {}

  PreparedFrame make_prepared_frame() const override {
    PreparedFrame out;
    out.format = format();
    out.stride_px = stride_px();
    out.centred = AlignedBuffer<float>(static_cast<std::size_t>(stride_px()) *
                                       static_cast<std::size_t>(format().height_px));
    out.spectrum = AlignedBuffer<std::complex<float>>(fft_.spectrum_size());
    return out;
  }

  void correlate(const PreparedFrame& earlier, const PreparedFrame& later,
                 CorrelationPlane& plane) override {
    fft_.correlate(earlier.spectrum.data(), later.spectrum.data(), product(), plane.values.data());
    normalise(earlier, later, plane);
  }

 protected:
  int stride_px() const { return (format().width_px + 15) / 16 * 16; }
  SpectralCorrelation& fft() { return fft_; }
  AlignedBuffer<double>& column_sums() { return column_sums_; }
  AlignedBuffer<double>& column_squares() { return column_squares_; }
  float inverse_scale() const { return 1.0F / fft_.scale(); }

  virtual SpectrumProduct product() const { return kernels::multiply_conj; }
  virtual void normalise(const PreparedFrame& earlier, const PreparedFrame& later,
                         CorrelationPlane& plane) = 0;

 private:
  SpectralCorrelation fft_;
  AlignedBuffer<double> column_sums_;
  AlignedBuffer<double> column_squares_;
};

class ZnccCorrelator final : public FftCorrelator {
 public:
  ZnccCorrelator(const FrameFormat& format, const LagRange& lags)
      : FftCorrelator(format, lags), overlap_sums_(format, lags) {}

  PreparedFrame make_prepared_frame() const override {
    PreparedFrame out = FftCorrelator::make_prepared_frame();
    out.overlap = overlap_sums_.make_tables();
    return out;
  }

  void prepare(const FrameView& frame, PreparedFrame& out) override {
    centre_frame(frame, out, column_sums().span(), column_squares().span());
    overlap_sums_.fill(column_sums().span(), column_squares().span(), out);
    fft().forward(out.centred.data(), out.stride_px, out.spectrum.data());
  }

 private:
  void normalise(const PreparedFrame& earlier, const PreparedFrame& later,
                 CorrelationPlane& plane) override {
    kernels::normalise_overlap(plane.values.data(), plane.values.size(), inverse_scale(),
                               earlier.overlap.mean_root.data(), earlier.overlap.inv_norm.data(),
                               later.overlap.mean_root.data(), later.overlap.inv_norm.data());
  }

  OverlapSums overlap_sums_;
};

void scale_plane(float scale, CorrelationPlane& plane) {
  for (float& value : plane.values.span()) value *= scale;
}

class CrossCorrelator final : public FftCorrelator {
 public:
  using FftCorrelator::FftCorrelator;

  void prepare(const FrameView& frame, PreparedFrame& out) override {
    centre_frame(frame, out, column_sums().span(), column_squares().span());
    fft().forward(out.centred.data(), out.stride_px, out.spectrum.data());
  }

 private:
  void normalise(const PreparedFrame& earlier, const PreparedFrame& later,
                 CorrelationPlane& plane) override {
    const double pixels = static_cast<double>(format().width_px) * format().height_px;
    const double energy = pixels * earlier.stats.sd_counts * later.stats.sd_counts;
    scale_plane(energy > 0.0 ? static_cast<float>(inverse_scale() / energy) : 0.0F, plane);
  }
};

AlignedBuffer<float> hann_window(int length_px) {
  AlignedBuffer<float> out(static_cast<std::size_t>(length_px));
  for (int i = 0; i < length_px; ++i) {
    const double phase = 2.0 * std::numbers::pi * (i + 0.5) / length_px;
    out[static_cast<std::size_t>(i)] = static_cast<float>(0.5 - 0.5 * std::cos(phase));
  }
  return out;
}

void whitened_product(const std::complex<float>* earlier, const std::complex<float>* later,
                      std::size_t n, std::complex<float>* out) {
  kernels::multiply_conj(earlier, later, n, out);
  for (std::complex<float>& value : std::span(out, n)) {
    const float magnitude = std::sqrt(value.real() * value.real() + value.imag() * value.imag());
    value = magnitude > 0.0F
                ? std::complex<float>(value.real() / magnitude, value.imag() / magnitude)
                : std::complex<float>();
  }
}

class PhaseCorrelator final : public FftCorrelator {
 public:
  PhaseCorrelator(const FrameFormat& format, const LagRange& lags)
      : FftCorrelator(format, lags),
        window_x_(hann_window(format.width_px)),
        window_y_(hann_window(format.height_px)),
        windowed_(static_cast<std::size_t>(stride_px()) *
                  static_cast<std::size_t>(format.height_px)) {}

  void prepare(const FrameView& frame, PreparedFrame& out) override {
    centre_frame(frame, out, column_sums().span(), column_squares().span());
    for (int y = 0; y < format().height_px; ++y) {
      const float* const row = out.centred_row(y);
      float* const windowed = windowed_.data() + static_cast<std::ptrdiff_t>(y) * out.stride_px;
      const float weight = window_y_[static_cast<std::size_t>(y)];
      for (std::size_t x = 0; x < window_x_.size(); ++x)
        windowed[x] = row[x] * (weight * window_x_[x]);
    }
    fft().forward(windowed_.data(), out.stride_px, out.spectrum.data());
  }

 private:
  SpectrumProduct product() const override { return whitened_product; }

  void normalise(const PreparedFrame&, const PreparedFrame&, CorrelationPlane& plane) override {
    scale_plane(inverse_scale(), plane);
  }

  AlignedBuffer<float> window_x_;
  AlignedBuffer<float> window_y_;
  AlignedBuffer<float> windowed_;
};

}  // namespace

std::unique_ptr<Correlator> make_fft_correlator(Engine engine, const FrameFormat& format,
                                                const LagRange& lags) {
  switch (engine) {
    case Engine::cross:
      return std::make_unique<CrossCorrelator>(format, lags);
    case Engine::phase:
      return std::make_unique<PhaseCorrelator>(format, lags);
    case Engine::zncc:
    case Engine::direct:
      break;
  }
  return std::make_unique<ZnccCorrelator>(format, lags);
}

}  // namespace lsv
