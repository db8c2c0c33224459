// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/brdf/roughness_pool.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "processing/brdf/alike.h"
#include "processing/brdf/crowd.h"
#include "processing/brdf/roughness_curve.h"

namespace patina::brdf {
namespace {

using lanes::kCurve;
using lanes::kLanes;
using lanes::Lane;
// What alike texels cost together by roughness: cost - 2 moment ks + information ks^2.
struct Pool {
  Curve cost{}, moment{}, information{};
  Curve specular{};  // of least cost, once it is settled
  float texels = 0;  // weights' sum
};

constexpr float kLikely2 = 4;  // so near are most dielectrics, squared, in units of their spread
constexpr float kLowerShare = 0.3f;  // of the spread, below: none reflects less than water
// Most surfaces are rough: r is 0.6, more or less by e. Mirrors are met too: none costs more than
// that.
constexpr float kRoughLogR = -0.5f, kMirrorPrice = 9;
constexpr float kBeforeSpread2 = 0.1f * 0.1f;  // of ln r from one time step to the next
constexpr float kUnlikely = 24;                // of cost above the least: has no say
constexpr std::size_t kParts = 8;              // of an interval, that likelihoods are summed over

// The strength of least cost at every roughness, at least 0 and held to what materials are; costs
// of both. Torrance and Sparrow's strength is no reflectance: its spread says so.
void settle(Pool& sum, Crowd& crowd, const MultiLightOptions& options) {
  const float fewer = 1 / crowd.crowding();
  const Curve& grid = logRs();
  for (std::size_t j = 0; j < kCurve; ++j) {
    const float a = sum.information[j] * fewer, moment = sum.moment[j] * fewer;
    const float own = a > 0 ? moment / a : kDielectric;
    const float spread = options.specular_spread * (own < kDielectric ? kLowerShare : 1);
    const float p = 1 / (spread * spread);
    const float held = std::max((moment + p * kDielectric) / (a + p), 0.0f);
    const float off = held - kDielectric, from_own = held - own;
    const bool metal = own > kDielectric && a * from_own * from_own + p * off * off > kAnyPrice;
    const float ks = metal ? own : held, price = metal ? kAnyPrice : p * off * off;
    const float off_r = grid[j] - kRoughLogR,
                rough = kMirrorPrice * off_r * off_r / (kMirrorPrice + off_r * off_r);
    sum.specular[j] = ks;
    sum.cost[j] = sum.cost[j] * fewer - ks * (2 * moment - a * ks) + price + rough;
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

// Over all roughnesses, by how likely they are.
struct Likely {
  float log_r = 0;   // of the mean r
  float weight = 0;  // 1 / variance of ln r
  float specular = 0;
  float cost = HUGE_VALF;  // the least
};
// r in the middle of each part.
const std::array<float, kCurve * kParts>& partsR() {
  static const std::array<float, kCurve* kParts> all = [] {
    std::array<float, kCurve * kParts> r{};
    for (std::size_t j = 0; j + 1 < kCurve; ++j)
      for (std::size_t part = 0; part < kParts; ++part) {
        const float t = (static_cast<float>(part) + 0.5f) / kParts;
        r[j * kParts + part] = std::exp(logR(j) + t * (logR(j + 1) - logR(j)));
      }
    return r;
  }();
  return all;
}

Likely likelyOf(const Pool& pool) {
  const Curve& grid = logRs();
  const auto& parts_r = partsR();
  const Curve slope = slopesOf(pool.cost);
  const float least = *std::min_element(pool.cost.begin(), pool.cost.end());
  Likely likely;
  float sum = 0, r = 0, u = 0, u2 = 0, specular = 0;
  for (std::size_t j = 0; j + 1 < kCurve; ++j) {
    if (std::min(pool.cost[j], pool.cost[j + 1]) > least + kUnlikely) continue;
    const Cubic cubic(pool.cost, slope, j);
    for (std::size_t part = 0; part < kParts; ++part) {
      const float t = (static_cast<float>(part) + 0.5f) / kParts, cost = cubic.at(t);
      const float off = t * cubic.h(), from_rough = grid[j] + off - kRoughLogR;
      const float w = cubic.h() * std::exp(-0.5f * std::max(cost - least, -kUnlikely));
      sum += w, u += w * from_rough, u2 += w * from_rough * from_rough;
      r += w * parts_r[j * kParts + part];
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

// What the pool costs beyond one per texel for its roughness and one for its strength (two less for
// the pool's, two more for what surfaces mostly are) is how much they differ among themselves
// (DerSimonian and Laird 1986): that far is no texel held to others.
float certaintyOf(const Likely& likely, float texels) {
  const float chance = 2 * texels;
  const float between = std::max(likely.cost - chance, 0.0f) / likely.weight;
  return 1 / (1 / likely.weight + between + kLeastSpread2);
}

}  // namespace

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
