// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/brdf/fit_maps.h"

#include <array>
#include <cmath>

#include "processing/brdf/alike.h"
#include "processing/image/parallel_rows.h"

namespace patina::brdf {
namespace {

using lanes::kCurve;
using lanes::kLanes;
using lanes::Lane;
using Curve = std::array<float, kCurve>;
// What alike texels cost together, and what materials are.
struct Pool {
  Curve cost{}, slope{}, specular{};
  float texels = 0;  // weights' sum
};

// 2 ln of how much less likely what is no dielectric has a given reflectance than a dielectric has
// 0.04: as often met, spread seven times as wide.
constexpr float kAnyPrice = 4;
constexpr float kLikely2 = 4;  // so near are most dielectrics, squared, in units of their spread
constexpr float kLeastSpread2 = 0.06f * 0.06f;  // of ln r among neighbours
// Of specular reflectance among neighbours: 0.003 and 6 % of it.
constexpr double kLeastSpecularSpread = 0.003, kLeastSpecularShare = 0.06;
constexpr double kBeforeSpecularSpread2 = 0.01 * 0.01;
constexpr float kBeforeSpread2 = 0.1f * 0.1f;  // of ln r from one time step to the next

float logR(std::size_t j) {
  static const Curve grid = [] {
    Curve all;
    for (std::size_t i = 0; i < kCurve; ++i) all[i] = lanes::curveLogR(static_cast<int>(i));
    return all;
  }();
  return grid[j];
}

// Errors that alike texels have together, those of lamps and what the model does not meet, do not
// average out: by how much so many texels are fewer. What is not met of most texels is the model's;
// of a few it is a shadow of their own.
struct Crowd {
  Crowd() { misfits.reserve(80); }
  std::vector<float> misfits;  // of every third
  int count = 0;
  float lamps = 0, texels = 0;
  void add(const FitState& state, int x, int y, float w) {
    if (count++ % 3 == 0) misfits.push_back(state.misfit.at(x, y));
    lamps += w * state.lamps.at(x, y);
    texels += w;
  }
  float crowding() {
    const auto middle = misfits.begin() + static_cast<std::ptrdiff_t>(misfits.size() / 2);
    std::nth_element(misfits.begin(), middle, misfits.end());
    const float common = 1 - (1 - lamps / texels) / std::max(*middle, 1.0f);
    return 1 + common * std::max(texels - 1, 0.0f);
  }
};

// Squared, in units of what dielectrics spread by.
float fromDielectric2(float specular, const MultiLightOptions& options) {
  const float off = (specular - kDielectric) / options.specular_spread;
  return off * off;
}

// What neighbours tell of a texel, once all are added up.
void settle(Pool& sum, Crowd& crowd, const MultiLightOptions& options) {
  const float fewer = 1 / crowd.crowding();
  for (std::size_t j = 0; j < kCurve; ++j) {
    sum.specular[j] /= crowd.texels;
    sum.cost[j] *= fewer;
    sum.slope[j] *= fewer;
  }
  for (std::size_t j = 0; j < kCurve; ++j) {
    const float price = fromDielectric2(sum.specular[j], options);
    sum.cost[j] += std::min(price, kAnyPrice);
    const float off = logR(j) - kWideLogR;
    sum.cost[j] += kWideLogRWeight * off * off;
    sum.slope[j] += 2 * kWideLogRWeight * off;
    const std::size_t l = j > 0 ? j - 1 : j, r = j + 1 < kCurve ? j + 1 : j;
    const float spread2 = options.specular_spread * options.specular_spread;
    if (price < kAnyPrice)
      sum.slope[j] += 2 * (sum.specular[j] - kDielectric) / spread2 *
                      (sum.specular[r] - sum.specular[l]) / (logR(r) - logR(l));
  }
  sum.texels = crowd.texels * fewer;
}

// Of the texels of row y from x0 on.
std::array<Pool, kLanes> pooled(const FitState& state, const AlikeTexels& alike, int x0, int y,
                                const MultiLightOptions& options) {
  std::array<Pool, kLanes> sums{};
  std::array<Crowd, kLanes> crowds;
  alike.forEach(x0, y, [&](int dx, int dy, const Lane& weights) {
    for (int k = 0; k < kLanes; ++k) {
      const float w = weights[k];
      if (!(w > 0)) continue;
      const int x = x0 + k + dx;
      const float *curve = state.curve.view().texel(x, y + dy).data(),
                  *slope = state.curve_slope.view().texel(x, y + dy).data(),
                  *specular = state.curve_specular.view().texel(x, y + dy).data();
      Pool& sum = sums[static_cast<std::size_t>(k)];
      for (std::size_t j = 0; j < kCurve; ++j) sum.cost[j] += w * curve[j];
      for (std::size_t j = 0; j < kCurve; ++j) sum.slope[j] += w * slope[j];
      for (std::size_t j = 0; j < kCurve; ++j) sum.specular[j] += w * specular[j];
      crowds[static_cast<std::size_t>(k)].add(state, x, y + dy, w);
    }
  });
  for (int k = 0; k < kLanes && x0 + k < state.size.width; ++k)
    settle(sums[static_cast<std::size_t>(k)], crowds[static_cast<std::size_t>(k)], options);
  return sums;
}

// Between two entries `h` of ln r apart: the cubic of their costs and slopes. t: [0,1].
class Cubic {
 public:
  Cubic(std::span<const float> cost, std::span<const float> slope, std::size_t j)
      : h_(logR(j + 1) - logR(j)), p0_(cost[j]), m0_(slope[j] * h_), m1_(slope[j + 1] * h_) {
    const float rise = cost[j + 1] - p0_;
    c2_ = 3 * rise - 2 * m0_ - m1_;
    c3_ = m0_ + m1_ - 2 * rise;
  }
  float h() const { return h_; }
  float at(float t) const { return p0_ + t * (m0_ + t * (c2_ + t * c3_)); }
  bool leadsDown() const { return m0_ < 0 && m1_ > 0; }  // from both entries
  // Where it is lowest then.
  float lowest() const {
    float low = 0, high = 1;
    for (int round = 0; round < 12; ++round) {
      const float t = (low + high) / 2;
      (m0_ + t * (2 * c2_ + t * 3 * c3_) < 0 ? low : high) = t;
    }
    return (low + high) / 2;
  }
  // Half the mean second derivative by ln r.
  float weight() const { return (m1_ - m0_) / (2 * h_ * h_); }

 private:
  float h_, p0_, m0_, m1_, c2_, c3_;
};

struct Valley {
  float log_r = 0, weight = 0, cost = HUGE_VALF;  // weight: half the second derivative
};

// The lowest point between two entries whose slopes lead down into it; weight 0: there is none.
Valley valleyOf(const Pool& pool) {
  Valley least;
  for (std::size_t j = 0; j + 1 < kCurve; ++j) {
    const Cubic cubic(pool.cost, pool.slope, j);
    if (!cubic.leadsDown()) continue;
    const float t = cubic.lowest(), cost = cubic.at(t);
    if (cost < least.cost) least = {logR(j) + t * cubic.h(), cubic.weight(), cost};
  }
  least.cost = least.weight > 0 ? std::max(least.cost, 0.0f) : 0;
  return least;
}

float specularAt(const Pool& pool, float log_r) {
  std::size_t j = 0;
  while (j + 2 < kCurve && logR(j + 1) <= log_r) ++j;
  const float share = std::clamp((log_r - logR(j)) / (logR(j + 1) - logR(j)), 0.0f, 1.0f);
  return pool.specular[j] * (1 - share) + pool.specular[j + 1] * share;
}

// What the pool costs beyond one per texel is how much they differ among themselves (DerSimonian
// and Laird 1986): that far is no texel held to the others.
float certaintyOf(const Valley& valley, float texels) {
  if (!(valley.weight > 0)) return 0;
  const float between = std::max(valley.cost - std::max(texels - 1, 0.0f), 0.0f) / valley.weight;
  return 1 / (1 / valley.weight + between + kLeastSpread2);
}

// body(x0, y) for sixteen texels from there on, down one strip after the other: what the
// neighbours of a row are asked for is at hand from the row above.
int stripsOf(SizePx size) { return (size.width + kLanes - 1) / kLanes; }
template <class Body>
void forEachInStrips(SizePx size, Progress& progress, const Body& body) {
  forEachRow(stripsOf(size), std::int64_t{size.height} * kLanes * 500, [&](int strip) {
    for (int y = 0; y < size.height; ++y) body(strip * kLanes, y);
    progress.step();
  });
}

// Means by information, of each channel and of their mean.
struct SpecularPool {
  std::array<double, 3> mean{};
  double grey = 0, square = 0, weight = 0, texels = 0;
  void add(std::span<const float> specular, double information, double w) {
    double sum = 0;
    for (std::size_t c = 0; c < specular.size(); ++c) {
      mean[c] += w * information * specular[c];
      sum += specular[c];
    }
    sum /= static_cast<double>(specular.size());
    grey += w * information * sum;
    square += w * information * sum * sum;
    weight += w * information;
    texels += w;
  }
  // `crowd`: of errors that texels have together.
  float certainty(double crowd) const {
    const double excess = square - grey * grey / weight - std::max(texels - 1, 0.0);
    const double between = std::max(excess, 0.0) / weight;
    const double least = kLeastSpecularSpread + kLeastSpecularShare * std::max(grey / weight, 0.0);
    return static_cast<float>(1 / (crowd / weight + between + least * least));
  }
};

}  // namespace

void ofLikeTexels(std::span<float> cost, std::span<float> slope) {
  const auto lowest =
      static_cast<std::size_t>(std::min_element(cost.begin(), cost.end()) - cost.begin());
  float best = logR(lowest), least = cost[lowest];
  for (std::size_t j = lowest > 0 ? lowest - 1 : 0; j <= lowest && j + 1 < kCurve; ++j) {
    const Cubic cubic(cost, slope, j);
    if (!cubic.leadsDown()) continue;
    const float t = cubic.lowest(), there = cubic.at(t);
    if (there < least) least = there, best = logR(j) + t * cubic.h();
  }
  for (std::size_t j = 0; j < kCurve; ++j) {
    const float own = std::max(cost[j] - least, 0.0f), off = logR(j) - best;
    const float apart = off * off / kLeastSpread2, apart_slope = 2 * off / kLeastSpread2;
    const float both = std::max(own + apart, 1e-20f);
    slope[j] = (slope[j] * apart * apart + apart_slope * own * own) / (both * both);
    cost[j] = own * apart / both;
  }
}

FitState::FitState(SizePx s, int channels)
    : size(s),
      normal(s.width, s.height, 3),
      diffuse(s.width, s.height, channels),
      specular(s.width, s.height, channels),
      specular_weight(s.width, s.height, 1),
      grey_diffuse(s.width, s.height, 1),
      grey_specular(s.width, s.height, 1),
      log_r(s.width, s.height, 1),
      confidence(s.width, s.height, 1),
      residual(s.width, s.height, 1),
      told(s.width, s.height, 1),
      shadowed(s.width, s.height, 1),
      spread2(s.width, s.height, 1, 1.0f),
      misfit(s.width, s.height, 1),
      lamps(s.width, s.height, 1),
      own_specular(s.width, s.height, channels),
      look(s.width, s.height, channels),
      curve(s.width, s.height, kCurve),
      curve_slope(s.width, s.height, kCurve),
      curve_specular(s.width, s.height, kCurve) {}

PriorMaps::PriorMaps(SizePx s, int channels)
    : log_r(s.width, s.height, 1),
      log_r_weight(s.width, s.height, 1),
      dielectric_weight(s.width, s.height, 1),
      specular(s.width, s.height, channels),
      specular_weight(s.width, s.height, 1) {}

void poolRoughness(const FitState& state, const std::vector<FitBefore>& before,
                   const MultiLightOptions& options, PriorMaps& prior, Progress& progress) {
  const AlikeTexels alike(state.look, options);
  const auto hold = [&](Pool& sum, int x, int y) {
    for (const FitBefore& other : before) {
      const float log_r = std::log(std::max(other.roughness.at(x, y), 0.02f));
      const float firm = other.confidence.at(x, y) / kBeforeSpread2;
      for (std::size_t j = 0; j < kCurve; ++j) {
        const float off = logR(j) - log_r;
        sum.cost[j] += firm * off * off;
        sum.slope[j] += 2 * firm * off;
      }
    }
    const Valley valley = valleyOf(sum);
    prior.log_r.at(x, y) = valley.log_r;
    prior.log_r_weight.at(x, y) = certaintyOf(valley, sum.texels);
    const float spread = options.specular_spread;
    if (fromDielectric2(specularAt(sum, valley.log_r), options) < kLikely2)
      prior.dielectric_weight.at(x, y) = state.spread2.at(x, y) / (spread * spread);
  };
  progress.begin("roughness of neighbours", stripsOf(state.size));
  forEachInStrips(state.size, progress, [&](int x0, int y) {
    std::array<Pool, kLanes> sums = pooled(state, alike, x0, y, options);
    for (int k = 0; k < kLanes && x0 + k < state.size.width; ++k)
      hold(sums[static_cast<std::size_t>(k)], x0 + k, y);
  });
}

void poolSpecular(const FitState& state, const std::vector<FitBefore>& before,
                  const MultiLightOptions& options, PriorMaps& prior, Progress& progress) {
  const AlikeTexels alike(state.look, options);
  const auto hold = [&](SpecularPool& sum, Crowd& together, int x, int y) {
    const float crowd = together.texels > 0 ? together.crowding() : 1;
    for (const FitBefore& other : before)
      if (other.specular.channels == state.specular.channels())
        sum.add(other.specular.texel(x, y), other.confidence.at(x, y) / kBeforeSpecularSpread2, 1);
    if (!(sum.weight > 0)) return;
    for (int c = 0; c < state.specular.channels(); ++c)
      prior.specular.at(x, y, c) =
          static_cast<float>(sum.mean[static_cast<std::size_t>(c)] / sum.weight);
    prior.specular_weight.at(x, y) = sum.certainty(crowd);
  };
  progress.begin("gloss of neighbours", stripsOf(state.size));
  forEachInStrips(state.size, progress, [&](int x0, int y) {
    std::array<SpecularPool, kLanes> sums{};
    std::array<Crowd, kLanes> crowds;
    alike.forEach(x0, y, [&](int dx, int dy, const Lane& weights) {
      for (int k = 0; k < kLanes; ++k) {
        if (!(weights[k] > 0)) continue;
        const int x = x0 + k + dx;
        const float information = state.specular_weight.at(x, y + dy);
        if (!(information > 0)) continue;
        const auto i = static_cast<std::size_t>(k);
        sums[i].add(state.own_specular.view().texel(x, y + dy), information, weights[k]);
        crowds[i].add(state, x, y + dy, weights[k]);
      }
    });
    for (int k = 0; k < kLanes && x0 + k < state.size.width; ++k)
      hold(sums[static_cast<std::size_t>(k)], crowds[static_cast<std::size_t>(k)], x0 + k, y);
  });
}

}  // namespace patina::brdf
