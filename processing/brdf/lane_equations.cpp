// SPDX-License-Identifier: GPL-3.0-or-later
// The inner loops of the fit. Plain loops over lanes: the compiler makes vectors of them, for each
// of the instruction sets below, and no path adds in another order than the next.
#include <algorithm>
#include <cmath>

#include "processing/brdf/fit_lanes.h"
#include "processing/brdf/ggx.h"
#include "processing/brdf/torrance_sparrow.h"
#include "processing/brdf/ward.h"

#ifdef __clang__
#define PATINA_LANES
#else
#define PATINA_LANES _Pragma("GCC ivdep")
#endif
#define PATINA_INLINE inline __attribute__((always_inline))

namespace patina::brdf::lanes {
namespace {

constexpr float kGrazing = 1e-3f;  // cosines are not below

struct Ggx {
  static PATINA_INLINE Lobe at(const LobeCosines& c, float r) { return ggxLobe(c, r); }
};
struct Ward {
  static PATINA_INLINE Lobe at(const LobeCosines& c, float r) { return wardLobe(c, r); }
};
struct TorranceSparrow {
  static PATINA_INLINE Lobe at(const LobeCosines& c, float r) { return torranceSparrowLobe(c, r); }
};

PATINA_INLINE float limited(float cosine) { return std::min(std::max(cosine, kGrazing), 1.0f); }

// First pass: lobes, and the sums that kd and ks come from.
template <class Model, bool kSlopes>
PATINA_INLINE void lobes(Samples& s, const Estimate& at, const Tangents& t, Lane (&sums)[5]) {
  for (std::size_t i = 0; i < s.count; ++i) {
    const Lane &lx = s.lx[i], &ly = s.ly[i], &lz = s.lz[i], &hx = s.hx[i], &hy = s.hy[i],
               &hz = s.hz[i], &v_h = s.v_h[i], &m = s.m[i], &e = s.e[i], &y = s.y[i],
               &weight = s.weight[i];
    Lane &a = s.a[i], &g = s.g[i], &g_1 = s.g_1[i], &g_2 = s.g_2[i], &g_u = s.g_u[i];
    const Vec3 v = s.view[i];
    PATINA_LANES
    for (int k = 0; k < kLanes; ++k) {
      const float nx = at.nx.v[k], ny = at.ny.v[k], nz = at.nz.v[k];
      const float r = exp2Inline(1.44269504f * at.u.v[k]);
      const float n_l = limited(nx * lx.v[k] + ny * ly.v[k] + nz * lz.v[k]);
      const float n_v = limited(nx * v.x + ny * v.y + nz * v.z);
      const float n_h = limited(nx * hx.v[k] + ny * hy.v[k] + nz * hz.v[k]);
      const Lobe lobe = Model::at({n_l, n_v, n_h, v_h.v[k]}, r);
      const float scale = kPi * e.v[k], diffuse = e.v[k] * n_l, gloss = scale * lobe.value * n_l;
      a.v[k] = diffuse;
      g.v[k] = gloss;
      if (kSlopes) {
        const float l1 = t.x1.v[k] * lx.v[k] + t.y1.v[k] * ly.v[k] + t.z1.v[k] * lz.v[k];
        const float l2 = t.x2.v[k] * lx.v[k] + t.y2.v[k] * ly.v[k] + t.z2.v[k] * lz.v[k];
        const float h1 = t.x1.v[k] * hx.v[k] + t.y1.v[k] * hy.v[k] + t.z1.v[k] * hz.v[k];
        const float h2 = t.x2.v[k] * hx.v[k] + t.y2.v[k] * hy.v[k] + t.z2.v[k] * hz.v[k];
        const float v1 = t.x1.v[k] * v.x + t.y1.v[k] * v.y + t.z1.v[k] * v.z;
        const float v2 = t.x2.v[k] * v.x + t.y2.v[k] * v.y + t.z2.v[k] * v.z;
        const float by_l = lobe.by_n_l * n_l + lobe.value;
        g_1.v[k] = scale * (by_l * l1 + n_l * (lobe.by_n_v * v1 + lobe.by_n_h * h1));
        g_2.v[k] = scale * (by_l * l2 + n_l * (lobe.by_n_v * v2 + lobe.by_n_h * h2));
        g_u.v[k] = scale * n_l * lobe.by_r * r;
      }
      const float w = weight.v[k], b = (1.0f - m.v[k]) * gloss, rest = y.v[k] - m.v[k] * gloss;
      sums[0].v[k] += w * diffuse * diffuse;
      sums[1].v[k] += w * diffuse * b;
      sums[2].v[k] += w * b * b;
      sums[3].v[k] += w * diffuse * rest;
      sums[4].v[k] += w * b * rest;
    }
  }
}

PATINA_INLINE void costAlone(const Samples& s, const Estimate& at, Lane& cost) {
  for (std::size_t i = 0; i < s.count; ++i) {
    const Lane &m = s.m[i], &y = s.y[i], &weight = s.weight[i], &a = s.a[i], &g = s.g[i];
    PATINA_LANES
    for (int k = 0; k < kLanes; ++k) {
      const float strength = at.ks.v[k] * (1.0f - m.v[k]) + m.v[k];
      const float off = y.v[k] - at.kd.v[k] * a.v[k] - strength * g.v[k];
      cost.v[k] += weight.v[k] * off * off;
    }
  }
}

// Second pass: residuals against slopes.
PATINA_INLINE void slopes(const Samples& s, const Estimate& at, const Tangents& t, Equations& q) {
  for (std::size_t i = 0; i < s.count; ++i) {
    const Lane &lx = s.lx[i], &ly = s.ly[i], &lz = s.lz[i], &m = s.m[i], &e = s.e[i], &y = s.y[i],
               &weight = s.weight[i], &a = s.a[i], &g = s.g[i], &g_1 = s.g_1[i], &g_2 = s.g_2[i],
               &g_u = s.g_u[i];
    PATINA_LANES
    for (int k = 0; k < kLanes; ++k) {
      const float l1 = t.x1.v[k] * lx.v[k] + t.y1.v[k] * ly.v[k] + t.z1.v[k] * lz.v[k];
      const float l2 = t.x2.v[k] * lx.v[k] + t.y2.v[k] * ly.v[k] + t.z2.v[k] * lz.v[k];
      const float strength = at.ks.v[k] * (1.0f - m.v[k]) + m.v[k];
      const float off = y.v[k] - at.kd.v[k] * a.v[k] - strength * g.v[k];
      const float d = at.kd.v[k] * e.v[k], w = weight.v[k], b = (1.0f - m.v[k]) * g.v[k];
      const float s1 = d * l1 + strength * g_1.v[k], s2 = d * l2 + strength * g_2.v[k],
                  su = strength * g_u.v[k];
      const float w1 = w * s1, w2 = w * s2, wu = w * su;
      q.cost.v[k] += w * off * off;
      q.h11.v[k] += w1 * s1;
      q.h12.v[k] += w1 * s2;
      q.h1u.v[k] += w1 * su;
      q.h22.v[k] += w2 * s2;
      q.h2u.v[k] += w2 * su;
      q.huu.v[k] += wu * su;
      q.b1.v[k] += w1 * off;
      q.b2.v[k] += w2 * off;
      q.bu.v[k] += wu * off;
      q.a1.v[k] += w1 * a.v[k];
      q.a2.v[k] += w2 * a.v[k];
      q.au.v[k] += wu * a.v[k];
      q.g1.v[k] += w1 * b;
      q.g2.v[k] += w2 * b;
      q.gu.v[k] += wu * b;
    }
  }
}

// Takes out of the nonlinear equations what kd and ks can do themselves: the Schur complement.
PATINA_INLINE void projectLinear(const Estimate& at, Equations& q) {
  PATINA_LANES
  for (int k = 0; k < kLanes; ++k) {
    const float has_d = at.kd.v[k] > 0 ? 1.0f : 0.0f, has_s = at.ks.v[k] > 0 ? 1.0f : 0.0f;
    const float aa = q.aa.v[k] * has_d + (1.0f - has_d), bb = q.bb.v[k] * has_s + (1.0f - has_s);
    const float ab = q.ab.v[k] * has_d * has_s;
    const float det = std::max(aa * bb - ab * ab, 1e-6f * aa * bb + 1e-30f);
    const float iaa = has_d * bb / det, ibb = has_s * aa / det, iab = -ab / det;
    const float a1 = q.a1.v[k], a2 = q.a2.v[k], au = q.au.v[k], g1 = q.g1.v[k], g2 = q.g2.v[k],
                gu = q.gu.v[k];
    const float pa1 = iaa * a1 + iab * g1, pg1 = iab * a1 + ibb * g1;
    const float pa2 = iaa * a2 + iab * g2, pg2 = iab * a2 + ibb * g2;
    const float pau = iaa * au + iab * gu, pgu = iab * au + ibb * gu;
    q.h11.v[k] -= pa1 * a1 + pg1 * g1;
    q.h12.v[k] -= pa1 * a2 + pg1 * g2;
    q.h1u.v[k] -= pa1 * au + pg1 * gu;
    q.h22.v[k] -= pa2 * a2 + pg2 * g2;
    q.h2u.v[k] -= pa2 * au + pg2 * gu;
    q.huu.v[k] -= pau * au + pgu * gu;
  }
}

template <class Model, bool kSlopes>
PATINA_INLINE void evaluateAll(Samples& samples, Estimate& at, const Prior& prior,
                               const Tangents& tangents, Equations& q) {
  Lane sums[5];
  lobes<Model, kSlopes>(samples, at, tangents, sums);
  PATINA_LANES
  for (int k = 0; k < kLanes; ++k) {
    q.aa.v[k] = sums[0].v[k];
    q.ab.v[k] = sums[1].v[k];
    q.bb.v[k] = sums[2].v[k] + prior.ks_weight.v[k];
    const float by = sums[4].v[k] + prior.ks_weight.v[k] * prior.ks.v[k];
    solveLinear(q.aa.v[k], q.ab.v[k], q.bb.v[k], sums[3].v[k], by, at.kd.v[k], at.ks.v[k]);
  }
  if (kSlopes) {
    const Lane aa = q.aa, ab = q.ab, bb = q.bb;
    q = Equations{};
    q.aa = aa, q.ab = ab, q.bb = bb;
    slopes(samples, at, tangents, q);
    projectLinear(at, q);
  } else {
    q.cost = Lane{};
    costAlone(samples, at, q.cost);
  }
  PATINA_LANES
  for (int k = 0; k < kLanes; ++k) {
    const float u_off = prior.u.v[k] - at.u.v[k], ks_off = prior.ks.v[k] - at.ks.v[k];
    q.cost.v[k] += prior.u_weight.v[k] * u_off * u_off + prior.ks_weight.v[k] * ks_off * ks_off;
    if (kSlopes) {
      q.huu.v[k] += prior.u_weight.v[k];
      q.bu.v[k] += prior.u_weight.v[k] * u_off;
    }
  }
}

template <bool kSlopes>
PATINA_INLINE void evaluateModel(Model model, Samples& samples, Estimate& at, const Prior& prior,
                                 const Tangents& tangents, Equations& q) {
  if (model == Model::kGgx)
    evaluateAll<Ggx, kSlopes>(samples, at, prior, tangents, q);
  else if (model == Model::kTorranceSparrow)
    evaluateAll<TorranceSparrow, kSlopes>(samples, at, prior, tangents, q);
  else
    evaluateAll<Ward, kSlopes>(samples, at, prior, tangents, q);
}

// NOLINTBEGIN(bugprone-macro-parentheses): an attribute cannot stand in any.
#define PATINA_PATH(name, attribute)                                                     \
  attribute void name##Slopes(Model model, Samples& s, Estimate& at, const Prior& prior, \
                              const Tangents& t, Equations& q) {                         \
    evaluateModel<true>(model, s, at, prior, t, q);                                      \
  }                                                                                      \
  attribute void name##Cost(Model model, Samples& s, Estimate& at, const Prior& prior,   \
                            const Tangents& t, Equations& q) {                           \
    evaluateModel<false>(model, s, at, prior, t, q);                                     \
  }
// NOLINTEND(bugprone-macro-parentheses)
PATINA_PATH(plain, )
#ifdef __x86_64__
PATINA_PATH(avx2, __attribute__((target("avx2"))))
PATINA_PATH(avx512, __attribute__((target("avx512f,avx512dq,avx512bw,avx512vl"))))
#endif

using Kernel = void (*)(Model, Samples&, Estimate&, const Prior&, const Tangents&, Equations&);
struct Kernels {
  Kernel slopes, cost;
};
Kernels kernelsHere() {
#ifdef __x86_64__
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl"))
    return {avx512Slopes, avx512Cost};
  if (__builtin_cpu_supports("avx2")) return {avx2Slopes, avx2Cost};
#endif
  return {plainSlopes, plainCost};
}
const Kernels& kernels() {
  static const Kernels here = kernelsHere();
  return here;
}

}  // namespace

Samples::Samples(std::size_t n)
    : count(n),
      lx(n),
      ly(n),
      lz(n),
      hx(n),
      hy(n),
      hz(n),
      v_h(n),
      m(n),
      e(n),
      y(n),
      noise(n),
      weight(n),
      view(n),
      a(n),
      g(n),
      g_1(n),
      g_2(n),
      g_u(n) {}

// n.z is above 0, so the first tangent has a length.
Tangents tangentsOf(const Estimate& at) {
  Tangents t;
  for (int k = 0; k < kLanes; ++k) {
    const float nx = at.nx[k], ny = at.ny[k], nz = at.nz[k];
    const float length = std::sqrt(nx * nx + nz * nz), x = nz / length, z = -nx / length;
    t.x1[k] = x;
    t.z1[k] = z;
    t.x2[k] = ny * z;
    t.y2[k] = nz * x - nx * z;
    t.z2[k] = -ny * x;
  }
  return t;
}

void evaluate(Model model, Samples& samples, Estimate& at, const Prior& prior, Equations& out) {
  kernels().slopes(model, samples, at, prior, tangentsOf(at), out);
}

void evaluateCost(Model model, Samples& samples, Estimate& at, const Prior& prior, Equations& out) {
  kernels().cost(model, samples, at, prior, Tangents{}, out);
}

}  // namespace patina::brdf::lanes
