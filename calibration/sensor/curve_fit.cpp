// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/sensor/curve_fit.h"

#include <lapacke.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace patina::calibration {
namespace {

constexpr int kCodeHigh = 250;       // above it a pixel may be clipped
constexpr int kObservedMin = 2000;   // sums of light
constexpr int kBlocksMost = 20'000;  // more add nothing but time
constexpr int kFolds = 4, kRounds = 4;
// Near black a code stands for few numbers of the converter, so the curve is not smooth there.
constexpr double kToe = 32, kToeLeast = 4;
constexpr double kLightSd = 3e-5;  // of the last code's light: what clipping at black may do
constexpr double kSmoothingLeast = 1, kSmoothingMost = 1e7, kSmoothingFirst = 1e4;
// Left-out blocks scatter a little more about a curve that does not follow their noise.
constexpr double kScatterMost = 1.04;
constexpr std::array<double, 4> kThird{-1, 3, -3, 1};

using Light = std::array<double, kCodes>;

// A symmetric system, its upper triangle.
class Normal {
 public:
  double& at(int row, int column) { return values_[std::size_t{kCodes} * row + column]; }
  double at(int row, int column) const { return values_[std::size_t{kCodes} * row + column]; }
  void add(const Normal& other, double times) {
    for (std::size_t i = 0; i < values_.size(); ++i) values_[i] += times * other.values_[i];
  }
  // What an observation of a code counts, in steps of light, times their mean number.
  double meanWeight(const Light& slopes) const {
    double sum = 0;
    for (int z = 0; z < kCodes; ++z) sum += at(z, z) * slopes[z] * slopes[z] / kCodes;
    return sum;
  }
  // The light of least squares that is 1 at one code.
  std::optional<Light> leastWith(int fixed) const {
    constexpr int n = kCodes - 1;
    const auto from = [&](int i) { return i < fixed ? i : i + 1; };
    std::vector<double> a(std::size_t{n} * n), x(n);
    for (int i = 0; i < n; ++i) {
      for (int j = i; j < n; ++j) a[static_cast<std::size_t>(i) * n + j] = at(from(i), from(j));
      x[i] = -at(std::min(from(i), fixed), std::max(from(i), fixed));
    }
    if (LAPACKE_dposv(LAPACK_ROW_MAJOR, 'U', n, 1, a.data(), n, x.data(), 1) != 0)
      return std::nullopt;
    x.insert(x.begin() + fixed, 1.0);
    Light light;
    std::ranges::copy(x, light.begin());
    return light;
  }

 private:
  std::vector<double> values_ = std::vector<double>(std::size_t{kCodes} * kCodes);
};

// One block in one exposure.
struct Sum {
  double exposure_s = 0;
  int pixels = 0;
  std::vector<std::pair<int, float>> shares;  // code, share of the pixels
};
using Block = std::vector<Sum>;  // of the exposures that do not clip it

std::vector<Block> blocksOf(const std::vector<Bracket>& brackets, int channel, int side) {
  const SizePx size = brackets[0].codes.size();
  const int columns = size.width / side, rows = size.height / side;
  const int every = std::max(1, columns * rows / kBlocksMost);
  std::vector<Block> blocks;
  for (int k = 0; k < columns * rows; k += every) {
    Block block;
    for (const Bracket& bracket : brackets) {
      std::array<int, kCodes> counts{};
      const ImageView<const std::uint8_t> codes = bracket.codes.view();
      for (int y = k / columns * side; y < (k / columns + 1) * side; ++y)
        for (int x = k % columns * side; x < (k % columns + 1) * side; ++x)
          ++counts[codes.at(x, y, channel)];
      if (std::any_of(counts.begin() + kCodeHigh + 1, counts.end(), [](int n) { return n > 0; }))
        continue;
      Sum sum{bracket.exposure_s, side * side, {}};
      for (int z = 0; z <= kCodeHigh; ++z)
        if (counts[z] > 0)
          sum.shares.emplace_back(z,
                                  static_cast<float>(counts[z]) / static_cast<float>(sum.pixels));
      block.push_back(std::move(sum));
    }
    if (block.size() > 1) blocks.push_back(std::move(block));
  }
  return blocks;
}

// The code with most pixels, dark ones apart: the curve is 1 there.
int bestSeen(const std::vector<Block>& blocks) {
  Light seen{};
  for (const Block& block : blocks)
    for (const Sum& sum : block)
      for (const auto& [z, share] : sum.shares) seen[z] += share;
  return static_cast<int>(std::max_element(seen.begin() + kCodes / 4, seen.begin() + kCodeHigh) -
                          seen.begin());
}

// Light a code, over a neighbourhood.
Light slopesOf(const Light& light, int reach) {
  constexpr int kWide = 16;
  const auto slope = [&](int z, int around) {
    const int low = std::max(0, z - around), high = std::min(kCodes - 1, z + around);
    return (light[high] - light[low]) / (high - low);
  };
  Light slopes{};
  for (int z = 0; z < kCodes; ++z)
    slopes[z] = std::max({slope(z, reach), 0.25 * slope(z, kWide), 1e-6 * light[kCodes - 1]});
  return slopes;
}

struct Weighed {
  double mean = 0, weight = 0;
};
// By equal noise in codes.
Weighed weighed(const Sum& sum, const Light& slopes, const Light& light) {
  const double least = kLightSd * light[kCodes - 1];
  double mean = 0, variance = least * least;
  for (const auto& [z, share] : sum.shares) {
    mean += share * light[z];
    variance += share * slopes[z] * slopes[z] / sum.pixels;
  }
  return {mean, 1 / variance};
}

// Rows of a block, its light eliminated.
void addBlock(const Block& block, const Light& slopes, const Light& light, Normal& normal) {
  double tt = 0;
  Light together{};
  int low = kCodes, high = 0;
  for (const Sum& sum : block) {
    const double w = weighed(sum, slopes, light).weight, t = sum.exposure_s;
    tt += w * t * t;
    for (std::size_t p = 0; p < sum.shares.size(); ++p) {
      const auto& [z, share] = sum.shares[p];
      for (std::size_t q = p; q < sum.shares.size(); ++q)
        normal.at(z, sum.shares[q].first) += w * share * sum.shares[q].second;
      together[z] += w * t * share;
      low = std::min(low, z);
      high = std::max(high, z);
    }
  }
  for (int p = low; p <= high; ++p) {
    if (together[p] == 0) continue;
    for (int q = p; q <= high; ++q) normal.at(p, q) -= together[p] * together[q] / tt;
  }
}

Normal roughness(const Light& slopes) {
  Normal rough;
  for (int z = 1; z + 3 < kCodes; ++z) {  // 0 means "at most", as the last code means "at least"
    const double toe = std::clamp(z / kToe, kToeLeast / kToe, 1.0);
    const double unit = (slopes[z] + slopes[z + 3]) / 2 / (toe * toe);
    for (int p = 0; p < 4; ++p)
      for (int q = p; q < 4; ++q) rough.at(z + p, z + q) += kThird[p] * kThird[q] / (unit * unit);
  }
  for (int z = 0; z < kCodes; ++z) rough.at(z, z) += 1e-15 / (slopes[z] * slopes[z]);
  return rough;
}

// Departures of left-out blocks from one light, squared, in noise of codes: by the slopes of the
// curve itself, as a curve that is flat where the scene has most codes would seem to have no noise.
double scatterOf(const std::vector<Block>& blocks, int fold, const Light& light) {
  const Light slopes = slopesOf(light, 1);
  double sum = 0;
  for (std::size_t b = fold; b < blocks.size(); b += kFolds) {
    double mm = 0, tm = 0, tt = 0;
    for (const Sum& one : blocks[b]) {
      const Weighed by = weighed(one, slopes, light);
      mm += by.weight * by.mean * by.mean;
      tm += by.weight * one.exposure_s * by.mean;
      tt += by.weight * one.exposure_s * one.exposure_s;
    }
    sum += mm - tm * tm / tt;
  }
  return sum;
}

// The smoothest that still predicts left-out blocks.
double chooseSmoothing(const std::vector<Block>& blocks, const std::vector<Normal>& folds,
                       const Normal& all, const Normal& rough, double unit, int fixed) {
  std::vector<std::pair<double, double>> tried;  // smoothing, scatter
  for (double s = kSmoothingLeast; s <= kSmoothingMost; s *= 10) {
    double scatter = 0;
    for (int f = 0; f < kFolds; ++f) {
      Normal others = all;
      others.add(folds[f], -1);
      others.add(rough, s * unit);
      const std::optional<Light> light = others.leastWith(fixed);
      scatter += light ? scatterOf(blocks, f, *light) : INFINITY;
    }
    tried.emplace_back(s, scatter);
  }
  double best = INFINITY, smoothest = kSmoothingFirst;
  for (const auto& [smoothing, scatter] : tried) best = std::min(best, scatter);
  for (const auto& [smoothing, scatter] : tried)
    if (std::isfinite(scatter) && scatter <= kScatterMost * best) smoothest = smoothing;
  return smoothest;
}

}  // namespace

std::optional<CurveFit> fitCurve(const std::vector<Bracket>& brackets, int channel, int block_px,
                                 const std::array<double, kCodes>& start) {
  const std::vector<Block> blocks = blocksOf(brackets, channel, block_px);
  CurveFit fit{start, 0, kSmoothingFirst};
  for (const Block& block : blocks) fit.observed += static_cast<int>(block.size());
  if (fit.observed < kObservedMin) return std::nullopt;
  const int fixed = bestSeen(blocks);
  for (int round = 0; round < kRounds; ++round) {
    const Light slopes = slopesOf(fit.light, 4);
    std::vector<Normal> folds(kFolds);
    for (std::size_t b = 0; b < blocks.size(); ++b)
      addBlock(blocks[b], slopes, fit.light, folds[b % kFolds]);
    Normal all;
    for (const Normal& fold : folds) all.add(fold, 1);
    const Normal rough = roughness(slopes);
    const double unit = all.meanWeight(slopes);
    if (round == kRounds - 2)
      fit.smoothing = chooseSmoothing(blocks, folds, all, rough, unit, fixed);
    all.add(rough, fit.smoothing * unit);
    const std::optional<Light> light = all.leastWith(fixed);
    if (!light) return std::nullopt;
    fit.light = *light;
  }
  return fit;
}

}  // namespace patina::calibration
