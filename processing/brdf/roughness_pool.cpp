// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/brdf/roughness_pool.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "processing/brdf/alike.h"
#include "processing/brdf/crowd.h"

namespace patina::brdf {
namespace {

using lanes::kCurve;
using lanes::kLanes;
using lanes::Lane;
using Curve = std::array<float, kCurve>;
// What alike texels cost together by roughness: cost - 2 moment ks + information ks^2.
struct Pool {
  Curve cost{}, moment{}, information{};
  Curve specular{};  // of least cost, once it is settled
  float texels = 0;  // weights' sum
};

// 2 ln of how much less likely what is no dielectric has a given reflectance than a dielectric has
// its own: as often met, spread seven times as wide.
constexpr float kAnyPrice = 4;
constexpr float kLikely2 = 4;  // so near are most dielectrics, squared, in units of their spread
constexpr float kLowerShare = 0.3f;  // of the spread, below: none reflects less than water
constexpr float kLeastSpread2 = 0.06f * 0.06f;  // of ln r among neighbours
constexpr float kLeastShare = 0.12f;            // of ks
constexpr float kBeforeSpread2 = 0.1f * 0.1f;   // of ln r from one time step to the next
constexpr float kUnlikely = 24;                 // of cost above the least: has no say
constexpr int kParts = 8;                       // of an interval, that likelihoods are summed over

float logR(std::size_t j) {
  static const Curve grid = [] {
    Curve all;
    for (std::size_t i = 0; i < kCurve; ++i) all[i] = lanes::curveLogR(static_cast<int>(i));
    return all;
  }();
  return grid[j];
}

// The strength of least cost at every roughness, at least 0 and held to what materials are; costs
// of both. Torrance and Sparrow's strength is no reflectance: its spread says so.
void settle(Pool& sum, Crowd& crowd, const MultiLightOptions& options) {
  const float fewer = 1 / crowd.crowding();
  for (std::size_t j = 0; j < kCurve; ++j) {
    const float a = sum.information[j] * fewer, moment = sum.moment[j] * fewer;
    const float own = a > 0 ? moment / a : kDielectric;
    const float spread = options.specular_spread * (own < kDielectric ? kLowerShare : 1);
    const float p = 1 / (spread * spread);
    const float held = std::max((moment + p * kDielectric) / (a + p), 0.0f);
    const float off = held - kDielectric, from_own = held - own;
    const bool metal = own > kDielectric && a * from_own * from_own + p * off * off > kAnyPrice;
    const float ks = metal ? own : held, price = metal ? kAnyPrice : p * off * off;
    const float off_r = logR(j) - kWideLogR;
    sum.specular[j] = ks;
    sum.cost[j] =
        sum.cost[j] * fewer - ks * (2 * moment - a * ks) + price + kWideLogRWeight * off_r * off_r;
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
                  *moment = state.curve_moment.view().texel(x, y + dy).data(),
                  *information = state.curve_information.view().texel(x, y + dy).data();
      Pool& sum = sums[static_cast<std::size_t>(k)];
      for (std::size_t j = 0; j < kCurve; ++j) sum.cost[j] += w * curve[j];
      for (std::size_t j = 0; j < kCurve; ++j) sum.moment[j] += w * moment[j];
      for (std::size_t j = 0; j < kCurve; ++j) sum.information[j] += w * information[j];
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

 private:
  float h_, p0_, m0_, m1_, c2_, c3_;
};

// By ln r, through each entry and its neighbours.
Curve slopesOf(const Curve& cost) {
  Curve slope;
  const auto rise = [&](std::size_t j) {
    return (cost[j + 1] - cost[j]) / (logR(j + 1) - logR(j));
  };
  slope.front() = rise(0);
  slope.back() = rise(kCurve - 2);
  for (std::size_t j = 1; j + 1 < kCurve; ++j) {
    const float before = logR(j) - logR(j - 1), after = logR(j + 1) - logR(j);
    slope[j] = (rise(j) * before + rise(j - 1) * after) / (before + after);
  }
  return slope;
}

// Over all roughnesses, by how likely they are.
struct Likely {
  float log_r = 0;   // of the mean r
  float weight = 0;  // 1 / variance of ln r
  float specular = 0;
  float cost = HUGE_VALF;  // the least
};
Likely likelyOf(const Pool& pool) {
  const Curve slope = slopesOf(pool.cost);
  const float least = *std::min_element(pool.cost.begin(), pool.cost.end());
  Likely likely;
  float sum = 0, r = 0, u = 0, u2 = 0, specular = 0;
  for (std::size_t j = 0; j + 1 < kCurve; ++j) {
    if (std::min(pool.cost[j], pool.cost[j + 1]) > least + kUnlikely) continue;
    const Cubic cubic(pool.cost, slope, j);
    for (int part = 0; part < kParts; ++part) {
      const float t = (static_cast<float>(part) + 0.5f) / kParts, cost = cubic.at(t);
      const float off = t * cubic.h(), from_wide = logR(j) + off - kWideLogR;
      const float w = cubic.h() * std::exp(-0.5f * std::max(cost - least, -kUnlikely));
      sum += w, u += w * from_wide, u2 += w * from_wide * from_wide;
      r += w * std::exp(logR(j) + off);
      specular += w * (pool.specular[j] * (1 - t) + pool.specular[j + 1] * t);
      likely.cost = std::min(likely.cost, cost);
    }
  }
  const float mean = u / sum;
  likely.log_r = std::log(r / sum);
  likely.weight = 1 / std::max(u2 / sum - mean * mean, 1e-6f);
  likely.specular = specular / sum;
  return likely;
}

// What the pool costs beyond one per texel for its roughness and one for its strength is how much
// they differ among themselves (DerSimonian and Laird 1986): that far is no texel held to others.
float certaintyOf(const Likely& likely, float texels) {
  const float chance = 2 * std::max(texels - 1, 0.0f);
  const float between = std::max(likely.cost - chance, 0.0f) / likely.weight;
  return 1 / (1 / likely.weight + between + kLeastSpread2);
}

}  // namespace

void ofLikeTexels(std::span<float> cost, std::span<const float> slope) {
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
    const float apart = off * off / kLeastSpread2;
    cost[j] = own * apart / std::max(own + apart, 1e-20f);
  }
}

void keepCurve(FitState& state, const lanes::CostCurve& curve, float spread2, int x, int y, int k) {
  const auto cost = state.curve.view().texel(x, y), moment = state.curve_moment.view().texel(x, y),
             information = state.curve_information.view().texel(x, y);
  Curve slope;
  for (std::size_t j = 0; j < kCurve; ++j) {
    cost[j] = curve.cost[j][k] / spread2;
    slope[j] = curve.slope[j][k] / spread2;
  }
  ofLikeTexels(cost, slope);
  for (std::size_t j = 0; j < kCurve; ++j) {
    const float ks = curve.ks[j][k], apart = kLeastShare * ks;
    information[j] = 1 / (spread2 / curve.information[j][k] + apart * apart);
    moment[j] = information[j] * ks;
    cost[j] += moment[j] * ks;
  }
}

void poolRoughness(const FitState& state, const std::vector<FitBefore>& before,
                   const MultiLightOptions& options, PriorMaps& prior, Progress& progress) {
  const AlikeTexels alike(state.look, options);
  const auto hold = [&](Pool& sum, int x, int y) {
    for (const FitBefore& other : before) {
      const float log_r = std::log(std::max(other.roughness.at(x, y), lanes::kSmallestR));
      const float firm = other.confidence.at(x, y) / kBeforeSpread2;
      for (std::size_t j = 0; j < kCurve; ++j) {
        const float off = logR(j) - log_r;
        sum.cost[j] += firm * off * off;
      }
    }
    const Likely likely = likelyOf(sum);
    prior.log_r.at(x, y) = likely.log_r;
    prior.log_r_weight.at(x, y) = certaintyOf(likely, sum.texels);
    prior.expected_specular.at(x, y) = likely.specular;
    const float spread = options.specular_spread, off = (likely.specular - kDielectric) / spread;
    if (off * off < kLikely2)
      prior.expected_weight.at(x, y) = state.spread2.at(x, y) / (spread * spread);
  };
  progress.begin("roughness of neighbours", stripsOf(state.size));
  forEachInStrips(state.size, progress, [&](int x0, int y) {
    std::array<Pool, kLanes> sums = pooled(state, alike, x0, y, options);
    for (int k = 0; k < kLanes && x0 + k < state.size.width; ++k)
      hold(sums[static_cast<std::size_t>(k)], x0 + k, y);
  });
}

}  // namespace patina::brdf
