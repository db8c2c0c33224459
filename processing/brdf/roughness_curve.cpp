// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/brdf/roughness_curve.h"

#include <algorithm>
#include <cmath>

namespace patina::brdf {

using lanes::kCurve;

namespace {

constexpr float kLeastShare = 0.12f;  // of ks among alike texels

struct Valley {
  float log_r, cost;
};
Valley lowestOf(const Curve& cost, const Curve& slope) {
  const auto least =
      static_cast<std::size_t>(std::min_element(cost.begin(), cost.end()) - cost.begin());
  Valley valley{logR(least), cost[least]};
  for (std::size_t j = least > 0 ? least - 1 : 0; j <= least && j + 1 < kCurve; ++j) {
    const Cubic cubic(cost, slope, j);
    if (!cubic.leadsDown()) continue;
    const float t = cubic.lowest(), there = cubic.at(t);
    if (there < valley.cost) valley = {logR(j) + t * cubic.h(), there};
  }
  return valley;
}

std::size_t nearestTo(float log_r) {
  const Curve& grid = logRs();
  const auto after = static_cast<std::size_t>(
      std::lower_bound(grid.begin() + 1, grid.end() - 1, log_r) - grid.begin());
  return log_r - grid[after - 1] <= grid[after] - log_r ? after - 1 : after;
}

float atMost(float cost) {
  const float part = cost / kMostSay, part2 = part * part;
  return cost / std::sqrt(std::sqrt(1 + part2 * part2));
}

}  // namespace

const Curve& logRs() {
  static const Curve grid = [] {
    Curve all;
    for (std::size_t i = 0; i < kCurve; ++i) all[i] = lanes::curveLogR(static_cast<int>(i));
    return all;
  }();
  return grid;
}

Curve slopesOf(const Curve& cost) {
  const Curve& grid = logRs();
  Curve slope;
  const auto rise = [&](std::size_t j) {
    return (cost[j + 1] - cost[j]) / (grid[j + 1] - grid[j]);
  };
  slope.front() = rise(0);
  slope.back() = rise(kCurve - 2);
  for (std::size_t j = 1; j + 1 < kCurve; ++j) {
    const float before = grid[j] - grid[j - 1], after = grid[j + 1] - grid[j];
    const float most = 3 * std::min(std::abs(rise(j - 1)), std::abs(rise(j)));
    slope[j] = std::clamp((rise(j) * before + rise(j - 1) * after) / (before + after), -most, most);
  }
  return slope;
}

Cubic::Cubic(const Curve& cost, const Curve& slope, std::size_t j)
    : h_(logR(j + 1) - logR(j)), p0_(cost[j]), m0_(slope[j] * h_), m1_(slope[j + 1] * h_) {
  const float rise = cost[j + 1] - p0_;
  c2_ = 3 * rise - 2 * m0_ - m1_;
  c3_ = m0_ + m1_ - 2 * rise;
}

float Cubic::lowest() const {
  float low = 0, high = 1;
  for (int round = 0; round < 12; ++round) {
    const float t = (low + high) / 2;
    (m0_ + t * (2 * c2_ + t * 3 * c3_) < 0 ? low : high) = t;
  }
  return (low + high) / 2;
}

void ofLikeTexels(Curve& own, const Curve& held, const Curve& held_slopes) {
  const Valley valley = lowestOf(held, held_slopes);
  const Curve& grid = logRs();
  Curve share;
  for (std::size_t j = 0; j < kCurve; ++j) {
    const float off = grid[j] - valley.log_r, cost = std::max(held[j] - valley.cost, 0.0f);
    share[j] = off * off / (off * off + cost * kLeastSpread2);
  }
  // In the valley's middle it is one nothing over another: as beside it.
  const std::size_t middle = nearestTo(valley.log_r);
  const float before = share[middle > 0 ? middle - 1 : 1],
              after = share[middle + 1 < kCurve ? middle + 1 : kCurve - 2];
  share[middle] = (before + after) / 2;
  const float least = *std::min_element(own.begin(), own.end());
  for (std::size_t j = 0; j < kCurve; ++j) own[j] = atMost((own[j] - least) * share[j]);
}

void keepCurve(FitState& state, const MultiLightOptions& options, const lanes::CostCurve& curve,
               float spread2, int x, int y, int k) {
  const float dielectric = 1 / (options.specular_spread * options.specular_spread);
  Curve own, price;
  for (std::size_t j = 0; j < kCurve; ++j) {
    const float information = curve.information[j][k] / spread2, off = curve.ks[j][k] - kDielectric;
    own[j] = curve.cost[j][k] / spread2;
    price[j] =
        std::min(information * dielectric / (information + dielectric) * off * off, kAnyPrice);
  }
  Curve held = own, slopes = slopesOf(price);
  for (std::size_t j = 0; j < kCurve; ++j) {
    held[j] += price[j];
    slopes[j] += curve.slope[j][k] / spread2;
  }
  ofLikeTexels(own, held, slopes);
  const auto cost = state.curve.view().texel(x, y), moment = state.curve_moment.view().texel(x, y),
             information = state.curve_information.view().texel(x, y);
  for (std::size_t j = 0; j < kCurve; ++j) {
    const float ks = curve.ks[j][k], apart = kLeastShare * ks;
    information[j] = 1 / (spread2 / curve.information[j][k] + apart * apart);
    moment[j] = information[j] * ks;
    cost[j] = own[j] + moment[j] * ks;
  }
}

}  // namespace patina::brdf
