// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/brdf/fit_maps.h"

#include <array>
#include <cmath>

#include "processing/image/parallel_rows.h"

namespace patina::brdf {
namespace {

using lanes::kCurve;
using Curve = std::array<float, kCurve>;
// What alike texels cost together, and what materials are.
struct Pool {
  Curve cost{}, specular{};
  float texels = 0;  // weights' sum
};

constexpr int kRingsOfNeighbours = 6;
// 2 ln of how much less likely what is no dielectric has a given reflectance than a dielectric has
// 0.04: one material in five, spread 25 times as wide.
constexpr float kAnyPrice = 9;
constexpr float kLikely2 = 4;  // so near are most dielectrics, squared, in units of their spread
constexpr float kLeastSpread2 = 0.06f * 0.06f;  // of ln r among neighbours
constexpr double kLeastSpecularSpread2 = 0.003 * 0.003;
constexpr double kBeforeSpecularSpread2 = 0.01 * 0.01;
constexpr float kBeforeSpread2 = 0.1f * 0.1f;  // of ln r from one time step to the next

float likeness(std::span<const float> a, std::span<const float> b, float like_colour) {
  float off2 = 0, level = 0;
  for (std::size_t c = 0; c < a.size(); ++c) {
    off2 += (a[c] - b[c]) * (a[c] - b[c]);
    level += a[c] + b[c];
  }
  const float unit = like_colour * (0.1f + level / (2 * static_cast<float>(a.size())));
  const float q = off2 / (unit * unit);
  return q > 9 ? 0.0f : std::exp(-q / 2);
}

// body(x, y, weight) for every few like-looking texels in a disc, the own one included.
template <class Body>
void forAlike(const FitState& state, int x, int y, const MultiLightOptions& options,
              const Body& body) {
  const int reach = options.neighbours ? options.neighbour_px : 0;
  int step = std::max(1, reach / kRingsOfNeighbours);
  if (options.filters) step += step & 1;  // to pixels of the same colour
  const auto own = state.look.view().texel(x, y);
  for (int dy = -reach; dy <= reach; dy += step)
    for (int dx = -reach; dx <= reach; dx += step) {
      const int nx = x + dx, ny = y + dy;
      if (dx * dx + dy * dy > reach * reach || nx < 0 || ny < 0 || nx >= state.size.width ||
          ny >= state.size.height)
        continue;
      const float w = likeness(own, state.look.view().texel(nx, ny), options.like_colour);
      if (w > 0) body(nx, ny, w);
    }
}

// By how much so many texels are fewer: errors that they have together do not average out.
float crowding(float common, float texels) { return 1 + common * std::max(texels - 1, 0.0f); }

// Squared, in units of what dielectrics spread by.
float fromDielectric2(float specular, const MultiLightOptions& options) {
  const float off = (specular - kDielectric) / options.specular_spread;
  return off * off;
}

Pool pooled(const FitState& state, int x, int y, const MultiLightOptions& options) {
  Pool sum;
  forAlike(state, x, y, options, [&](int nx, int ny, float w) {
    const auto curve = state.curve.view().texel(nx, ny),
               strength = state.curve_specular.view().texel(nx, ny);
    for (std::size_t j = 0; j < kCurve; ++j) {
      sum.cost[j] += w * curve[j];
      sum.specular[j] += w * strength[j];
    }
    sum.texels += w;
  });
  const float crowd = crowding(state.common.at(x, y), sum.texels);
  for (std::size_t j = 0; j < kCurve; ++j) {
    sum.specular[j] /= sum.texels;
    sum.cost[j] =
        sum.cost[j] / crowd + std::min(fromDielectric2(sum.specular[j], options), kAnyPrice);
  }
  sum.texels /= crowd;
  return sum;
}

struct Valley {
  float log_r = 0, weight = 0, cost = 0;  // weight: half the second derivative
};

// Lowest point of the quartic through the least entry and two neighbours on each side.
Valley valleyOf(const Curve& curve) {
  int least = 2;
  for (int j = 2; j + 2 < kCurve; ++j)
    if (curve[static_cast<std::size_t>(j)] < curve[static_cast<std::size_t>(least)]) least = j;
  const auto at = [&](int j) { return curve.data()[least + j]; };
  const float odd1 = at(1) - at(-1), odd2 = at(2) - at(-2);
  const float even1 = at(1) + at(-1) - 2 * at(0), even2 = at(2) + at(-2) - 2 * at(0);
  const float c1 = (8 * odd1 - odd2) / 12, c2 = (16 * even1 - even2) / 24,
              c3 = (odd2 - 2 * odd1) / 12, c4 = (even2 - 4 * even1) / 24;
  float off = std::clamp(-odd1 / (2 * even1 + 1e-9f), -1.0f, 1.0f);
  for (int round = 0; round < 8; ++round) {  // Newton, kept to where the quartic is one
    const float slope = c1 + off * (2 * c2 + off * (3 * c3 + off * 4 * c4));
    const float bend = 2 * c2 + off * (6 * c3 + off * 12 * c4);
    off = std::clamp(off - slope / std::max(bend, even1 / 2 + 1e-9f), -1.5f, 1.5f);
  }
  const float bend = 2 * c2 + off * (6 * c3 + off * 12 * c4);
  if (!(bend > 1e-6f)) return {};
  const float cost = at(0) + off * (c1 + off * (c2 + off * (c3 + off * c4)));
  const float h = lanes::curveLogR(1) - lanes::curveLogR(0);
  return {lanes::curveLogR(least) + off * h, bend / (2 * h * h), std::max(cost, 0.0f)};
}

float specularAt(const Pool& pool, float log_r) {
  const float at = (log_r - lanes::curveLogR(0)) / (lanes::curveLogR(1) - lanes::curveLogR(0));
  const int j = std::clamp(static_cast<int>(at), 0, kCurve - 2);
  const float share = std::clamp(at - static_cast<float>(j), 0.0f, 1.0f);
  return pool.specular.data()[j] * (1 - share) + pool.specular.data()[j + 1] * share;
}

// What the pool costs beyond one per texel is how much they differ among themselves (DerSimonian
// and Laird 1986): that far is no texel held to the others.
float certaintyOf(const Valley& valley, float texels) {
  if (!(valley.weight > 0)) return 0;
  const float between = std::max(valley.cost - std::max(texels - 1, 0.0f), 0.0f) / valley.weight;
  return 1 / (1 / valley.weight + between + kLeastSpread2);
}

// Means by information, of each channel and of their mean.
struct SpecularPool {
  std::array<double, 3> mean{};
  double grey = 0, square = 0, weight = 0, texels = 0;
  void add(std::span<const float> specular, double information, double w) {
    double sum = 0;
    for (std::size_t c = 0; c < specular.size(); ++c) {
      mean[c] += w * information * specular[c];
      sum += specular[c];
    }
    sum /= static_cast<double>(specular.size());
    grey += w * information * sum;
    square += w * information * sum * sum;
    weight += w * information;
    texels += w;
  }
  // `crowd`: of errors that texels have together.
  float certainty(double crowd) const {
    const double excess = square - grey * grey / weight - std::max(texels - 1, 0.0);
    const double between = std::max(excess, 0.0) / weight;
    return static_cast<float>(1 / (crowd / weight + between + kLeastSpecularSpread2));
  }
};

}  // namespace

FitState::FitState(SizePx s, int channels)
    : size(s),
      normal(s.width, s.height, 3),
      diffuse(s.width, s.height, channels),
      specular(s.width, s.height, channels),
      specular_weight(s.width, s.height, 1),
      grey_diffuse(s.width, s.height, 1),
      grey_specular(s.width, s.height, 1),
      log_r(s.width, s.height, 1),
      confidence(s.width, s.height, 1),
      residual(s.width, s.height, 1),
      told(s.width, s.height, 1),
      shadowed(s.width, s.height, 1),
      spread2(s.width, s.height, 1, 1.0f),
      common(s.width, s.height, 1),
      look(s.width, s.height, channels),
      curve(s.width, s.height, kCurve),
      curve_specular(s.width, s.height, kCurve) {}

PriorMaps::PriorMaps(SizePx s, int channels)
    : log_r(s.width, s.height, 1),
      log_r_weight(s.width, s.height, 1),
      dielectric_weight(s.width, s.height, 1),
      specular(s.width, s.height, channels),
      specular_weight(s.width, s.height, 1) {}

void poolRoughness(const FitState& state, const std::vector<FitBefore>& before,
                   const MultiLightOptions& options, PriorMaps& prior, Progress& progress) {
  progress.begin("roughness of neighbours", state.size.height);
  forEachRow(state.size.height, std::int64_t{state.size.width} * 1000, [&](int y) {
    for (int x = 0; x < state.size.width; ++x) {
      Pool sum = pooled(state, x, y, options);
      for (const FitBefore& other : before) {
        const float log_r = std::log(std::max(other.roughness.at(x, y), 0.02f));
        for (int j = 0; j < kCurve; ++j) {
          const float off = lanes::curveLogR(j) - log_r;
          sum.cost[static_cast<std::size_t>(j)] +=
              other.confidence.at(x, y) * off * off / kBeforeSpread2;
        }
      }
      const Valley valley = valleyOf(sum.cost);
      prior.log_r.at(x, y) = valley.log_r;
      prior.log_r_weight.at(x, y) = certaintyOf(valley, sum.texels);
      const float spread = options.specular_spread;
      if (fromDielectric2(specularAt(sum, valley.log_r), options) < kLikely2)
        prior.dielectric_weight.at(x, y) = state.spread2.at(x, y) / (spread * spread);
    }
    progress.step();
  });
}

void poolSpecular(const FitState& state, const std::vector<FitBefore>& before,
                  const MultiLightOptions& options, PriorMaps& prior, Progress& progress) {
  progress.begin("gloss of neighbours", state.size.height);
  forEachRow(state.size.height, std::int64_t{state.size.width} * 500, [&](int y) {
    for (int x = 0; x < state.size.width; ++x) {
      SpecularPool sum;
      forAlike(state, x, y, options, [&](int nx, int ny, float w) {
        const float information = state.specular_weight.at(nx, ny);
        if (information > 0) sum.add(state.specular.view().texel(nx, ny), information, w);
      });
      const float crowd = crowding(state.common.at(x, y), static_cast<float>(sum.texels));
      for (const FitBefore& other : before)
        if (other.specular.channels == state.specular.channels())
          sum.add(other.specular.texel(x, y), other.confidence.at(x, y) / kBeforeSpecularSpread2,
                  1);
      if (!(sum.weight > 0)) continue;
      for (int c = 0; c < state.specular.channels(); ++c)
        prior.specular.at(x, y, c) =
            static_cast<float>(sum.mean[static_cast<std::size_t>(c)] / sum.weight);
      prior.specular_weight.at(x, y) = sum.certainty(crowd);
    }
    progress.step();
  });
}

}  // namespace patina::brdf
