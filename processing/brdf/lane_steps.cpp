// SPDX-License-Identifier: GPL-3.0-or-later
// Levenberg and Marquardt's steps and Cauchy's weights, sixteen texels side by side.
#include <algorithm>
#include <cmath>

#include "processing/brdf/abc.h"
#include "processing/brdf/fit_lanes.h"

namespace patina::brdf::lanes {
namespace {

constexpr float kCauchy = 2.4f;       // of the texel's own spread
constexpr float kFullOver = 2.56f;    // a weight's part at three spreads from the prediction
constexpr float kShadowShare = 0.6f;  // of the prediction, and
constexpr float kShadowSpread = 6;    // spreads below it: cast shadow
constexpr float kPartSigma = 4,
                kPartShare = 0.9f;  // of a texel known to be in shadow of many lamps: in part
constexpr float kAttached = 0.02f;  // n.l from which light counts
constexpr float kTurnMost = 0.25f;  // rad a step
constexpr float kScaleMost = 0.7f;  // of ln r a step
constexpr float kLowestUp = 0.1f;   // n.z
constexpr float kDampLeast = 1e-6f, kDampMost = 1e6f;
constexpr float kSmallTurn = 2e-5f;  // rad; a tile whose steps are all below is done

// One damped step of each lane; `turn` receives how far it goes.
Estimate stepFrom(const Estimate& at, const Tangents& t, const Equations& q, const Lane& damp,
                  Lane& turn) {
  Estimate to = at;
  for (int k = 0; k < kLanes; ++k) {
    const float floor = 1e-12f * (q.h11[k] + q.h22[k] + q.huu[k]) + 1e-20f, d = 1 + damp[k];
    const float h11 = q.h11[k] * d + floor, h22 = q.h22[k] * d + floor, huu = q.huu[k] * d + floor;
    const float h12 = q.h12[k], h1u = q.h1u[k], h2u = q.h2u[k];
    const float c11 = h22 * huu - h2u * h2u, c12 = h1u * h2u - h12 * huu,
                c1u = h12 * h2u - h22 * h1u;
    const float det = h11 * c11 + h12 * c12 + h1u * c1u;
    const float inverse = det > 1e-9f * h11 * h22 * huu ? 1 / det : 0;
    const float b1 = q.b1[k], b2 = q.b2[k], bu = q.bu[k];
    float s1 = inverse * (c11 * b1 + c12 * b2 + c1u * bu);
    float s2 = inverse * (c12 * b1 + (h11 * huu - h1u * h1u) * b2 + (h12 * h1u - h11 * h2u) * bu);
    float su = inverse * (c1u * b1 + (h12 * h1u - h11 * h2u) * b2 + (h11 * h22 - h12 * h12) * bu);
    s1 = std::clamp(s1, -kTurnMost, kTurnMost);
    s2 = std::clamp(s2, -kTurnMost, kTurnMost);
    su = std::clamp(su, -kScaleMost, kScaleMost);
    const float x = at.nx[k] + s1 * t.x1[k] + s2 * t.x2[k], y = at.ny[k] + s2 * t.y2[k],
                z = std::max(at.nz[k] + s1 * t.z1[k] + s2 * t.z2[k], kLowestUp);
    const float length = std::sqrt(x * x + y * y + z * z);
    to.nx[k] = x / length;
    to.ny[k] = y / length;
    to.nz[k] = z / length;
    to.u[k] = std::clamp(at.u[k] + su, std::log(kSmallestR), std::log(kLargestR));
    turn[k] = std::abs(s1) + std::abs(s2) + std::abs(su);
  }
  return to;
}

void takeEquations(Equations& to, const Equations& from, int k) {
  for (auto part :
       {&Equations::cost, &Equations::h11, &Equations::h12, &Equations::h1u, &Equations::h22,
        &Equations::h2u, &Equations::huu, &Equations::b1, &Equations::b2, &Equations::bu,
        &Equations::aa, &Equations::ab, &Equations::bb, &Equations::a1, &Equations::a2,
        &Equations::au, &Equations::g1, &Equations::g2, &Equations::gu})
    (to.*part)[k] = (from.*part)[k];
}

}  // namespace

void takeEstimate(Estimate& to, const Estimate& from, int k) {
  for (auto part :
       {&Estimate::nx, &Estimate::ny, &Estimate::nz, &Estimate::u, &Estimate::kd, &Estimate::ks})
    (to.*part)[k] = (from.*part)[k];
}

void scanRoughness(Model model, Samples& samples, Estimate& at, const Prior& prior) {
  constexpr float kTried[] = {0.05f, 0.09f, 0.16f, 0.28f, 0.5f, 0.85f};
  Estimate best = at;
  Lane least;
  for (int k = 0; k < kLanes; ++k) least[k] = HUGE_VALF;
  Equations q;
  for (const float r : kTried) {
    Estimate tried = at;
    for (int k = 0; k < kLanes; ++k) tried.u[k] = std::log(r);
    evaluateCost(model, samples, tried, prior, q);
    for (int k = 0; k < kLanes; ++k)
      if (q.cost[k] < least[k]) {
        least[k] = q.cost[k];
        takeEstimate(best, tried, k);
      }
  }
  at = best;
}

// The spread is the median of |residual| / sigma over what counts, at least 1: a texel that the
// model does not meet is not told that it is.
void reweigh(Samples& samples, const Estimate& at) {
  std::vector<Lane> off(samples.count), partly(samples.count), sorted(samples.count);
  Lane counted, spread;
  for (std::size_t i = 0; i < samples.count; ++i) {
    const Light& light = samples.light[i];
    for (int k = 0; k < kLanes; ++k) {
      const float there = predicted(light, at, k);
      const float sigmas = (light.y.v[k] - there) * std::sqrt(light.noise.v[k]);
      const bool part = (samples.shadowed.v[k] > 0) & (sigmas < -kPartSigma) &
                        (light.y.v[k] < kPartShare * there);
      const bool counts = (light.weight.v[k] > 0) & !part;
      off[i].v[k] = sigmas;
      partly[i].v[k] = part ? 1.0f : 0.0f;
      sorted[i].v[k] = counts ? std::abs(sigmas) : kLast;
      counted.v[k] += counts ? 1.0f : 0.0f;
    }
  }
  sortLanes(sorted);
  for (int k = 0; k < kLanes; ++k)
    if (counted[k] > 0)
      spread[k] = std::max(1.4826f * sorted[static_cast<std::size_t>(counted[k]) / 2][k], 1.0f);
  for (std::size_t i = 0; i < samples.count; ++i) {
    Light& light = samples.light[i];
    for (int k = 0; k < kLanes; ++k) {
      const float n_l =
          at.nx.v[k] * light.lx.v[k] + at.ny.v[k] * light.ly.v[k] + at.nz.v[k] * light.lz.v[k];
      const float there = predicted(light, at, k);
      const bool cast =
          (light.y.v[k] < kShadowShare * there) & (off[i].v[k] < -kShadowSpread * spread.v[k]);
      const bool left_out = (n_l < kAttached) | (partly[i].v[k] > 0) | cast;
      const float c = off[i].v[k] / (kCauchy * std::max(spread.v[k], 1.0f));
      const float weight = left_out ? 0.0f : light.noise.v[k] / (1 + c * c);
      light.weight.v[k] = counted.v[k] > 0 ? weight : light.weight.v[k];
    }
  }
}

void countInFull(Samples& samples) {
  for (Light& light : samples.light)
    for (int k = 0; k < kLanes; ++k)
      light.weight[k] = std::min(light.noise[k], kFullOver * light.weight[k]);
}

void refine(const MultiLightOptions& options, Samples& samples, Estimate& at, const Prior& prior,
            Equations& equations, bool weigh_first) {
  bool lobes_known = false;  // those at `at`
  for (int round = 0; round < options.rounds; ++round) {
    if (!lobes_known) findLobes(options.model, samples, at);
    if (round > 0 || weigh_first) reweigh(samples, at);
    findEquations(samples, at, prior, equations);
    lobes_known = true;
    Lane damp;
    for (int k = 0; k < kLanes; ++k) damp[k] = 1e-2f;
    for (int step = 0; step < options.steps; ++step) {
      Lane turn;
      Estimate tried = stepFrom(at, tangentsOf(at), equations, damp, turn);
      Equations there;
      evaluate(options.model, samples, tried, prior, there);
      lobes_known = true;
      float largest = 0;
      for (int k = 0; k < kLanes; ++k) {
        const bool better = there.cost[k] < equations.cost[k];
        damp[k] = std::clamp(damp[k] * (better ? 0.1f : 10.0f), kDampLeast, kDampMost);
        lobes_known = lobes_known && better;
        if (!better) continue;
        takeEstimate(at, tried, k);
        takeEquations(equations, there, k);
        largest = std::max(largest, turn[k]);
      }
      if (largest < kSmallTurn) break;
    }
  }
  Equations unused;
  if (!lobes_known) evaluateCost(options.model, samples, at, prior, unused);
}

}  // namespace patina::brdf::lanes
