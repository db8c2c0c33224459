// SPDX-License-Identifier: GPL-3.0-or-later
// Sixteen texels of a row side by side, as the fit works on them. Only the fit includes this.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "processing/brdf/multi_light_fit.h"

namespace patina::brdf::lanes {

constexpr int kLanes = 16;
struct alignas(64) Lane {
  float v[kLanes] = {};
  float& operator[](int k) { return v[k]; }
  float operator[](int k) const { return v[k]; }
};

// A picture's levels and light at sixteen texels.
struct Light {
  Lane lx, ly, lz, hx, hy, hz, v_h;    // unit directions to the light, halfway
  Lane half;                           // 1 / |l + v|
  Lane m;                              // Schlick's weight; 0 for models without
  Lane e;                              // irradiance across the rays
  Lane y;                              // level, mean of the channels
  Lane noise;                          // 1 / sigma^2; 0: clipped or unknown
  Lane weight;                         // noise times what the residual says
  Lane a, g, a_1, a_2, g_1, g_2, g_u;  // scratch: diffuse part, lobe and their slopes, times E
  Vec3 view;
};
struct Samples {
  explicit Samples(std::size_t n) : count(n), light(n) {}
  std::size_t count;
  std::vector<Light> light;  // of each picture
  Lane shadowed;  // above 0: from many lamps, so what lies below the prediction is shadow
};

// What the nonlinear part looks for, and the linear one that goes with it.
struct Estimate {
  Lane nx, ny, nz, u;  // u = ln r
  Lane kd, ks;
};
void takeEstimate(Estimate& to, const Estimate& from, int k);  // of lane k
// The level that lobes and diffuse parts at `at` show.
inline float predicted(const Light& light, const Estimate& at, int k) {
  const float m = light.m.v[k];
  return at.kd.v[k] * light.a.v[k] + (at.ks.v[k] * (1 - m) + m) * light.g.v[k];
}
struct Prior {
  Lane u, u_weight, ks, ks_weight;  // weight = 1 / variance
  bool signed_strengths = false;  // kd and ks may come out below 0, as estimates to be averaged do
};
// Normal equations with kd and ks projected out, at an estimate. 1, 2: turns of the normal along
// its tangents.
struct Equations {
  Lane cost;
  Lane h11, h12, h1u, h22, h2u, huu, b1, b2, bu;
  Lane aa, ab, bb;              // of kd and ks
  Lane a1, a2, au, g1, g2, gu;  // between linear and nonlinear
};

struct Tangents {
  Lane x1, y1, z1, x2, y2, z2;
};
Tangents tangentsOf(const Estimate& at);

// kd, ks >= 0 of least squares; a part that would be negative is 0 and the other solved alone.
inline void solveLinear(float aa, float ab, float bb, float ay, float by, float& kd, float& ks) {
  const float det = aa * bb - ab * ab;
  const bool regular = det > 1e-6f * aa * bb;
  const float divisor = regular ? det : 1.0f;
  const float d = (bb * ay - ab * by) / divisor, s = (aa * by - ab * ay) / divisor;
  const float d_alone = std::max(ay, 0.0f) / (aa > 0 ? aa : HUGE_VALF);
  const float s_alone = std::max(by, 0.0f) / (bb > 0 ? bb : HUGE_VALF);
  // The single part that explains more: its drop of the cost is the product below.
  const bool diffuse = d_alone * ay >= s_alone * by, both = regular & (d >= 0) & (s >= 0);
  const float d_one = diffuse ? d_alone : 0.0f, s_one = diffuse ? 0.0f : s_alone;
  kd = both ? d : d_one;
  ks = both ? s : s_one;
}

// Solves kd and ks at `at` (which receives them) and fills `out`; of the cost alone, its slopes
// stay as they were. Picks the widest SIMD path the machine has; all give the same bits.
// findLobes: the scratch; findEquations: what follows from it, the levels and their weights.
void findLobes(Model model, Samples& samples, const Estimate& at);
void findEquations(const Samples& samples, Estimate& at, const Prior& prior, Equations& out);
void evaluate(Model model, Samples& samples, Estimate& at, const Prior& prior, Equations& out);
void evaluateCost(Model model, Samples& samples, Estimate& at, const Prior& prior, Equations& out);

// Each lane's values in rising order; all are finite. O(n log^2 n).
constexpr float kLast = std::numeric_limits<float>::max();  // sorts after what counts
void sortLanes(std::vector<Lane>& values);
// Photometric stereo: normal and kd from the middle quantiles, then reweighted. Sets weights: those
// of clipped levels and of shadows are 0, highlights count.
void photometricStart(Samples& samples, Estimate& at);
// The roughness of least cost out of a few, from the normal at hand.
void scanRoughness(Model model, Samples& samples, Estimate& at, const Prior& prior);
// Least costs over kd, ks and the normal (by one step of Gauss and Newton from
// the one at hand) for roughnesses of a grid, held to no prior, with the weights as they are; their
// slopes by ln r; and ks of either sign with 1 / its variance, in units of the noise.
constexpr int kCurve = 41;
constexpr float kSmallestR = 0.02f, kLargestR = 1.0f;
// ln r of entry j, rising between those. Wide lobes change sooner: entries are even in ln r + 3 r.
float curveLogR(int j);
struct CostCurve {
  Lane cost[kCurve], slope[kCurve], ks[kCurve], information[kCurve];
};
void costCurve(Model model, Samples& samples, const Estimate& at, CostCurve& curve);
// Rounds of weights and steps, the first with the weights at hand, or with what residuals at `at`
// say if `weigh_first`. `equations` are those of the end.
void refine(const MultiLightOptions& options, Samples& samples, Estimate& at, const Prior& prior,
            Equations& equations, bool weigh_first = false);
constexpr int kFewestLit = 5;  // levels: of fewer anything is explained
// Where much is not met: the same from a mirror's normal, and with all but the brightest levels
// taken for shadow; the one that costs least, if kFewestLit levels count. After refine().
void tryRivals(const MultiLightOptions& options, Samples& samples, Estimate& at, const Prior& prior,
               Equations& equations);
// From residuals at `at`, whose lobes have just been found.
void reweigh(Samples& samples, const Estimate& at);
// After that: levels within three spreads of `at` count in full. Less by less, they are right for
// that estimate's roughness, of whose noise they then carry a part to all others.
void countInFull(Samples& samples);

struct Certainty {
  // 1 / (1 + (sigma of ks / 0.014)^2 + (sigma of r / 0.021)^2), by its own lights and the priors:
  // from a half on, two thirds of such texels lie within 0.014 and 0.021.
  double confidence = 0;
  double specular_weight = 0;  // 1 / variance of ks, with the prior of ln r but not that of ks
};
// Of lane k; `spread2`: of the residuals, in units of the noise.
Certainty certaintyOf(const Estimate& at, const Equations& q, const Prior& prior, double spread2,
                      int k);

}  // namespace patina::brdf::lanes
