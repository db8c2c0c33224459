// SPDX-License-Identifier: GPL-3.0-or-later
// Other beginnings for what the fit does not meet: a mirror rather than a matt surface, or one that
// most lamps do not reach.
#include <algorithm>
#include <cmath>

#include "processing/brdf/fit_lanes.h"

namespace patina::brdf::lanes {
namespace {

constexpr float kUnmet = 2;           // chi squared a level
constexpr float kModelShare = 0.05f;  // of a level, that no model meets anyhow
// The most that a level costs, in chi squared. What is black may be in shadow, what is darker than
// predicted at the edge of one; what is brighter nothing explains.
constexpr float kBlackPrice = 9, kDarkPrice = 25, kBrightPrice = 400;
constexpr float kBlackShare = 0.05f;  // of what is predicted
constexpr float kDielectricWeight = 1 / (0.02f * 0.02f);
constexpr float kMattGloss = 0.01f;  // of its level, that a matt surface may have all the same
constexpr int kBrightest = 12;       // levels of which three are lit whole
constexpr float kLeastUp = 0.15f;    // n.z
// Of its levels. Well above a half: the spread is a median, which shadows must not decide.
constexpr float kShadowedBelow = 0.75f;
constexpr float kLitShare = 0.9f;  // of what a matt surface predicts

float price(float level, float predicted, float information) {
  const float off = level - predicted;
  const float most = level < kBlackShare * predicted ? kBlackPrice
                     : off < 0                       ? kDarkPrice
                                                     : kBrightPrice;
  const float model = kModelShare * predicted;
  return std::min(off * off / (1 / information + model * model), most);
}

Lane priceOf(const Samples& s, const Estimate& at) {
  Lane sum;
  for (std::size_t i = 0; i < s.count; ++i)
    for (int k = 0; k < kLanes; ++k) {
      const Light& light = s.light[i];
      if (light.noise[k] > 0) sum[k] += price(light.y[k], predicted(light, at, k), light.noise[k]);
    }
  return sum;
}

struct Level {
  Vec3 light;
  float level, information;  // level over irradiance, 1 / variance
};
using Levels = std::vector<Level>;

Levels levelsOf(const Samples& s, int k) {
  Levels levels;
  for (std::size_t i = 0; i < s.count; ++i) {
    if (!(s.light[i].noise[k] > 0)) continue;
    const float e = s.light[i].e[k], level = s.light[i].y[k] / e, gloss = kMattGloss * level;
    levels.push_back({{s.light[i].lx[k], s.light[i].ly[k], s.light[i].lz[k]},
                      level,
                      1 / (1 / (s.light[i].noise[k] * e * e) + gloss * gloss)});
  }
  return levels;
}

// Albedo times normal of the matt surface that three levels are whole on; 0 where they lie in a
// plane.
Vec3 throughThree(const Level& a, const Level& b, const Level& c) {
  const Vec3 bc = cross(b.light, c.light);
  const float volume = dot(a.light, bc);
  if (std::abs(volume) < 1e-3f) return {0, 0, 0};
  return (bc * a.level + cross(c.light, a.light) * b.level + cross(a.light, b.light) * c.level) *
         (1 / volume);
}

// Of the matt surfaces through three of the brightest levels the cheapest.
Vec3 cheapestMatt(Levels levels) {
  const std::size_t tried = std::min<std::size_t>(levels.size(), kBrightest);
  std::partial_sort(
      levels.begin(), levels.begin() + static_cast<std::ptrdiff_t>(tried), levels.end(),
      [](const Level& a, const Level& b) { return a.level * b.light.z > b.level * a.light.z; });
  Vec3 best{0, 0, 0};
  float least = HUGE_VALF;
  for (std::size_t i = 0; i < tried; ++i)
    for (std::size_t j = 0; j < i; ++j)
      for (std::size_t k = 0; k < j; ++k) {
        const Vec3 b = throughThree(levels[i], levels[j], levels[k]);
        if (!(b.z > kLeastUp * length(b)) || !(length(b) > 0)) continue;
        float sum = 0;
        for (const Level& l : levels) sum += price(l.level, dot(b, l.light), l.information);
        if (sum >= least) continue;
        least = sum;
        best = b;
      }
  return best;
}

void put(Estimate& at, int k, const Vec3& matt) {
  const float albedo = length(matt);
  const Vec3 n = albedo > 0 ? matt * (1 / albedo) : Vec3{0, 0, 1};
  at.nx[k] = n.x, at.ny[k] = n.y, at.nz[k] = n.z;
  at.kd[k] = albedo;
  at.ks[k] = 0;
}

// All that is darker than the cheapest matt surface is in shadow.
void startLit(Samples& s, const Lane& wanted, Estimate& at) {
  for (int k = 0; k < kLanes; ++k) {
    if (!(wanted[k] > 0)) continue;
    put(at, k, cheapestMatt(levelsOf(s, k)));
    for (std::size_t i = 0; i < s.count; ++i) {
      const float n_l =
          at.nx[k] * s.light[i].lx[k] + at.ny[k] * s.light[i].ly[k] + at.nz[k] * s.light[i].lz[k];
      const bool lit = n_l > 0 && s.light[i].y[k] > kLitShare * at.kd[k] * s.light[i].e[k] * n_l;
      s.light[i].weight[k] = lit ? s.light[i].noise[k] : 0;
    }
  }
}

// The normal where highlights are: the mean of the half vectors by the square of the level.
void startMirror(Samples& s, const Lane& wanted, Estimate& at) {
  for (int k = 0; k < kLanes; ++k) {
    if (!(wanted[k] > 0)) continue;
    Vec3 sum{0, 0, 0};
    for (std::size_t i = 0; i < s.count; ++i) {
      s.light[i].weight[k] = s.light[i].noise[k];
      const float level = s.light[i].noise[k] > 0 ? s.light[i].y[k] / s.light[i].e[k] : 0;
      sum = sum + Vec3{s.light[i].hx[k], s.light[i].hy[k], s.light[i].hz[k]} * (level * level);
    }
    put(at, k, sum);
  }
}

int litOf(const Samples& s, int k) {
  int lit = 0;
  for (std::size_t i = 0; i < s.count; ++i) lit += s.light[i].weight[k] > 0;
  return lit;
}

int usableOf(const Samples& s, int k) {
  int usable = 0;
  for (std::size_t i = 0; i < s.count; ++i) usable += s.light[i].noise[k] > 0;
  return usable;
}

}  // namespace

void tryRivals(const MultiLightOptions& options, Samples& s, Estimate& at, const Prior& prior,
               Equations& equations) {
  Lane least = priceOf(s, at), unmet, shadowed;
  bool any = false;
  for (int k = 0; k < kLanes; ++k) {
    unmet[k] = least[k] > kUnmet * static_cast<float>(s.count) ? 1 : 0;
    any = any || unmet[k] > 0;
  }
  if (!any) return;
  Prior dielectric = prior;
  for (int k = 0; k < kLanes; ++k) dielectric.ks_weight[k] = kDielectricWeight;
  // What began as one that many lamps do not reach stays one.
  for (int k = 0; k < kLanes; ++k)
    shadowed[k] = unmet[k] > 0 && static_cast<float>(litOf(s, k)) <
                                      kShadowedBelow * static_cast<float>(usableOf(s, k));
  const Estimate found = at;
  std::vector<Lane> best(s.count);
  for (std::size_t i = 0; i < s.count; ++i) best[i] = s.light[i].weight;
  enum { kMirror, kShaded, kLit };
  for (const int rival : {kMirror, kShaded, kLit}) {
    Estimate other = found;
    s.shadowed = rival == kMirror ? Lane{} : unmet;
    const Prior& held = rival == kMirror ? prior : dielectric;
    if (rival != kShaded) {
      rival == kMirror ? startMirror(s, unmet, other) : startLit(s, unmet, other);
      scanRoughness(options.model, s, other, held);
    }
    refine(options, s, other, held, equations, rival == kShaded);
    const Lane costs = priceOf(s, other);
    for (int k = 0; k < kLanes; ++k) {
      if (!(unmet[k] > 0 && costs[k] < least[k]) || litOf(s, k) < kFewestLit) continue;
      least[k] = costs[k];
      shadowed[k] = rival == kMirror ? 0 : 1;
      takeEstimate(at, other, k);
      for (std::size_t i = 0; i < s.count; ++i) best[i][k] = s.light[i].weight[k];
    }
  }
  for (std::size_t i = 0; i < s.count; ++i) s.light[i].weight = best[i];
  s.shadowed = shadowed;
  evaluate(options.model, s, at, prior, equations);
}

}  // namespace patina::brdf::lanes
