// SPDX-License-Identifier: BSD-3-Clause
#include "correlation/row_probe.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "correlation/speckle_kernel.h"

namespace lsv {
namespace {

// With fewer columns there is no speckle to speak of.
constexpr int kLeastHalf_px = 12;
// Both steps are odd, so that both fields of interlaced frames are probed. A glance at few rows
// will do for most frames; the others are looked at more closely.
constexpr int kGlanceRows = 10;
constexpr int kLeastStep_px = 3;
// With fewer rows nothing stands out from chance.
constexpr int kLeastRows = 12;
// Half rows with less pattern than this share of the mean have no say.
constexpr double kLeastShare = 0.02;
// Rows that agree to this need no closer look: less than what could matter.
constexpr double kNoMove_px = 0.009;
constexpr double kNoChange = 0.007;  // residual variance / variance of the pattern
constexpr double kMostGain = 15.0;
// Gradients are sums of two frames over two pixels.
constexpr double kPxPerStep = 4.0;

/// Weighted sums over the rows of two profiles, each to be freed of a polynomial in the row.
class CommonPart {
 public:
  /// `t` in [-1, 1].
  void add(double t, double weight, double left, double right) {
    double power = weight;
    for (double& moment : moments_) {
      moment += power;
      power *= t;
    }
    double step = weight;
    for (std::size_t k = 0; k < kTerms; ++k) {
      left_[k] += step * left;
      right_[k] += step * right;
      step *= t;
    }
    ll_ += weight * left * left;
    rr_ += weight * right * right;
    lr_ += weight * left * right;
    weight_squares_ += weight * weight;
  }

  /// Takes out a polynomial with that many terms, at most kTerms.
  void take_out(std::size_t terms) {
    // Cholesky of the moments; the projections shrink the sums one by one.
    std::array<std::array<double, kTerms>, kTerms> factor{};
    std::array<double, kTerms> a{}, b{};
    for (std::size_t i = 0; i < terms; ++i) {
      for (std::size_t j = 0; j <= i; ++j) {
        double sum = moments_[i + j];
        for (std::size_t k = 0; k < j; ++k) sum -= factor[i][k] * factor[j][k];
        if (i == j)
          factor[i][i] = std::sqrt(std::max(sum, 1e-12 * moments_[0]));
        else
          factor[i][j] = sum / factor[j][j];
      }
      a[i] = left_[i], b[i] = right_[i];
      for (std::size_t k = 0; k < i; ++k) {
        a[i] -= factor[i][k] * a[k];
        b[i] -= factor[i][k] * b[k];
      }
      a[i] /= factor[i][i], b[i] /= factor[i][i];
      ll_ -= a[i] * a[i];
      rr_ -= b[i] * b[i];
      lr_ -= a[i] * b[i];
    }
    taken_out_ = static_cast<double>(terms);
  }

  double ll() const { return std::max(ll_, 0.0); }
  double rr() const { return std::max(rr_, 0.0); }
  double lr() const { return lr_; }
  double weight() const { return moments_[0]; }
  /// Independent pairs, when a row tells `share` of what an independent one would.
  double freedoms(double share) const {
    return share * moments_[0] * moments_[0] / weight_squares_ - taken_out_;
  }

 private:
  static constexpr std::size_t kTerms = 3;
  std::array<double, 2 * kTerms - 1> moments_{};
  std::array<double, kTerms> left_{}, right_{};
  double ll_ = 0.0, rr_ = 0.0, lr_ = 0.0;
  double weight_squares_ = 0.0;
  double taken_out_ = 0.0;
};

double fisher_sigmas(double lr, double ll, double rr, double freedoms) {
  if (!(ll > 0.0) || !(rr > 0.0) || !(freedoms > 3.0)) return 0.0;
  const double r = std::clamp(lr / std::sqrt(ll * rr), -0.999999, 0.999999);
  return std::atanh(r) * std::sqrt(freedoms - 3.0);
}

std::int16_t to_steps(double counts, int bit_depth) {
  const double steps = std::ldexp(counts, kernels::kProbeBits - bit_depth);
  return static_cast<std::int16_t>(std::lround(std::clamp(steps, -4096.0, 4096.0)));
}

int odd_step(int height_px, int rows) { return std::max(kLeastStep_px, (height_px / rows) | 1); }
int rows_at(int height_px, int step_px) { return (height_px + step_px - 1) / step_px; }

/// Lagrange, five points: the value at -fraction.
std::array<std::int16_t, kernels::kProbeTaps> interpolation_weights(double fraction_px) {
  // Product of the distances of a point from the others.
  constexpr std::array<double, kernels::kProbeTaps> kDistances{24.0, -6.0, 4.0, -6.0, 24.0};
  static_assert(kernels::kProbeReach_px == 2);
  const double at = -std::clamp(fraction_px, -1.0, 1.0);
  std::array<std::int16_t, kernels::kProbeTaps> out{};
  for (int i = 0; i < kernels::kProbeTaps; ++i) {
    double weight = 32768.0;
    for (int k = 0; k < kernels::kProbeTaps; ++k) {
      if (k != i) weight *= at - (k - kernels::kProbeReach_px);
    }
    const auto place = static_cast<std::size_t>(i);
    out[place] =
        static_cast<std::int16_t>(std::min(32767L, std::lround(weight / kDistances[place])));
  }
  return out;
}

/// What tells at once whether the rows agree.
struct Glance {
  double variance = 0.0;  // of the shifts of rows, steps^2, a straight line left in
  double rr = 0.0, pp = 0.0;
  double xx = 0.0, yy = 0.0;
};

/// Products of left and right along one axis.
class AxisProducts {
 public:
  void add(double l_score, double l_square, double r_score, double r_square) {
    scores_ += l_score * r_score;
    mixed_ += l_score * r_square + r_score * l_square;
    squares_ += l_square * r_square;
    score_ += l_score + r_score;
    square_ += l_square + r_square;
  }
  double square() const { return square_; }
  double variance() const {
    const double mean = score_ / square_;
    return (scores_ - mean * mixed_ + mean * mean * squares_) / squares_;
  }

 private:
  double scores_ = 0.0, mixed_ = 0.0, squares_ = 0.0;
  double score_ = 0.0, square_ = 0.0;
};

Glance glance_at(const kernels::ProbedRow* rows, int count) {
  AxisProducts x, y;
  Glance out;
  for (int i = 0; i < count; ++i) {
    const kernels::ProbeHalf& l = rows[i].left;
    const kernels::ProbeHalf& r = rows[i].right;
    x.add(l.rx, l.xx, r.rx, r.xx);
    y.add(l.ry, l.yy, r.ry, r.yy);
    out.rr += static_cast<double>(l.rr) + static_cast<double>(r.rr);
    out.pp += static_cast<double>(l.pp) + static_cast<double>(r.pp);
  }
  out.variance = x.variance() + y.variance();
  out.xx = x.square();
  out.yy = y.square();
  return out;
}

/// Of n pixels; 0 where either side is constant. The later frame is r + p.
double zncc_of(const kernels::ProbeHalf& half, double n) {
  const auto r = static_cast<double>(half.r), p = static_cast<double>(half.p);
  const double pp = static_cast<double>(half.pp) - p * p / n;
  const double rp = static_cast<double>(half.rp) - r * p / n;
  const double rr = static_cast<double>(half.rr) - r * r / n;
  const double later = rr + 2.0 * rp + pp;
  return pp > n && later > n ? (pp + rp) / std::sqrt(pp * later) : 0.0;
}

/// One Gauss-Newton step of half a row, in 1/kPxPerStep px.
struct Step {
  bool is_known = false;
  double x = 0.0, y = 0.0;
};
Step step_of(const kernels::ProbeHalf& half) {
  constexpr double kLeastDeterminant = 0.2;  // of what it is when the gradients do not correlate
  const double xx = half.xx, xy = half.xy, yy = half.yy;
  const double det = xx * yy - xy * xy;
  if (!(det > kLeastDeterminant * xx * yy)) return {};
  const double rx = half.rx, ry = half.ry;
  return {true, (yy * rx - xy * ry) / det, (xx * ry - xy * rx) / det};
}

double likeness(double zncc) { return std::clamp((zncc - 0.3) / 0.5, 0.0, 1.0); }

RowAgreement agreement_of(const kernels::ProbedRow* rows, int count, int half_px,
                          const Glance& mean, double independent_share) {
  const double halves = 2.0 * count;
  CommonPart x, y, change;
  for (int i = 0; i < count; ++i) {
    const kernels::ProbeHalf& l = rows[i].left;
    const kernels::ProbeHalf& r = rows[i].right;
    const double t = (2.0 * i - (count - 1)) / (count - 1);
    const Step l_step = step_of(l), r_step = step_of(r);
    if (std::min({l.xx, r.xx}) * halves > kLeastShare * mean.xx &&
        std::min({l.yy, r.yy}) * halves > kLeastShare * mean.yy && l_step.is_known &&
        r_step.is_known) {
      x.add(t, std::sqrt(static_cast<double>(l.xx) * r.xx), l_step.x, r_step.x);
      y.add(t, std::sqrt(static_cast<double>(l.yy) * r.yy), l_step.y, r_step.y);
    }
    const double l_pattern = l.pp, r_pattern = r.pp;
    if (std::min(l_pattern, r_pattern) * halves > kLeastShare * mean.pp)
      change.add(t, std::sqrt(l_pattern * r_pattern), likeness(zncc_of(l, half_px)),
                 likeness(zncc_of(r, half_px)));
  }
  RowAgreement out;
  if (!(x.weight() > 0.0) || !(y.weight() > 0.0) || !(change.weight() > 0.0)) return out;
  x.take_out(2);
  y.take_out(2);
  change.take_out(1);
  out.moved_px = kPxPerStep * std::sqrt(std::max(0.0, x.lr() / x.weight() + y.lr() / y.weight()));
  const double scale = x.weight() / y.weight();
  out.moved_sigmas =
      fisher_sigmas(x.lr() + scale * y.lr(), x.ll() + scale * y.ll(), x.rr() + scale * y.rr(),
                    x.freedoms(independent_share) + y.freedoms(independent_share));
  out.changed = std::sqrt(std::max(0.0, change.lr() / change.weight()));
  out.changed_sigmas =
      fisher_sigmas(change.lr(), change.ll(), change.rr(), change.freedoms(independent_share));
  return out;
}

}  // namespace

RowAgreement RowProbe::measure(const TrackFrame& earlier, const TrackFrame& later,
                               const LagWindow& window, const Peak& peak) {
  const FrameFormat& format = later.format();
  // The earlier frame is interpolated, the later one differentiated.
  constexpr int kReach_px = kernels::kProbeReach_px;
  const int left = std::max(1, window.dx_px + kReach_px);
  const int right = std::min(format.width_px - 1, format.width_px + window.dx_px - kReach_px);
  const int top = std::max(1, window.dy_px + kReach_px);
  const int bottom = std::min(format.height_px - 1, format.height_px + window.dy_px - kReach_px);
  const int width = right - left, height = bottom - top;
  const int half_px = kernels::probe_half_px(width);
  if (half_px < kLeastHalf_px || height < kLeastRows * kLeastStep_px ||
      !(window.gain > 0.0 && window.gain < kMostGain))
    return {};
  const double later_mean_counts = window.gain * window.earlier_mean_counts + window.offset_counts;
  const kernels::ProbeMap map{
      .bit_depth = format.bit_depth,
      .weights_x = interpolation_weights(peak.dx_px - window.dx_px),
      .weights_y = interpolation_weights(peak.dy_px - window.dy_px),
      .gain_2048 = static_cast<std::int16_t>(std::lround(2048.0 * window.gain)),
      .earlier_mean = to_steps(window.gain * window.earlier_mean_counts, format.bit_depth),
      .later_mean = to_steps(later_mean_counts, format.bit_depth)};
  const auto probe = [&]<typename Pixel>(Pixel, int step_px) {
    const kernels::Plane<const Pixel> a = earlier.pixels<Pixel>(), b = later.pixels<Pixel>();
    kernels::probe_rows<Pixel>({a.at(left - window.dx_px, top - window.dy_px), a.stride},
                               {b.at(left, top), b.stride}, width, rows_at(height, step_px),
                               step_px, map, rows_.data());
  };
  const auto probe_every = [&](int step_px) {
    if (format.type == PixelType::mono8)
      probe(std::uint8_t{}, step_px);
    else
      probe(std::uint16_t{}, step_px);
    return glance_at(rows_.data(), rows_at(height, step_px));
  };

  const int glance_px = odd_step(height, kGlanceRows);
  Glance glance = probe_every(glance_px);
  const double no_move = kNoMove_px / kPxPerStep;
  if (glance.variance < no_move * no_move && glance.rr < kNoChange * glance.pp) return {};
  const int step_px = odd_step(height, kMostRows);
  if (step_px != glance_px) glance = probe_every(step_px);
  // Patterns are alike over their width; their squares, which is what counts here, over less.
  const double alike_px = speckle_fwhm_px(peak.shape.yy_px2) / std::sqrt(2.0);
  const double share = std::clamp(step_px / alike_px, 0.1, 1.0);
  return agreement_of(rows_.data(), rows_at(height, step_px), half_px, glance, share);
}

}  // namespace lsv
