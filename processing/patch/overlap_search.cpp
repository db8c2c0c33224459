// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/patch/overlap_search.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace patina::patch {
namespace {

constexpr int kLanes = 8;  // of a sum, fixed: the order of additions is part of the result
constexpr std::size_t kSurvivorsFew = 1500;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Rounding of a correlation by float FFT, relative to the product of the planes' norms. FFTW's
// error is about 2e-7 for any length; a factor of 5 is left.
constexpr double kRounding = 1e-6;

// Sum of (a - b)^2 in lanes: the compiler makes vectors of it, in the same order on any machine.
float squaredDifference(const float* a, const float* b, int count) {
  float lanes[kLanes] = {};
  int i = 0;
  for (; i + kLanes <= count; i += kLanes)
    for (int lane = 0; lane < kLanes; ++lane) {
      const float d = a[i + lane] - b[i + lane];
      lanes[lane] += d * d;
    }
  float rest = 0;
  for (; i < count; ++i) rest += (a[i] - b[i]) * (a[i] - b[i]);
  return ((lanes[0] + lanes[4]) + (lanes[1] + lanes[5])) +
         ((lanes[2] + lanes[6]) + (lanes[3] + lanes[7])) + rest;
}

// Calls use(row, first, end) for each run of known texels, in raster order.
template <class Use>
void forRuns(ImageView<const std::uint8_t> known, const Use& use) {
  for (int y = 0; y < known.height; ++y)
    for (int x = 0; x < known.width;) {
      if (!known.at(x, y)) {
        ++x;
        continue;
      }
      int end = x;
      while (end < known.width && known.at(end, y)) ++end;
      use(y, x, end);
      x = end;
    }
}

double weightAt(const SearchTerms& terms, int x, int y) {
  return terms.weight.empty() ? 1.0 : terms.weight.at(x, y);
}

}  // namespace

OverlapSearch::OverlapSearch(ImageView<const float> features, SizePx block)
    : features_(features),
      block_(block),
      corners_{features.width - block.width + 1, features.height - block.height + 1},
      spectra_(features.size()) {
  PATINA_CHECK(block.width >= 1 && block.height >= 1 && corners_.width >= 1 &&
               corners_.height >= 1 && features.channels >= 1);
  energy_plane_.resize(static_cast<std::size_t>(features.width) * features.height);
  correlateAtLeast(std::min(2, features.channels));
}

void OverlapSearch::correlateAtLeast(int channels) {
  const int width = features_.width, height = features_.height, stride = spectra_.padded().width;
  const int from = correlated_;
  if (channels <= from) return;
  channel_.resize(channels);
  channel_norm_.resize(channels);
  tbb::parallel_for(from, channels, [&](int c) {
    double norm = 0;
    const auto fill = [&](float* plane) {
      for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
          const float v = features_.at(x, y, c);
          plane[static_cast<std::size_t>(y) * stride + x] = v;
          norm += static_cast<double>(v) * v;
        }
    };
    spectra_.forward(height, fill, channel_[c]);
    channel_norm_[c] = std::sqrt(norm);
  });
  double norm = 0;
  const auto fill = [&](float* plane) {
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        float& e = energy_plane_[static_cast<std::size_t>(y) * width + x];
        for (int c = from; c < channels; ++c) e += features_.at(x, y, c) * features_.at(x, y, c);
        plane[static_cast<std::size_t>(y) * stride + x] = e;
        norm += static_cast<double>(e) * e;
      }
  };
  spectra_.forward(height, fill, energy_);
  energy_norm_ = std::sqrt(norm);
  correlated_ = channels;
}

// |F - T|^2 = |F|^2 - 2 F T + |T|^2 over the leading channels: one inverse transform for all.
double OverlapSearch::lowerBounds(const Overlap& overlap) {
  const int stride = spectra_.padded().width, n = correlated_;
  std::vector<double> squares(n + 1);
  target_.resize(n + 1);
  tbb::parallel_for(0, n + 1, [&](int c) {  // the last is the mask
    const auto fill = [&](float* plane) {
      forRuns(overlap.known, [&](int y, int first, int end) {
        for (int x = first; x < end; ++x) {
          const float v = c < n ? overlap.target.at(x, y, c) : 1.0f;
          plane[static_cast<std::size_t>(y) * stride + x] = v;
          squares[c] += static_cast<double>(v) * v;
        }
      });
    };
    spectra_.forward(block_.height, fill, target_[c]);
  });

  sum_.resize(energy_.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, sum_.size(), 4096), [&](const auto& range) {
    const auto add = [&](const Spectra::Spectrum& f, const Spectra::Spectrum& t, float factor) {
      // Written out: operator* of std::complex checks for infinities.
      for (std::size_t i = range.begin(); i < range.end(); ++i) {
        const float a = f[i].real(), b = f[i].imag(), p = t[i].real(), q = t[i].imag();
        sum_[i] += std::complex<float>(factor * (a * p + b * q), factor * (b * p - a * q));
      }
    };
    std::fill(sum_.begin() + range.begin(), sum_.begin() + range.end(), std::complex<float>());
    add(energy_, target_[n], 1);
    for (int c = 0; c < n; ++c) add(channel_[c], target_[c], -2);
  });
  spectra_.inverse(sum_, bounds_);

  double constant = 0, slack = energy_norm_ * std::sqrt(squares[n]);
  for (int c = 0; c < n; ++c) {
    constant += squares[c];
    slack += 2 * channel_norm_[c] * std::sqrt(squares[c]);
  }
  for (float& v : bounds_) v += static_cast<float>(constant);
  return kRounding * (slack + constant);
}

double OverlapSearch::squaredDistance(const Overlap& overlap, int x, int y) const {
  double sum = 0;
  forRuns(overlap.known, [&](int row, int first, int end) {
    sum += squaredDifference(&features_.at(x + first, y + row), &overlap.target.at(first, row),
                             (end - first) * features_.channels);
  });
  return sum;
}

std::vector<Candidate> OverlapSearch::candidates(const Overlap& overlap, const SearchTerms& terms) {
  PATINA_CHECK(overlap.target.size() == block_ && overlap.known.size() == block_ &&
               overlap.target.channels == features_.channels && terms.tolerance >= 0);
  const double slack = lowerBounds(overlap);
  const int stride = spectra_.padded().width;
  const auto boundOf = [&](int x, int y) {
    const double least = bounds_[static_cast<std::size_t>(y) * stride + x] - slack;
    return weightAt(terms, x, y) * (terms.floor + std::max(0.0, least));
  };
  const auto costOf = [&](int x, int y) {
    return weightAt(terms, x, y) * (terms.floor + squaredDistance(overlap, x, y));
  };

  Candidate best{-1, -1, kInfinity};  // by bound; its true cost limits all others
  for (int y = 0; y < corners_.height; ++y)
    for (int x = 0; x < corners_.width; ++x)
      if (const double bound = boundOf(x, y); bound < best.cost) best = {x, y, bound};
  if (best.x < 0) return {};
  const double limit = (1 + terms.tolerance) * costOf(best.x, best.y);

  std::vector<Candidate> survivors;
  for (int y = 0; y < corners_.height; ++y)
    for (int x = 0; x < corners_.width; ++x)
      if (boundOf(x, y) <= limit) survivors.push_back({x, y, 0});
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, survivors.size(), 16),
                    [&](const auto& range) {
                      for (std::size_t i = range.begin(); i < range.end(); ++i)
                        survivors[i].cost = costOf(survivors[i].x, survivors[i].y);
                    });
  double least = kInfinity;
  for (const Candidate& c : survivors) least = std::min(least, c.cost);
  if (survivors.size() > kSurvivorsFew)
    correlateAtLeast(std::min(features_.channels, 2 * correlated_));
  std::erase_if(survivors, [&](const Candidate& c) {
    return !(c.cost <= (1 + terms.tolerance) * least) || c.cost == kInfinity;
  });
  return survivors;
}

}  // namespace patina::patch
