// SPDX-License-Identifier: GPL-3.0-or-later
// What each roughness costs a texel, and the strength that goes with it.
#include <algorithm>
#include <array>
#include <cmath>

#include "processing/brdf/fit_lanes.h"

namespace patina::brdf::lanes {
namespace {

constexpr float kCurveBend = 3, kRidge = 0.05f;  // of ks, where no lamp meets the lobe
constexpr float kUnlikely = 50;  // of cost above the least, in units of the texel's spread
constexpr float kLeastVariance = 1e-12f;

std::array<float, kCurve> evenlyBent() {
  const auto place = [](float log_r) { return log_r + kCurveBend * std::exp(log_r); };
  const float low = place(std::log(kSmallestR)), high = place(std::log(kLargestR));
  std::array<float, kCurve> grid{};
  float log_r = std::log(kSmallestR);
  for (int j = 0; j < kCurve; ++j) {
    const float wanted = low + (high - low) * static_cast<float>(j) / (kCurve - 1);
    for (int round = 0; round < 12; ++round)
      log_r -= (place(log_r) - wanted) / (1 + kCurveBend * std::exp(log_r));
    grid[static_cast<std::size_t>(j)] = log_r;
  }
  return grid;
}

// Of ks at this roughness, whatever kd and the normal are; k1, k2: what the normal's turns do to
// it.
struct StrengthVariance {
  float k1, k2, variance;
};
StrengthVariance strengthVariance(const Equations& q, const Estimate& at, float inverse, int k) {
  const float aa = q.aa[k], ab = q.ab[k], bb = q.bb[k], det = aa * bb - ab * ab;
  const bool both = at.kd[k] != 0 && det > 1e-6f * aa * bb;
  const float iab = both ? -ab / det : 0, ibb = both ? aa / det : 1 / bb;
  const float k1 = iab * q.a1[k] + ibb * q.g1[k], k2 = iab * q.a2[k] + ibb * q.g2[k];
  const float turns = k1 * k1 * q.h22[k] - 2 * k1 * k2 * q.h12[k] + k2 * k2 * q.h11[k];
  return {k1, k2, ibb + inverse * turns};
}

void costAt(Model model, Samples& samples, const Estimate& at, int j, CostCurve& curve) {
  Prior none;
  none.signed_strengths = true;
  Estimate tried = at;
  for (int k = 0; k < kLanes; ++k) none.ks_weight[k] = kRidge, tried.u[k] = curveLogR(j);
  Equations q;
  evaluate(model, samples, tried, none, q);
  for (int k = 0; k < kLanes; ++k) {
    const float h11 = q.h11[k], h12 = q.h12[k], h22 = q.h22[k], b1 = q.b1[k], b2 = q.b2[k];
    const float det = h11 * h22 - h12 * h12, inverse = det > 1e-6f * h11 * h22 ? 1 / det : 0;
    const float s1 = inverse * (h22 * b1 - h12 * b2), s2 = inverse * (h11 * b2 - h12 * b1);
    const StrengthVariance of_ks = strengthVariance(q, tried, inverse, k);
    curve.cost[j][k] = std::max(q.cost[k] - s1 * b1 - s2 * b2, 0.0f);
    curve.slope[j][k] = -2 * (q.bu[k] - s1 * q.h1u[k] - s2 * q.h2u[k]);
    curve.ks[j][k] = tried.ks[k] - (of_ks.k1 * s1 + of_ks.k2 * s2);
    curve.information[j][k] = 1 / std::max(of_ks.variance, kLeastVariance);
  }
}

// Of the entries that are known before those between them: the even ones and the last.
Lane leastOf(const CostCurve& curve) {
  Lane least = curve.cost[kCurve - 1];
  for (int j = 0; j < kCurve; j += 2)
    for (int k = 0; k < kLanes; ++k) least[k] = std::min(least[k], curve.cost[j][k]);
  return least;
}

// Whether the entries around j are likely enough, in any lane, for j to be asked for.
bool isNearLeast(const CostCurve& curve, int j, const Lane& least, std::size_t count) {
  for (int k = 0; k < kLanes; ++k) {
    const float spread2 = std::max(1.0f, least[k] / static_cast<float>(count));
    if (std::min(curve.cost[j - 1][k], curve.cost[j + 1][k]) < least[k] + kUnlikely * spread2)
      return true;
  }
  return false;
}

// Entry j by the cubics through those around it.
void fillBetween(CostCurve& curve, int j) {
  const float h = curveLogR(j + 1) - curveLogR(j - 1), t = (curveLogR(j) - curveLogR(j - 1)) / h;
  for (int k = 0; k < kLanes; ++k) {
    const float p0 = curve.cost[j - 1][k], rise = curve.cost[j + 1][k] - p0,
                m0 = h * curve.slope[j - 1][k], m1 = h * curve.slope[j + 1][k];
    const float c2 = 3 * rise - 2 * m0 - m1, c3 = m0 + m1 - 2 * rise;
    curve.cost[j][k] = std::max(p0 + t * (m0 + t * (c2 + t * c3)), 0.0f);
    curve.slope[j][k] = (m0 + t * (2 * c2 + t * 3 * c3)) / h;
    curve.ks[j][k] = curve.ks[j - 1][k] * (1 - t) + curve.ks[j + 1][k] * t;
    curve.information[j][k] =
        curve.information[j - 1][k] * (1 - t) + curve.information[j + 1][k] * t;
  }
}

}  // namespace

float curveLogR(int j) {
  static const std::array<float, kCurve> grid = evenlyBent();
  return grid[static_cast<std::size_t>(j)];
}

void costCurve(Model model, Samples& samples, const Estimate& at, CostCurve& curve) {
  for (int j = 0; j < kCurve; j += 2) costAt(model, samples, at, j, curve);
  costAt(model, samples, at, kCurve - 1, curve);
  const Lane least = leastOf(curve);
  for (int j = 1; j + 1 < kCurve; j += 2)
    if (isNearLeast(curve, j, least, samples.count))
      costAt(model, samples, at, j, curve);
    else
      fillBetween(curve, j);
}

}  // namespace patina::brdf::lanes
