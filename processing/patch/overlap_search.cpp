// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/patch/overlap_search.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "processing/patch/squared_difference.h"

namespace patina::patch {
namespace {

// What correlating one more channel costs, in survivors that are summed; a mean over about as many
// queries as `kMemory` is held against it.
constexpr double kSurvivorsOfAChannel = 40, kMemory = 32;
constexpr std::size_t kFirst = 8;        // by bound, to know early what the best costs
constexpr std::size_t kAlone = 32;       // survivors that are not worth waking another thread
constexpr double kMore = 1 + 1e-9;       // so that no rounding stops a sum at its limit
constexpr double kBoundRounding = 1e-6;  // of a weighted bound in float
constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Rounding of a correlation by float FFT, relative to the product of the planes' norms. FFTW's
// error is about 2e-7 for any length; a factor of 5 is left.
constexpr double kRounding = 1e-6;

// bounds[x] = weight[x] * (floor + max(0, correlation[x] + energy[x] + constant)); the least of
// them. No weights: 1.
struct BoundRow {
  const float *correlation, *energy, *weight;
  float constant, floor;
};
[[gnu::always_inline]] inline float boundsInLanes(const BoundRow& in, int count, float* bounds) {
  for (int x = 0; x < count; ++x) {
    const float distance = in.correlation[x] + in.energy[x] + in.constant;
    bounds[x] = in.floor + (distance > 0 ? distance : 0);
  }
  if (in.weight)
    for (int x = 0; x < count; ++x) bounds[x] *= in.weight[x];
  constexpr int kLanes = 8;
  float least[kLanes];
  std::fill(least, least + kLanes, std::numeric_limits<float>::infinity());
  int x = 0;
  for (; x + kLanes <= count; x += kLanes)
    for (int lane = 0; lane < kLanes; ++lane)
      least[lane] = bounds[x + lane] < least[lane] ? bounds[x + lane] : least[lane];
  for (; x < count; ++x) least[0] = bounds[x] < least[0] ? bounds[x] : least[0];
  return *std::min_element(least, least + kLanes);
}

using DifferenceOfRows = float (*)(const float*, const float*, int);
using Bounds = float (*)(const BoundRow&, int, float*);
float differencePlain(const float* a, const float* b, int count) {
  return squaredDifference(a, b, count);
}
float boundsPlain(const BoundRow& in, int count, float* bounds) {
  return boundsInLanes(in, count, bounds);
}
#if defined(__x86_64__)
// The same additions, eight at a time.
[[gnu::target("avx2")]] float differenceAvx2(const float* a, const float* b, int count) {
  return squaredDifference(a, b, count);
}
[[gnu::target("avx2")]] float boundsAvx2(const BoundRow& in, int count, float* bounds) {
  return boundsInLanes(in, count, bounds);
}
const DifferenceOfRows differenceOfRows =
    __builtin_cpu_supports("avx2") ? differenceAvx2 : differencePlain;
const Bounds boundsOfRow = __builtin_cpu_supports("avx2") ? boundsAvx2 : boundsPlain;
#else
const DifferenceOfRows differenceOfRows = differencePlain;
const Bounds boundsOfRow = boundsPlain;
#endif

double weightAt(const SearchTerms& terms, int x, int y) {
  return terms.weight.empty() ? 1.0 : terms.weight.at(x, y);
}

bool isSame(ImageView<const std::uint8_t> a, ImageView<const std::uint8_t> b) {
  if (a.size() != b.size()) return false;
  for (int y = 0; y < a.height; ++y)
    if (!std::equal(a.row(y), a.row(y) + a.width, b.row(y))) return false;
  return true;
}

}  // namespace

// In raster order.
std::vector<OverlapSearch::Run> OverlapSearch::runsOf(ImageView<const std::uint8_t> known) {
  std::vector<Run> runs;
  for (int y = 0; y < known.height; ++y)
    for (int x = 0; x < known.width;) {
      if (!known.at(x, y)) {
        ++x;
        continue;
      }
      int end = x;
      while (end < known.width && known.at(end, y)) ++end;
      runs.push_back({y, x, end});
      x = end;
    }
  return runs;
}

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
  const auto at = [&](int x, int y) { return static_cast<std::size_t>(y) * stride + x; };
  const std::size_t padded = at(0, height);
  tbb::parallel_for(from, channels, [&](int c) {
    Spectra::Plane plane(padded);
    double norm = 0;
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const float v = features_.at(x, y, c);
        plane[at(x, y)] = v;
        norm += static_cast<double>(v) * v;
      }
    spectra_.forward(plane, channel_[c]);
    channel_norm_[c] = std::sqrt(norm);
  });
  Spectra::Plane plane(padded);
  double norm = 0;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      float& e = energy_plane_[static_cast<std::size_t>(y) * width + x];
      for (int c = from; c < channels; ++c) e += features_.at(x, y, c) * features_.at(x, y, c);
      plane[at(x, y)] = e;
      norm += static_cast<double>(e) * e;
    }
  energy_.resize(1);
  spectra_.forward(plane, energy_[0]);
  energy_norm_ = std::sqrt(norm);
  correlated_ = channels;
}

void OverlapSearch::prepare(ImageView<const std::uint8_t> known) {
  if (known_channels_ == correlated_ && isSame(known_.view(), known)) return;
  known_ = copyOf(known);
  known_channels_ = correlated_;
  known_texels_ = 0;
  runs_ = runsOf(known);
  const int stride = spectra_.padded().width;
  const std::size_t rows = static_cast<std::size_t>(block_.height) * stride;
  target_.assign(correlated_, Spectra::Plane(rows));
  std::vector<Spectra::Plane> mask{Spectra::Plane(rows)};
  for (const Run& run : runs_) {
    float* row = mask[0].data() + static_cast<std::ptrdiff_t>(run.y) * stride;
    std::fill(row + run.first, row + run.end, 1.0f);
    known_texels_ += run.end - run.first;
  }
  const auto [columns, count] = corners_;
  energies_.resize(static_cast<std::size_t>(columns) * count);
  bounds_.resize(energies_.size());
  row_least_.resize(count);
  spectra_.correlate(mask, energy_, 1, count, room_, [&, width = columns](int y, const float* row) {
    std::copy_n(row, width, energies_.begin() + static_cast<std::ptrdiff_t>(y) * width);
  });
}

double OverlapSearch::slackOf(std::span<const double> squares) const {
  double slack = energy_norm_ * std::sqrt(static_cast<double>(known_texels_));
  for (int c = 0; c < correlated_; ++c)
    slack += 2 * channel_norm_[c] * std::sqrt(squares[c]) + squares[c];
  return kRounding * slack;
}

// |F - T|^2 = |F|^2 - 2 F T + |T|^2 over the leading channels: one inverse transform for all.
void OverlapSearch::lowerBounds(const Overlap& overlap, const SearchTerms& terms) {
  prepare(overlap.known);
  const int stride = spectra_.padded().width, n = correlated_;
  std::vector<double> squares(n);
  double constant = 0;
  for (int c = 0; c < n; ++c) {
    for (const Run& run : runs_) {
      float* row = target_[c].data() + static_cast<std::ptrdiff_t>(run.y) * stride;
      for (int x = run.first; x < run.end; ++x) {
        row[x] = overlap.target.at(x, run.y, c);
        squares[c] += static_cast<double>(row[x]) * row[x];
      }
    }
    constant += squares[c];
  }
  const auto all = static_cast<float>(constant - slackOf(squares)),
             floor = static_cast<float>(terms.floor);
  const int width = corners_.width;
  spectra_.correlate(target_, channel_, -2, corners_.height, room_, [&](int y, const float* row) {
    const std::ptrdiff_t at = static_cast<std::ptrdiff_t>(y) * width;
    const float* weight = terms.weight.empty() ? nullptr : terms.weight.row(y);
    row_least_[y] =
        boundsOfRow({row, energies_.data() + at, weight, all, floor}, width, bounds_.data() + at);
  });
}

double OverlapSearch::squaredDistance(const Overlap& overlap, int x, int y) const {
  return distanceUpTo(overlap.target, runsOf(overlap.known), x, y, kInfinity);
}

double OverlapSearch::distanceUpTo(ImageView<const float> target, std::span<const Run> runs, int x,
                                   int y, double limit) const {
  double sum = 0;
  for (const Run& run : runs) {
    if (sum > limit) break;
    sum += differenceOfRows(&features_.at(x + run.first, y + run.y), &target.at(run.first, run.y),
                            (run.end - run.first) * features_.channels);
  }
  return sum;
}

std::vector<Candidate> OverlapSearch::atMost(double limit) const {
  const auto most = static_cast<float>(limit * (1 + kBoundRounding));
  std::vector<Candidate> found;
  for (int y = 0; y < corners_.height; ++y) {
    if (!(row_least_[y] <= most)) continue;
    const float* row = bounds_.data() + static_cast<std::ptrdiff_t>(y) * corners_.width;
    for (int x = 0; x < corners_.width; ++x)
      if (row[x] <= most) found.push_back({x, y, row[x]});
  }
  return found;
}

void OverlapSearch::learnFrom(std::size_t survivors) {
  survivors_mean_ += (static_cast<double>(survivors) - survivors_mean_) / kMemory;
  if (survivors_mean_ <= kSurvivorsOfAChannel || correlated_ == features_.channels) return;
  correlateAtLeast(correlated_ + 1);
  survivors_mean_ = 0;
}

std::vector<Candidate> OverlapSearch::candidates(const Overlap& overlap, const SearchTerms& terms) {
  PATINA_CHECK(overlap.target.size() == block_ && overlap.known.size() == block_ &&
               overlap.target.channels == features_.channels && terms.tolerance >= 0);
  lowerBounds(overlap, terms);
  // Above `limit` it may come out as anything above it.
  const auto costOf = [&](const Candidate& c, double limit) {
    const double weight = weightAt(terms, c.x, c.y), most = limit / weight * kMore - terms.floor;
    return weight * (terms.floor + distanceUpTo(overlap.target, runs_, c.x, c.y, most));
  };

  // The true cost of the best by bound limits all others.
  const float least_bound = *std::min_element(row_least_.begin(), row_least_.end());
  if (!std::isfinite(least_bound)) return {};
  double limit = (1 + terms.tolerance) * costOf(atMost(least_bound).front(), kInfinity);

  std::vector<Candidate> survivors = atMost(limit);
  learnFrom(survivors.size());
  // Some that promise most are summed first: what they cost spares most of the others.
  std::vector<Candidate> first = survivors;
  const auto cheaper = [](const Candidate& a, const Candidate& b) { return a.cost < b.cost; };
  const std::size_t few = std::min(kFirst, first.size());
  std::nth_element(first.begin(), first.begin() + static_cast<std::ptrdiff_t>(few) - 1, first.end(),
                   cheaper);
  for (std::size_t i = 0; i < few; ++i)
    limit = std::min(limit, (1 + terms.tolerance) * costOf(first[i], limit));
  std::erase_if(survivors,
                [&](const Candidate& c) { return !(c.cost <= limit * (1 + kBoundRounding)); });

  const auto sum = [&](std::size_t i) { survivors[i].cost = costOf(survivors[i], limit); };
  if (survivors.size() < kAlone)
    for (std::size_t i = 0; i < survivors.size(); ++i) sum(i);
  else
    tbb::parallel_for(std::size_t{0}, survivors.size(), sum);
  double least = kInfinity;
  for (const Candidate& c : survivors) least = std::min(least, c.cost);
  std::erase_if(survivors, [&](const Candidate& c) {
    return !(c.cost <= (1 + terms.tolerance) * least) || c.cost == kInfinity;
  });
  return survivors;
}

}  // namespace patina::patch
