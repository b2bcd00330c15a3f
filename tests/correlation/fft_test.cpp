// SPDX-License-Identifier: BSD-3-Clause
#include "correlation/fft.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <thread>
#include <utility>
#include <vector>

#include "correlation/aligned_buffer.h"
#include "correlation/kernels.h"

namespace lsv {
namespace {

// Odd and even, padded to more than is needed, all lags of the images and only one.
constexpr CorrelationSize kSizes[] = {{.width = 16, .height = 16, .max_dx = 7, .max_dy = 8},
                                      {.width = 27, .height = 13, .max_dx = 4, .max_dy = 3},
                                      {.width = 7, .height = 41, .max_dx = 6, .max_dy = 40},
                                      {.width = 12, .height = 5, .max_dx = 0, .max_dy = 0}};

struct Image {
  std::ptrdiff_t stride = 0;
  AlignedBuffer<float> values;

  float at(std::ptrdiff_t x, std::ptrdiff_t y) const {
    return values[static_cast<std::size_t>(y * stride + x)];
  }
};

/// Beyond the width, the rows hold what must not be read.
Image random_image(const CorrelationSize& size, unsigned seed) {
  Image out{
      .stride = size.width + 3,
      .values = AlignedBuffer<float>(static_cast<std::size_t>((size.width + 3) * size.height))};
  std::mt19937 random(seed);
  for (float& value : out.values.span())
    value = static_cast<float>(random() % 2001) / 1000.0F - 1.0F;
  return out;
}

AlignedBuffer<std::complex<float>> spectrum_of(const Image& image, SpectralCorrelation& fft) {
  AlignedBuffer<std::complex<float>> out(fft.spectrum_size());
  fft.forward(image.values.data(), image.stride, out.data());
  return out;
}

/// sum of a(x, y) * b(x + dx, y + dy) over the pixels that both have.
double correlation_at(const Image& a, const Image& b, const CorrelationSize& size, int dx, int dy) {
  double out = 0.0;
  for (int y = std::max(0, -dy); y < std::min(size.height, size.height - dy); ++y) {
    for (int x = std::max(0, -dx); x < std::min(size.width, size.width - dx); ++x)
      out += static_cast<double>(a.at(x, y)) * b.at(x + dx, y + dy);
  }
  return out;
}

TEST(FastFftLength, IsTheSmallestPowerOfTwoTimesOneThreeOrFive) {
  EXPECT_EQ(fast_fft_length(1), 4);
  EXPECT_EQ(fast_fft_length(96), 96);
  EXPECT_EQ(fast_fft_length(128), 128);
  EXPECT_EQ(fast_fft_length(129), 160);
  EXPECT_EQ(fast_fft_length(160), 160);
  EXPECT_EQ(fast_fft_length(161), 192);
  EXPECT_EQ(fast_fft_length(288), 320);
  EXPECT_EQ(fast_fft_length(1061), 1280);
}

TEST(ComplexFft, IsTheSumThatItStandsFor) {
  for (const int length : {4, 12, 20, 96}) {
    std::mt19937 random(6);
    AlignedBuffer<std::complex<float>> in(static_cast<std::size_t>(length));
    AlignedBuffer<std::complex<float>> out(in.size());
    for (std::complex<float>& value : in.span())
      value = {static_cast<float>(random() % 100) / 100.0F, static_cast<float>(random() % 7)};
    for (const auto& [direction, sign] :
         {std::pair{FftDirection::forward, -1.0}, {FftDirection::inverse, 1.0}}) {
      make_complex_fft(length, direction)->run(in.data(), out.data());
      for (int k = 0; k < length; ++k) {
        std::complex<double> want;
        for (int i = 0; i < length; ++i) {
          const double phase = sign * 2.0 * std::numbers::pi * (i * k % length) / length;
          want += std::complex<double>(in[static_cast<std::size_t>(i)]) * std::polar(1.0, phase);
        }
        const std::complex<double> got(out[static_cast<std::size_t>(k)]);
        ASSERT_NEAR(std::abs(got - want), 0.0, 2e-4) << k << " of " << length;
      }
    }
  }
}

// Pins the order of rows and columns, the sign of the lag, the scale, and that nothing wraps
// around.
TEST(SpectralCorrelation, IsTheSumOverTheOverlapAtEveryLag) {
  for (const CorrelationSize& size : kSizes) {
    const Image a = random_image(size, 1);
    const Image b = random_image(size, 2);
    SpectralCorrelation fft(size);
    AlignedBuffer<float> plane(
        static_cast<std::size_t>((2 * size.max_dx + 1) * (2 * size.max_dy + 1)));
    fft.correlate(spectrum_of(a, fft).data(), spectrum_of(b, fft).data(), kernels::multiply_conj,
                  plane.data());
    std::size_t i = 0;
    for (int dy = -size.max_dy; dy <= size.max_dy; ++dy) {
      for (int dx = -size.max_dx; dx <= size.max_dx; ++dx) {
        ASSERT_NEAR(plane[i++] / fft.scale(), correlation_at(a, b, size, dx, dy), 2e-5)
            << dx << "," << dy << " of " << size.width << "x" << size.height;
      }
    }
  }
}

// What correlate() leaves in the scratch memory must not leak into the next forward().
TEST(SpectralCorrelation, ForwardDoesNotDependOnWhatCameBefore) {
  for (const CorrelationSize& size : kSizes) {
    const Image image = random_image(size, 3);
    SpectralCorrelation fft(size);
    const auto first = spectrum_of(image, fft);
    AlignedBuffer<float> ignored(
        static_cast<std::size_t>((2 * size.max_dx + 1) * (2 * size.max_dy + 1)));
    fft.correlate(first.data(), first.data(), kernels::multiply_conj, ignored.data());
    const auto second = spectrum_of(image, fft);
    for (std::size_t i = 0; i < first.size(); ++i) ASSERT_EQ(first[i], second[i]) << i;
  }
}

TEST(SpectralCorrelation, TwoObjectsGiveTheSameBits) {
  for (const CorrelationSize& size : kSizes) {
    const Image image = random_image(size, 4);
    SpectralCorrelation one(size), other(size);
    const auto first = spectrum_of(image, one);
    const auto second = spectrum_of(image, other);
    for (std::size_t i = 0; i < first.size(); ++i) ASSERT_EQ(first[i], second[i]) << i;
  }
}

TEST(SpectralCorrelation, CanBeMadeInSeveralThreads) {
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([] {
      for (int i = 0; i < 8; ++i) {
        SpectralCorrelation fft(kSizes[0]);
        spectrum_of(random_image(kSizes[0], 4), fft);
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
}

TEST(FftBackend, IsTheOneThatWasConfigured) { EXPECT_EQ(fft_backend(), LSV_FFT_BACKEND); }

}  // namespace
}  // namespace lsv
