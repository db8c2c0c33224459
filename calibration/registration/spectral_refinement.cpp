// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/registration/spectral_refinement.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <utility>
#include <vector>

#include "processing/image/cv_bridge.h"
#include "processing/image/parallel_rows.h"

namespace patina::calibration {
namespace {

using Complex = std::complex<double>;

constexpr int kSteps = 5, kTaperPx = 5;
constexpr int kCrowd_px = 65;  // what a speck is measured against
constexpr double kDone_px = 0.002;
constexpr double kHighestCycles = 0.35;  // a pixel; above it the smoothing has left nothing
constexpr double kSure = 3;  // standard errors by which a ring's coherence must stand out

cv::Mat meanOver(const cv::Mat& in, int side_px) {
  cv::Mat out;
  cv::boxFilter(in, out, CV_32F, {side_px, side_px}, {-1, -1}, true, cv::BORDER_REFLECT_101);
  return out;
}

// Median absolute deviation, as the standard deviation of a normal distribution, of a sample.
double spreadOf(const cv::Mat& values, const cv::Mat& weight) {
  std::vector<float> sizes;
  for (int y = 0; y < values.rows; y += 3)
    for (int x = 0; x < values.cols; x += 3)
      if (weight.at<float>(y, x) > 0) sizes.push_back(std::abs(values.at<float>(y, x)));
  if (sizes.empty()) return 0;
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  std::nth_element(sizes.begin(), middle, sizes.end());
  return 1.4826 * *middle;
}

// What is looked at: 1 within, falling to 0 towards whatever is left out and the picture's edges.
cv::Mat windowOf(const PreparedPicture& reference, const Agreement& agreement,
                 const Motion& at_level, SizePx frame) {
  const Image<std::uint8_t> agreeing = agreeingPixels(agreement, reference);
  const cv::Mat whole(frame.height, frame.width, CV_8U, cv::Scalar(255));
  cv::Mat inside, within, tapered;
  const cv::Mat matrix = (cv::Mat_<double>(2, 3) << 1, 0, at_level[2], 0, 1, at_level[5]);
  cv::warpAffine(whole, inside, matrix, {agreeing.width(), agreeing.height()},
                 cv::INTER_NEAREST | cv::WARP_INVERSE_MAP);
  cv::bitwise_and(inside, asMat(agreeing.view()), inside);
  // A hard edge would be the strongest thing in both pictures, and at the same place.
  const cv::Mat square(kTaperPx, kTaperPx, CV_8U, cv::Scalar(1));
  cv::erode(inside, within, square, {-1, -1}, 1, cv::BORDER_CONSTANT, cv::Scalar(0));
  within.convertTo(tapered, CV_32F, 1 / 255.0);
  return meanOver(tapered, kTaperPx);
}

// The mean of what the window shows.
cv::Mat meanWithin(const cv::Mat& values, const cv::Mat& window, int side_px) {
  const cv::Mat share = cv::max(meanOver(window, side_px), 1e-4);
  cv::Mat mean = meanOver(values.mul(window), side_px);
  cv::divide(mean, share, mean);
  return mean;
}

// Detail of log light under the window, without a mean. Where it stands far out of the rest, it is
// held back: a few specks, finer than the mosaic that samples them, would speak for all.
cv::Mat detailOf(const cv::Mat& light, const cv::Mat& window) {
  const int side = std::max(kWindowPx, std::min(light.rows, light.cols) / 4 | 1);
  cv::Mat detail = light - meanWithin(light, window, side);
  const double spread = spreadOf(detail, window);
  cv::Mat local = meanWithin(detail.mul(detail), window, kCrowd_px);
  local += 4 * spread * spread + 1e-12;
  cv::sqrt(local, local);
  cv::divide(detail, local, detail);
  detail -= detail.dot(window) / std::max(cv::sum(window)[0], 1e-9);
  return detail.mul(window);
}

struct Wave {
  double x, y;  // radians a pixel
  Complex cross;
  double own, seen;  // power
  std::size_t ring;
};

// Half of the spectrum: the other half says the same.
std::vector<Wave> wavesOf(const cv::Mat& own, const cv::Mat& seen, double per_ring) {
  // Both in one transform: what is even in the result is the one's, what is odd the other's.
  cv::Mat both, spectrum;
  const cv::Mat parts[] = {own, seen};
  cv::merge(parts, 2, both);
  const int rows = cv::getOptimalDFTSize(own.rows), columns = cv::getOptimalDFTSize(own.cols);
  cv::copyMakeBorder(both, both, 0, rows - own.rows, 0, columns - own.cols, cv::BORDER_CONSTANT,
                     cv::Scalar(0, 0));
  cv::dft(both, spectrum, 0, own.rows);
  std::vector<Wave> waves;
  const auto at = [&](int y, int x) {
    const auto& v = spectrum.at<cv::Vec2f>((y + rows) % rows, (x + columns) % columns);
    return Complex(v[0], v[1]);
  };
  const int y_most = static_cast<int>(kHighestCycles * rows),
            x_most = static_cast<int>(kHighestCycles * columns);
  for (int y = -y_most; y <= y_most; ++y)
    for (int x = 0; x <= x_most; ++x) {
      if (x == 0 && y <= 0) continue;
      const double fx = static_cast<double>(x) / columns, fy = static_cast<double>(y) / rows;
      const double f = std::hypot(fx, fy);
      if (f > kHighestCycles) continue;
      const Complex here = at(y, x), there = std::conj(at(-y, -x));
      const Complex r = 0.5 * (here + there), s = Complex(0, -0.5) * (here - there);
      constexpr double kTurn = 2 * std::numbers::pi;
      waves.push_back({kTurn * fx, kTurn * fy, std::conj(r) * s, std::norm(r), std::norm(s),
                       static_cast<std::size_t>(f / per_ring)});
    }
  return waves;
}

// C^2 / (1 - C^2) of each ring, and the same over its cross power.
struct Ring {
  double own = 0, seen = 0, cross = 0;
  int waves = 0;
  double weight = 0, weight_over_power = 0;
};

Complex turned(const Wave& wave, double x, double y) {
  return wave.cross * std::polar(1.0, wave.x * x + wave.y * y);
}

std::vector<Ring> ringsOf(const std::vector<Wave>& waves, double x, double y) {
  std::size_t count = 0;
  for (const Wave& wave : waves) count = std::max(count, wave.ring + 1);
  std::vector<Ring> rings(count);
  for (const Wave& wave : waves) {
    Ring& ring = rings[wave.ring];
    ring.own += wave.own, ring.seen += wave.seen, ring.cross += turned(wave, x, y).real();
    ++ring.waves;
  }
  for (Ring& ring : rings) {
    const double power = std::sqrt(ring.own * ring.seen);
    if (!(power > 0)) continue;
    const double coherence = std::min(ring.cross / power, 0.9999);
    if (coherence < kSure / std::sqrt(2.0 * ring.waves)) continue;
    const double squared = coherence * coherence;
    ring.weight = squared / (1 - squared);
    ring.weight_over_power = ring.weight * ring.waves / ring.cross;
  }
  return rings;
}

struct Normal {
  double xx = 0, xy = 0, yy = 0, x = 0, y = 0;
  double determinant() const { return xx * yy - xy * xy; }
};

Normal normalOf(const std::vector<Wave>& waves, const std::vector<Ring>& rings, double x,
                double y) {
  Normal n;
  for (const Wave& wave : waves) {
    const Ring& ring = rings[wave.ring];
    if (ring.weight <= 0) continue;
    const double w = 2 * ring.weight, off = 2 * ring.weight_over_power * turned(wave, x, y).imag();
    n.xx += w * wave.x * wave.x, n.xy += w * wave.x * wave.y, n.yy += w * wave.y * wave.y;
    n.x += off * wave.x, n.y += off * wave.y;
  }
  return n;
}

// Neighbouring frequencies under a window say the same: so much of a picture is a sample of its
// own.
double shareOfSamples(const cv::Mat& window, double padded) {
  const cv::Mat squared = window.mul(window);
  const double two = cv::sum(squared)[0], four = squared.dot(squared);
  return two * two / std::max(four * padded, 1e-9);
}

}  // namespace

SpectralShift refineBySpectrum(const PreparedPicture& reference, const PreparedPicture& frame,
                               const Motion& start, const Agreement& agreement) {
  SpectralShift out{start, std::numeric_limits<double>::infinity()};
  const auto at = static_cast<std::size_t>(agreement.level);
  const PictureLevel &own = reference.levels[at], &seen = frame.levels[at];
  Motion motion = atLevel(start, agreement.level);
  const cv::Mat window = windowOf(reference, agreement, motion, seen.size());
  if (cv::countNonZero(window) < kWindowPx * kWindowPx) return out;
  cv::Mat laid;
  const cv::Mat matrix = (cv::Mat_<double>(2, 3) << 1, 0, motion[2], 0, 1, motion[5]);
  cv::warpAffine(asMat(seen.log_light.view()), laid, matrix, {window.cols, window.rows},
                 cv::INTER_LANCZOS4 | cv::WARP_INVERSE_MAP, cv::BORDER_REFLECT_101);
  const double per_ring = 6.0 / std::min(window.rows, window.cols);
  const std::vector<Wave> waves =
      wavesOf(detailOf(asMat(own.log_light.view()), window), detailOf(laid, window), per_ring);
  double x = 0, y = 0;
  Normal n;
  for (int step = 0; step < kSteps; ++step) {
    n = normalOf(waves, ringsOf(waves, x, y), x, y);
    if (!(n.determinant() > 1e-6 * (n.xx + n.yy) * (n.xx + n.yy))) return out;
    const double by_x = (n.yy * n.x - n.xy * n.y) / n.determinant(),
                 by_y = (n.xx * n.y - n.xy * n.x) / n.determinant();
    x -= std::clamp(by_x, -1.0, 1.0), y -= std::clamp(by_y, -1.0, 1.0);
    if (std::hypot(by_x, by_y) < kDone_px) break;
  }
  const double samples = shareOfSamples(window, static_cast<double>(window.total()));
  out.uncertainty_px =
      std::sqrt((n.xx + n.yy) / (n.determinant() * samples)) * (1 << agreement.level);
  motion[2] += x, motion[5] += y;
  out.frame_from_reference = fromLevel(motion, agreement.level);
  return out;
}

}  // namespace patina::calibration
