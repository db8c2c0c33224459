// SPDX-License-Identifier: GPL-3.0-or-later
// The inner loops of the fit. Plain loops over lanes: the compiler makes vectors of them, for each
// of the instruction sets below, and no path adds in another order than the next.
#include <algorithm>
#include <array>
#include <bit>
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

// Of each model what a texel and a view give for all lights, what takes long of a light, and the
// lobe: apart, so that processors find something to do while they divide.
struct Ggx {
  using Texel = GgxTexel;
  using Light = GgxLight;
  static PATINA_INLINE Texel texel(float n_v, float r) { return ggxTexel(n_v, r); }
  static PATINA_INLINE Light light(const Texel& t, float n_l, float n_h) {
    return ggxLight(t, n_l, n_h);
  }
  static PATINA_INLINE Lobe at(const Texel& t, const Light& light, const LobeCosines& c) {
    return ggxLobe(t, light, c.n_l, c.n_h);
  }
};
struct Roughness {
  float n_v, r;
};
struct Nothing {
  float none = 0;
};
struct Ward {
  using Texel = Roughness;
  using Light = Nothing;
  static PATINA_INLINE Texel texel(float n_v, float r) { return {n_v, r}; }
  static PATINA_INLINE Light light(const Texel&, float, float) { return {}; }
  static PATINA_INLINE Lobe at(const Texel& t, const Light&, const LobeCosines& c) {
    return wardLobe(c, t.r);
  }
};
struct TorranceSparrow {
  using Texel = Roughness;
  using Light = Nothing;
  static PATINA_INLINE Texel texel(float n_v, float r) { return {n_v, r}; }
  static PATINA_INLINE Light light(const Texel&, float, float) { return {}; }
  static PATINA_INLINE Lobe at(const Texel& t, const Light&, const LobeCosines& c) {
    return torranceSparrowLobe(c, t.r);
  }
};

PATINA_INLINE float limited(float cosine) { return std::max(cosine, kGrazing); }

// Lanes of a struct of floats.
template <class T>
struct Lanes {
  static constexpr std::size_t kParts = sizeof(T) / sizeof(float);
  Lane part[kParts];
  PATINA_INLINE void put(int k, const T& value) {
    const auto parts = std::bit_cast<std::array<float, kParts>>(value);
    for (std::size_t p = 0; p < kParts; ++p) part[p].v[k] = parts[p];
  }
  PATINA_INLINE T at(int k) const {
    std::array<float, kParts> parts;
    for (std::size_t p = 0; p < kParts; ++p) parts[p] = part[p].v[k];
    return std::bit_cast<T>(parts);
  }
};

template <class Model>
struct View {
  Lane n_v, v_1, v_2;  // along the normal and its tangents
  Lanes<typename Model::Texel> texel;
};
template <class Model>
PATINA_INLINE void look(const Vec3& v, const Estimate& at, const Tangents& t, View<Model>& view) {
  PATINA_LANES
  for (int k = 0; k < kLanes; ++k) {
    const float n_v = at.nx.v[k] * v.x + at.ny.v[k] * v.y + at.nz.v[k] * v.z;
    view.n_v.v[k] = n_v;
    view.v_1.v[k] = t.x1.v[k] * v.x + t.z1.v[k] * v.z;
    view.v_2.v[k] = t.x2.v[k] * v.x + t.y2.v[k] * v.y + t.z2.v[k] * v.z;
    view.texel.put(k, Model::texel(limited(n_v), exp2Inline(1.44269504f * at.u.v[k])));
  }
}

PATINA_INLINE bool same(const Vec3& a, const Vec3& b) {
  return a.x == b.x && a.y == b.y && a.z == b.z;
}

// Diffuse parts and lobes, and how they change. h = (l + v) / |l + v|, so what the half vector does
// follows from light and view.
template <class Model, bool kSlopes>
PATINA_INLINE void lobes(Samples& s, const Estimate& at, const Tangents& t) {
  View<Model> view;
  for (std::size_t i = 0; i < s.count; ++i) {
    Light& light = s.light[i];
    if (i == 0 || !same(light.view, s.light[i - 1].view)) look<Model>(light.view, at, t, view);
    Lane n_l, n_h;
    Lanes<typename Model::Light> slow;
    PATINA_LANES
    for (int k = 0; k < kLanes; ++k) {
      const float to_l =
          at.nx.v[k] * light.lx.v[k] + at.ny.v[k] * light.ly.v[k] + at.nz.v[k] * light.lz.v[k];
      n_l.v[k] = limited(to_l);
      n_h.v[k] = limited((to_l + view.n_v.v[k]) * light.half.v[k]);
    }
    PATINA_LANES
    for (int k = 0; k < kLanes; ++k)
      slow.put(k, Model::light(view.texel.at(k), n_l.v[k], n_h.v[k]));
    PATINA_LANES
    for (int k = 0; k < kLanes; ++k) {
      const auto texel = view.texel.at(k);
      const LobeCosines c{n_l.v[k], texel.n_v, n_h.v[k], light.v_h.v[k]};
      const Lobe lobe = Model::at(texel, slow.at(k), c);
      const float e = light.e.v[k], half = light.half.v[k], diffuse = e * c.n_l;
      light.a.v[k] = diffuse;
      light.g.v[k] = kPi * diffuse * lobe.value;
      if (kSlopes) {
        const float x = light.lx.v[k], y = light.ly.v[k], z = light.lz.v[k];
        const float l1 = t.x1.v[k] * x + t.z1.v[k] * z;
        const float l2 = t.x2.v[k] * x + t.y2.v[k] * y + t.z2.v[k] * z;
        const float by_h = lobe.by_n_h * half, scale = kPi * e;
        const float by_l = scale * (c.n_l * (lobe.by_n_l + by_h) + lobe.value);
        const float by_v = scale * (c.n_l * (lobe.by_n_v + by_h));
        light.a_1.v[k] = e * l1;
        light.a_2.v[k] = e * l2;
        light.g_1.v[k] = by_l * l1 + by_v * view.v_1.v[k];
        light.g_2.v[k] = by_l * l2 + by_v * view.v_2.v[k];
        light.g_u.v[k] = kPi * diffuse * lobe.by_log_r;
      }
    }
  }
}

// The sums that kd and ks come from.
PATINA_INLINE void linearSums(const Samples& s, Lane (&sums)[5]) {
  for (const Light& light : s.light) {
    PATINA_LANES
    for (int k = 0; k < kLanes; ++k) {
      const float a = light.a.v[k], g = light.g.v[k], held = light.m.v[k] * g;
      const float b = g - held, rest = light.y.v[k] - held;
      const float wa = light.weight.v[k] * a, wb = light.weight.v[k] * b;
      sums[0].v[k] += wa * a;
      sums[1].v[k] += wa * b;
      sums[2].v[k] += wb * b;
      sums[3].v[k] += wa * rest;
      sums[4].v[k] += wb * rest;
    }
  }
}

PATINA_INLINE void costAlone(const Samples& s, const Estimate& at, Lane& cost) {
  for (const Light& light : s.light) {
    PATINA_LANES
    for (int k = 0; k < kLanes; ++k) {
      const float strength = at.ks.v[k] * (1.0f - light.m.v[k]) + light.m.v[k];
      const float off = light.y.v[k] - at.kd.v[k] * light.a.v[k] - strength * light.g.v[k];
      cost.v[k] += light.weight.v[k] * off * off;
    }
  }
}

// What a light adds to the equations.
struct Slopes {
  float off, w_off, a, b, s1, s2, su, w1, w2, wu;
};
PATINA_INLINE Slopes slopesOf(const Light& light, const Estimate& at, int k) {
  const float m = light.m.v[k], a = light.a.v[k], g = light.g.v[k], w = light.weight.v[k];
  const float kd = at.kd.v[k], left = 1.0f - m, strength = at.ks.v[k] * left + m;
  const float off = light.y.v[k] - kd * a - strength * g;
  const float s1 = kd * light.a_1.v[k] + strength * light.g_1.v[k],
              s2 = kd * light.a_2.v[k] + strength * light.g_2.v[k], su = strength * light.g_u.v[k];
  return {off, w * off, a, left * g, s1, s2, su, w * s1, w * s2, w * su};
}
PATINA_INLINE void addSlopes(const Light& first, const Light& second, const Estimate& at,
                             Equations& q) {
  PATINA_LANES
  for (int k = 0; k < kLanes; ++k) {
    const Slopes p = slopesOf(first, at, k), n = slopesOf(second, at, k);
    q.cost.v[k] += p.w_off * p.off + n.w_off * n.off;
    q.h11.v[k] += p.w1 * p.s1 + n.w1 * n.s1;
    q.h12.v[k] += p.w1 * p.s2 + n.w1 * n.s2;
    q.h1u.v[k] += p.w1 * p.su + n.w1 * n.su;
    q.h22.v[k] += p.w2 * p.s2 + n.w2 * n.s2;
    q.h2u.v[k] += p.w2 * p.su + n.w2 * n.su;
    q.huu.v[k] += p.wu * p.su + n.wu * n.su;
    q.b1.v[k] += p.w1 * p.off + n.w1 * n.off;
    q.b2.v[k] += p.w2 * p.off + n.w2 * n.off;
    q.bu.v[k] += p.wu * p.off + n.wu * n.off;
    q.a1.v[k] += p.w1 * p.a + n.w1 * n.a;
    q.a2.v[k] += p.w2 * p.a + n.w2 * n.a;
    q.au.v[k] += p.wu * p.a + n.wu * n.a;
    q.g1.v[k] += p.w1 * p.b + n.w1 * n.b;
    q.g2.v[k] += p.w2 * p.b + n.w2 * n.b;
    q.gu.v[k] += p.wu * p.b + n.wu * n.b;
  }
}
// Two lights at a time: half the additions go through memory.
PATINA_INLINE void slopes(const Samples& s, const Estimate& at, Equations& q) {
  static const Light none{};
  for (std::size_t i = 0; i < s.count; i += 2)
    addSlopes(s.light[i], i + 1 < s.count ? s.light[i + 1] : none, at, q);
}

// Takes out of the nonlinear equations what kd and ks can do themselves: the Schur complement.
PATINA_INLINE void projectLinear(const Estimate& at, Equations& q) {
  Lane diffuse, gloss;  // 1: that part is there
  PATINA_LANES
  for (int k = 0; k < kLanes; ++k) {
    diffuse.v[k] = at.kd.v[k] != 0 ? 1.0f : 0.0f;
    gloss.v[k] = at.ks.v[k] != 0 ? 1.0f : 0.0f;
  }
  PATINA_LANES
  for (int k = 0; k < kLanes; ++k) {
    const float has_d = diffuse.v[k], has_s = gloss.v[k];
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

template <bool kSlopes>
PATINA_INLINE void lobesOf(Model model, Samples& s, const Estimate& at, const Tangents& t) {
  if (model == Model::kGgx)
    lobes<Ggx, kSlopes>(s, at, t);
  else if (model == Model::kTorranceSparrow)
    lobes<TorranceSparrow, kSlopes>(s, at, t);
  else
    lobes<Ward, kSlopes>(s, at, t);
}

// kd and ks of least squares, of whatever sign, where the two can be told apart.
PATINA_INLINE void freeStrengths(const Lane (&sums)[5], const Prior& prior, Estimate& at,
                                 const Equations& q) {
  PATINA_LANES
  for (int k = 0; k < kLanes; ++k) {
    const float aa = q.aa.v[k], ab = q.ab.v[k], bb = q.bb.v[k], det = aa * bb - ab * ab;
    const float ay = sums[3].v[k], by = sums[4].v[k] + prior.ks_weight.v[k] * prior.ks.v[k];
    const bool regular = det > 1e-6f * aa * bb;
    const float divisor = regular ? det : 1.0f;
    const float kd = (bb * ay - ab * by) / divisor, ks = (aa * by - ab * ay) / divisor;
    at.kd.v[k] = regular ? kd : at.kd.v[k];
    at.ks.v[k] = regular ? ks : at.ks.v[k];
  }
}

template <bool kSlopes>
PATINA_INLINE void equationsOf(const Samples& s, Estimate& at, const Prior& prior, Equations& q) {
  Lane sums[5];
  linearSums(s, sums);
  PATINA_LANES
  for (int k = 0; k < kLanes; ++k) {
    q.aa.v[k] = sums[0].v[k];
    q.ab.v[k] = sums[1].v[k];
    q.bb.v[k] = sums[2].v[k] + prior.ks_weight.v[k];
    const float by = sums[4].v[k] + prior.ks_weight.v[k] * prior.ks.v[k];
    solveLinear(q.aa.v[k], q.ab.v[k], q.bb.v[k], sums[3].v[k], by, at.kd.v[k], at.ks.v[k]);
  }
  if (prior.signed_strengths) freeStrengths(sums, prior, at, q);
  if (kSlopes) {
    const Lane aa = q.aa, ab = q.ab, bb = q.bb;
    q = Equations{};
    q.aa = aa, q.ab = ab, q.bb = bb;
    slopes(s, at, q);
    projectLinear(at, q);
  } else {
    q.cost = Lane{};
    costAlone(s, at, q.cost);
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

// NOLINTBEGIN(bugprone-macro-parentheses): an attribute cannot stand in any.
#define PATINA_PATH(name, attribute)                                                           \
  attribute void name##Lobes(Model model, Samples& s, const Estimate& at, const Tangents& t) { \
    lobesOf<true>(model, s, at, t);                                                            \
  }                                                                                            \
  attribute void name##Equations(const Samples& s, Estimate& at, const Prior& prior,           \
                                 Equations& q) {                                               \
    equationsOf<true>(s, at, prior, q);                                                        \
  }                                                                                            \
  attribute void name##Cost(Model model, Samples& s, Estimate& at, const Prior& prior,         \
                            Equations& q) {                                                    \
    lobesOf<false>(model, s, at, {});                                                          \
    equationsOf<false>(s, at, prior, q);                                                       \
  }
// NOLINTEND(bugprone-macro-parentheses)
PATINA_PATH(plain, )
#ifdef __x86_64__
PATINA_PATH(avx2, __attribute__((target("avx2"))))
PATINA_PATH(avx512, __attribute__((target("avx512f,avx512dq,avx512bw,avx512vl"))))
#endif

struct Kernels {
  void (*lobes)(Model, Samples&, const Estimate&, const Tangents&);
  void (*equations)(const Samples&, Estimate&, const Prior&, Equations&);
  void (*cost)(Model, Samples&, Estimate&, const Prior&, Equations&);
};
Kernels kernelsHere() {
#ifdef __x86_64__
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl"))
    return {avx512Lobes, avx512Equations, avx512Cost};
  if (__builtin_cpu_supports("avx2")) return {avx2Lobes, avx2Equations, avx2Cost};
#endif
  return {plainLobes, plainEquations, plainCost};
}
const Kernels& kernels() {
  static const Kernels here = kernelsHere();
  return here;
}

}  // namespace

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

void findLobes(Model model, Samples& samples, const Estimate& at) {
  kernels().lobes(model, samples, at, tangentsOf(at));
}
void findEquations(const Samples& samples, Estimate& at, const Prior& prior, Equations& out) {
  kernels().equations(samples, at, prior, out);
}
void evaluate(Model model, Samples& samples, Estimate& at, const Prior& prior, Equations& out) {
  findLobes(model, samples, at);
  findEquations(samples, at, prior, out);
}
void evaluateCost(Model model, Samples& samples, Estimate& at, const Prior& prior, Equations& out) {
  kernels().cost(model, samples, at, prior, out);
}

}  // namespace patina::brdf::lanes
