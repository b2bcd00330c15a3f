// SPDX-License-Identifier: BSD-3-Clause
#include "correlation/fft.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <thread>
#include <vector>

#include "correlation/aligned_buffer.h"

namespace lsv {
namespace {

constexpr FftShape kShapes[] = {{.rows = 16, .cols = 16, .input_rows = 16, .output_edge_rows = 7},
                                {.rows = 20, .cols = 36, .input_rows = 13, .output_edge_rows = 3},
                                {.rows = 60, .cols = 8, .input_rows = 41, .output_edge_rows = 0}};

AlignedBuffer<float> random_image(const FftShape& shape, unsigned seed) {
  AlignedBuffer<float> out(static_cast<std::size_t>(shape.rows * shape.cols));
  std::mt19937 random(seed);
  for (int i = 0; i < shape.input_rows * shape.cols; ++i)
    out[static_cast<std::size_t>(i)] = static_cast<float>(random() % 2001) / 1000.0F - 1.0F;
  return out;
}

TEST(FastFftLength, IsTheSmallestSmoothMultipleOfFour) {
  EXPECT_EQ(fast_fft_length(1), 4);
  EXPECT_EQ(fast_fft_length(128), 128);
  EXPECT_EQ(fast_fft_length(129), 144);
  EXPECT_EQ(fast_fft_length(160), 160);
  EXPECT_EQ(fast_fft_length(161), 180);
  EXPECT_EQ(fast_fft_length(1061), 1080);
}

// The inner product of spectra is the circular correlation: checked against the sum it stands for,
// which pins the order of rows and columns, the sign of the lag and the scale.
TEST(RealFft2d, ProductOfSpectraIsCircularCorrelation) {
  for (const FftShape& shape : kShapes) {
    const auto a = random_image(shape, 1);
    const auto b = random_image(shape, 2);
    const auto fft = make_real_fft2d(shape);
    AlignedBuffer<std::complex<float>> spectrum_a(fft->spectrum_size());
    AlignedBuffer<std::complex<float>> spectrum_b(fft->spectrum_size());
    AlignedBuffer<float> got(fft->image_size());
    fft->forward(a.data(), spectrum_a.data());
    fft->forward(b.data(), spectrum_b.data());
    for (std::size_t i = 0; i < fft->spectrum_size(); ++i)
      spectrum_a[i] = std::conj(spectrum_a[i]) * spectrum_b[i];
    fft->inverse(spectrum_a.data(), got.data());
    const auto n = static_cast<float>(fft->image_size());
    for (int dy = 0; dy < shape.rows; ++dy) {
      if (dy > shape.output_edge_rows && dy < shape.rows - shape.output_edge_rows) continue;
      for (int dx = 0; dx < shape.cols; ++dx) {
        double want = 0.0;
        for (int y = 0; y < shape.rows; ++y) {
          for (int x = 0; x < shape.cols; ++x) {
            const auto from = static_cast<std::size_t>(y * shape.cols + x);
            const auto to = static_cast<std::size_t>((y + dy) % shape.rows * shape.cols +
                                                     (x + dx) % shape.cols);
            want += a[from] * b[to];
          }
        }
        ASSERT_NEAR(got[static_cast<std::size_t>(dy * shape.cols + dx)] / n, want, 2e-4)
            << dx << "," << dy << " of " << shape.cols << "x" << shape.rows;
      }
    }
  }
}

// The unread middle of one inverse must not leak into the next forward.
TEST(RealFft2d, ForwardDoesNotDependOnWhatCameBefore) {
  const FftShape shape = kShapes[1];
  const auto fft = make_real_fft2d(shape);
  const auto image = random_image(shape, 3);
  AlignedBuffer<std::complex<float>> first(fft->spectrum_size()), second(fft->spectrum_size());
  AlignedBuffer<float> ignored(fft->image_size());
  fft->forward(image.data(), first.data());
  fft->inverse(first.data(), ignored.data());
  fft->forward(image.data(), second.data());
  for (std::size_t i = 0; i < first.size(); ++i) ASSERT_EQ(first[i], second[i]) << i;
}

TEST(RealFft2d, PlansCanBeMadeInSeveralThreads) {
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([] {
      for (int i = 0; i < 8; ++i) {
        const auto fft = make_real_fft2d(kShapes[0]);
        AlignedBuffer<std::complex<float>> spectrum(fft->spectrum_size());
        fft->forward(random_image(kShapes[0], 4).data(), spectrum.data());
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
}

TEST(FftBackend, IsTheOneThatWasConfigured) { EXPECT_EQ(fft_backend(), LSV_FFT_BACKEND); }

}  // namespace
}  // namespace lsv
