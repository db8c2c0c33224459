// SPDX-License-Identifier: GPL-3.0-or-later
// Where the fit begins: photometric stereo (Woodham 1980) on levels of the middle, per texel.
#include <algorithm>
#include <cmath>

#include "processing/brdf/fit_lanes.h"

namespace patina::brdf::lanes {
namespace {

constexpr double kLowShare = 0.25, kHighShare = 0.8;  // quantiles between which levels count
constexpr int kRounds = 4;
constexpr double kFlattest = 0.15;     // n.z of a start is not below
constexpr float kShadowShare = 0.35f;  // of what Lambert predicts: below is cast shadow
constexpr float kShadowSigma = 5;

struct Wide {
  double v[kLanes] = {};
};
// A level over its irradiance; what is not known counts 0.
struct Level {
  Lane value, known, weight;  // known: 1 or 0
};

// The matt surfaces that levels = b . l are nearest to.
struct Matt {
  Wide x, y, z;  // b
  Lane there;    // 0: the lights do not span space
};

// By weighted least squares.
Matt solveMatt(const Samples& s, const std::vector<Level>& levels) {
  Wide xx, xy, xz, yy, yz, zz, rx, ry, rz;
  for (std::size_t i = 0; i < s.count; ++i) {
    const Light& light = s.light[i];
    for (int k = 0; k < kLanes; ++k) {
      const double x = light.lx.v[k], y = light.ly.v[k], z = light.lz.v[k];
      const double weight = levels[i].weight.v[k], level = levels[i].value.v[k];
      const double wx = weight * x, wy = weight * y, wz = weight * z;
      xx.v[k] += wx * x, xy.v[k] += wx * y, xz.v[k] += wx * z;
      yy.v[k] += wy * y, yz.v[k] += wy * z, zz.v[k] += wz * z;
      rx.v[k] += wx * level, ry.v[k] += wy * level, rz.v[k] += wz * level;
    }
  }
  Matt matt;
  for (int k = 0; k < kLanes; ++k) {
    const double a = xx.v[k], b = xy.v[k], c = xz.v[k], d = yy.v[k], e = yz.v[k], f = zz.v[k];
    const double cx = d * f - e * e, cy = c * e - b * f, cz = b * e - d * c;
    const double det = a * cx + b * cy + c * cz, trace = a + d + f;
    matt.there.v[k] = det > 1e-6 * trace * trace * trace / 27 ? 1 : 0;
    const double divisor = matt.there.v[k] > 0 ? det : 1;
    const double p = rx.v[k], q = ry.v[k], r = rz.v[k];
    matt.x.v[k] = (p * cx + q * cy + r * cz) / divisor;
    matt.y.v[k] = (p * cy + q * (a * f - c * c) + r * (c * b - a * e)) / divisor;
    matt.z.v[k] = (p * cz + q * (b * c - a * e) + r * (a * d - b * b)) / divisor;
  }
  return matt;
}

// Between two quantiles.
void weighMiddle(std::vector<Level>& levels, const Lane& count, std::vector<Lane>& sorted) {
  for (std::size_t i = 0; i < levels.size(); ++i)
    for (int k = 0; k < kLanes; ++k)
      sorted[i].v[k] = levels[i].known.v[k] > 0 ? levels[i].value.v[k] : kLast;
  sortLanes(sorted);
  Lane low, high;
  for (int k = 0; k < kLanes; ++k) {
    const double last = std::max(count[k] - 1, 0.0f);
    low[k] = sorted[static_cast<std::size_t>(last * kLowShare)][k];
    high[k] = sorted[static_cast<std::size_t>(std::ceil(last * kHighShare))][k];
  }
  for (Level& level : levels)
    for (int k = 0; k < kLanes; ++k) {
      const float within = level.value.v[k] >= low.v[k] ? 1.0f : 0.0f;
      level.weight.v[k] = level.value.v[k] <= high.v[k] ? within * level.known.v[k] : 0.0f;
    }
}

// Highlights lie above, shadows below what a matt surface gives: both lose weight.
void reweighMatt(const Samples& s, const Matt& matt, const Lane& count, std::vector<Level>& levels,
                 std::vector<Lane>& sorted) {
  std::vector<Lane> off(s.count), lit(s.count);
  for (std::size_t i = 0; i < s.count; ++i) {
    const Light& light = s.light[i];
    for (int k = 0; k < kLanes; ++k) {
      const double there =
          matt.x.v[k] * light.lx.v[k] + matt.y.v[k] * light.ly.v[k] + matt.z.v[k] * light.lz.v[k];
      lit[i].v[k] = there > 0 ? levels[i].known.v[k] : 0.0f;
      off[i].v[k] = static_cast<float>(std::abs(levels[i].value.v[k] - std::max(there, 0.0)));
      sorted[i].v[k] = levels[i].known.v[k] > 0 ? off[i].v[k] : kLast;
    }
  }
  sortLanes(sorted);
  Lane per_scale2;
  for (int k = 0; k < kLanes; ++k) {
    const float median = sorted[static_cast<std::size_t>(std::max(count[k], 1.0f)) / 2][k],
                scale = std::max(2 * median, 1e-6f);
    per_scale2[k] = 1 / (scale * scale);
  }
  for (std::size_t i = 0; i < s.count; ++i)
    for (int k = 0; k < kLanes; ++k)
      levels[i].weight.v[k] = lit[i].v[k] / (1 + off[i].v[k] * off[i].v[k] * per_scale2.v[k]);
}

void takeMatt(Matt& to, const Matt& from, int k) {
  to.x.v[k] = from.x.v[k], to.y.v[k] = from.y.v[k], to.z.v[k] = from.z.v[k];
}

Matt mattOf(const Samples& s) {
  std::vector<Level> levels(s.count);
  std::vector<Lane> sorted(s.count);
  Lane count;
  for (std::size_t i = 0; i < s.count; ++i)
    for (int k = 0; k < kLanes; ++k) {
      const bool known = s.light[i].noise.v[k] > 0;
      levels[i].known.v[k] = known ? 1.0f : 0.0f;
      levels[i].value.v[k] = known ? s.light[i].y.v[k] / s.light[i].e.v[k] : 0.0f;
      count.v[k] += levels[i].known.v[k];
    }
  weighMiddle(levels, count, sorted);
  Matt matt = solveMatt(s, levels);
  bool plane = false;
  for (int k = 0; k < kLanes; ++k) {
    if (matt.there[k] > 0) continue;  // else the middle lies in one plane: all of them
    plane = true;
    for (Level& level : levels) level.weight[k] = level.known[k];
  }
  if (plane) matt = solveMatt(s, levels);
  Lane going = matt.there;
  for (int round = 0; round < kRounds; ++round) {
    reweighMatt(s, matt, count, levels, sorted);
    const Matt next = solveMatt(s, levels);
    for (int k = 0; k < kLanes; ++k) {
      going[k] *= next.there[k];
      if (going[k] > 0) takeMatt(matt, next, k);
    }
  }
  for (int k = 0; k < kLanes; ++k)
    if (count[k] < 3) matt.there[k] = 0;
  return matt;
}

struct Start {
  double nx = 0, ny = 0, nz = 1, kd = 0;
};
Start startOf(const Matt& matt, int k) {
  const double x = matt.x.v[k], y = matt.y.v[k], z = matt.z.v[k];
  const double length = std::sqrt(x * x + y * y + z * z);
  if (!(matt.there[k] > 0) || !(length > 0)) return {};
  Start start{x / length, y / length, z / length, length};
  if (start.nz >= kFlattest) return start;
  const double across = std::hypot(start.nx, start.ny), to = std::sqrt(1 - kFlattest * kFlattest);
  start.nx *= to / std::max(across, 1e-9);
  start.ny *= to / std::max(across, 1e-9);
  start.nz = across > 1e-9 ? kFlattest : 1;
  return start;
}

}  // namespace

void photometricStart(Samples& samples, Estimate& at) {
  const Matt matt = mattOf(samples);
  for (int k = 0; k < kLanes; ++k) {
    const Start start = startOf(matt, k);
    at.nx[k] = static_cast<float>(start.nx);
    at.ny[k] = static_cast<float>(start.ny);
    at.nz[k] = static_cast<float>(start.nz);
    at.kd[k] = static_cast<float>(start.kd);
    at.ks[k] = 0;
    at.u[k] = std::log(0.3f);
  }
  for (Light& light : samples.light)
    for (int k = 0; k < kLanes; ++k) {
      const float n_l =
          at.nx.v[k] * light.lx.v[k] + at.ny.v[k] * light.ly.v[k] + at.nz.v[k] * light.lz.v[k];
      const float predicted = at.kd.v[k] * light.e.v[k] * n_l, noise = light.noise.v[k],
                  level = light.y.v[k];
      const float below = (predicted - level) * std::sqrt(noise);
      const bool shadow =
          (n_l <= 0) | ((level < kShadowShare * predicted) & (below > kShadowSigma));
      light.weight.v[k] = shadow ? 0 : noise;
    }
}

}  // namespace patina::brdf::lanes
