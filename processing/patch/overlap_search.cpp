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
constexpr std::size_t kSurvivorsFew = 60;  // to sum: about what correlating a channel costs
constexpr std::size_t kFirst = 16;         // by bound, to know early what the best costs
constexpr double kMore = 1 + 1e-9;         // so that no rounding stops a sum at its limit
constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Rounding of a correlation by float FFT, relative to the product of the planes' norms. FFTW's
// error is about 2e-7 for any length; a factor of 5 is left.
constexpr double kRounding = 1e-6;

// Sum of (a - b)^2 in lanes, so that any machine adds in the same order.
[[gnu::always_inline]] inline float squaredDifferenceInLanes(const float* a, const float* b,
                                                             int count) {
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

using SquaredDifference = float (*)(const float*, const float*, int);
float squaredDifferencePlain(const float* a, const float* b, int count) {
  return squaredDifferenceInLanes(a, b, count);
}
#if defined(__x86_64__)
// The same additions, eight at a time.
[[gnu::target("avx2")]] float squaredDifferenceAvx2(const float* a, const float* b, int count) {
  return squaredDifferenceInLanes(a, b, count);
}
const SquaredDifference squaredDifference =
    __builtin_cpu_supports("avx2") ? squaredDifferenceAvx2 : squaredDifferencePlain;
#else
const SquaredDifference squaredDifference = squaredDifferencePlain;
#endif

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

namespace {

// sum += factor * f * conj(t). Written out: operator* of std::complex checks for infinities.
void addProduct(const Spectra::Spectrum& f, const Spectra::Spectrum& t, float factor,
                const tbb::blocked_range<std::size_t>& range, Spectra::Spectrum& sum) {
  const float *u = reinterpret_cast<const float*>(f.data()),
              *v = reinterpret_cast<const float*>(t.data());
  float* out = reinterpret_cast<float*>(sum.data());
  for (std::size_t i = 2 * range.begin(); i < 2 * range.end(); i += 2) {
    out[i] += factor * (u[i] * v[i] + u[i + 1] * v[i + 1]);
    out[i + 1] += factor * (u[i + 1] * v[i] - u[i] * v[i + 1]);
  }
}

}  // namespace

void OverlapSearch::prepareEnergies(ImageView<const std::uint8_t> known) {
  if (known_channels_ == correlated_ && known_.texels() == copyOf(known).texels()) return;
  known_ = copyOf(known);
  known_channels_ = correlated_;
  known_texels_ = 0;
  const int stride = spectra_.padded().width;
  Spectra::Spectrum mask;
  const auto fill = [&](float* plane) {
    forRuns(known, [&](int y, int first, int end) {
      std::fill(plane + static_cast<std::size_t>(y) * stride + first,
                plane + static_cast<std::size_t>(y) * stride + end, 1.0f);
      known_texels_ += end - first;
    });
  };
  spectra_.forward(block_.height, fill, mask);
  Spectra::Spectrum sum(energy_.size());
  addProduct(energy_, mask, 1, {0, sum.size()}, sum);
  spectra_.inverse(sum, energies_);
}

// |F - T|^2 = |F|^2 - 2 F T + |T|^2 over the leading channels: one inverse transform for all.
double OverlapSearch::lowerBounds(const Overlap& overlap) {
  prepareEnergies(overlap.known);
  const int stride = spectra_.padded().width, n = correlated_;
  std::vector<double> squares(n);
  target_.resize(n);
  tbb::parallel_for(0, n, [&](int c) {
    const auto fill = [&](float* plane) {
      forRuns(overlap.known, [&](int y, int first, int end) {
        for (int x = first; x < end; ++x) {
          const float v = overlap.target.at(x, y, c);
          plane[static_cast<std::size_t>(y) * stride + x] = v;
          squares[c] += static_cast<double>(v) * v;
        }
      });
    };
    spectra_.forward(block_.height, fill, target_[c]);
  });
  sum_.resize(energy_.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, sum_.size(), 4096), [&](const auto& range) {
    std::fill(sum_.begin() + range.begin(), sum_.begin() + range.end(), std::complex<float>());
    for (int c = 0; c < n; ++c) addProduct(channel_[c], target_[c], -2, range, sum_);
  });
  spectra_.inverse(sum_, bounds_);

  double constant = 0, slack = energy_norm_ * std::sqrt(static_cast<double>(known_texels_));
  for (int c = 0; c < n; ++c) {
    constant += squares[c];
    slack += 2 * channel_norm_[c] * std::sqrt(squares[c]);
  }
  const float all = static_cast<float>(constant);
  for (std::size_t i = 0; i < bounds_.size(); ++i) bounds_[i] += energies_[i] + all;
  return kRounding * (slack + constant);
}

double OverlapSearch::squaredDistance(const Overlap& overlap, int x, int y) const {
  return distanceUpTo(overlap, x, y, kInfinity);
}

double OverlapSearch::distanceUpTo(const Overlap& overlap, int x, int y, double limit) const {
  double sum = 0;
  forRuns(overlap.known, [&](int row, int first, int end) {
    if (sum > limit) return;
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
  // Above `limit` it may come out as anything above it.
  const auto costOf = [&](int x, int y, double limit) {
    const double weight = weightAt(terms, x, y);
    return weight *
           (terms.floor + distanceUpTo(overlap, x, y, limit / weight * kMore - terms.floor));
  };

  Candidate best{-1, -1, kInfinity};  // by bound; its true cost limits all others
  for (int y = 0; y < corners_.height; ++y)
    for (int x = 0; x < corners_.width; ++x)
      if (const double bound = boundOf(x, y); bound < best.cost) best = {x, y, bound};
  if (best.x < 0) return {};
  double limit = (1 + terms.tolerance) * costOf(best.x, best.y, kInfinity);

  std::vector<Candidate> survivors;  // with their bounds
  for (int y = 0; y < corners_.height; ++y)
    for (int x = 0; x < corners_.width; ++x)
      if (const double bound = boundOf(x, y); bound <= limit) survivors.push_back({x, y, bound});
  if (survivors.size() > kSurvivorsFew)
    correlateAtLeast(std::min(features_.channels, correlated_ + 1));
  // Some that promise most are summed first: what they cost spares most of the others.
  std::vector<Candidate> first = survivors;
  const auto cheaper = [](const Candidate& a, const Candidate& b) { return a.cost < b.cost; };
  const std::size_t few = std::min(kFirst, first.size());
  std::nth_element(first.begin(), first.begin() + static_cast<std::ptrdiff_t>(few) - 1, first.end(),
                   cheaper);
  for (std::size_t i = 0; i < few; ++i)
    limit = std::min(limit, (1 + terms.tolerance) * costOf(first[i].x, first[i].y, limit));
  std::erase_if(survivors, [&](const Candidate& c) { return !(c.cost <= limit); });

  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, survivors.size(), 16),
                    [&](const auto& range) {
                      for (std::size_t i = range.begin(); i < range.end(); ++i)
                        survivors[i].cost = costOf(survivors[i].x, survivors[i].y, limit);
                    });
  double least = kInfinity;
  for (const Candidate& c : survivors) least = std::min(least, c.cost);
  std::erase_if(survivors, [&](const Candidate& c) {
    return !(c.cost <= (1 + terms.tolerance) * least) || c.cost == kInfinity;
  });
  return survivors;
}

}  // namespace patina::patch
