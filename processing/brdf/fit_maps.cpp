// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/brdf/fit_maps.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "processing/brdf/alike.h"
#include "processing/brdf/crowd.h"

namespace patina::brdf {
namespace {

using lanes::kCurve;
using lanes::kLanes;
using lanes::Lane;

// Of specular reflectance among neighbours: 0.003 and 6 % of it.
constexpr double kLeastSpecularSpread = 0.003, kLeastSpecularShare = 0.06;
constexpr double kBeforeSpecularSpread2 = 0.01 * 0.01;

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
    const double least = kLeastSpecularSpread + kLeastSpecularShare * std::max(grey / weight, 0.0);
    return static_cast<float>(1 / (crowd / weight + between + least * least));
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
      misfit(s.width, s.height, 1),
      lamps(s.width, s.height, 1),
      own_specular(s.width, s.height, channels),
      look(s.width, s.height, channels),
      curve(s.width, s.height, kCurve),
      curve_moment(s.width, s.height, kCurve),
      curve_information(s.width, s.height, kCurve) {}

PriorMaps::PriorMaps(SizePx s, int channels)
    : log_r(s.width, s.height, 1),
      log_r_weight(s.width, s.height, 1),
      expected_specular(s.width, s.height, 1, kDielectric),
      expected_weight(s.width, s.height, 1),
      specular(s.width, s.height, channels),
      specular_weight(s.width, s.height, 1) {}

void poolSpecular(const FitState& state, const std::vector<FitBefore>& before,
                  const MultiLightOptions& options, PriorMaps& prior, Progress& progress) {
  const AlikeTexels alike(state.look, options);
  const auto hold = [&](SpecularPool& sum, Crowd& together, int x, int y) {
    const float crowd = together.texels > 0 ? together.crowding() : 1;
    for (const FitBefore& other : before)
      if (other.specular.channels == state.specular.channels())
        sum.add(other.specular.texel(x, y), other.confidence.at(x, y) / kBeforeSpecularSpread2, 1);
    if (!(sum.weight > 0)) return;
    for (int c = 0; c < state.specular.channels(); ++c)
      prior.specular.at(x, y, c) =
          static_cast<float>(sum.mean[static_cast<std::size_t>(c)] / sum.weight);
    prior.specular_weight.at(x, y) = sum.certainty(crowd);
  };
  progress.begin("gloss of neighbours", stripsOf(state.size));
  forEachInStrips(state.size, progress, [&](int x0, int y) {
    std::array<SpecularPool, kLanes> sums{};
    std::array<Crowd, kLanes> crowds;
    alike.forEach(x0, y, [&](int dx, int dy, const Lane& weights) {
      for (int k = 0; k < kLanes; ++k) {
        if (!(weights[k] > 0)) continue;
        const int x = x0 + k + dx;
        const float information = state.specular_weight.at(x, y + dy);
        if (!(information > 0)) continue;
        const auto i = static_cast<std::size_t>(k);
        sums[i].add(state.own_specular.view().texel(x, y + dy), information, weights[k]);
        crowds[i].add(state, x, y + dy, weights[k]);
      }
    });
    for (int k = 0; k < kLanes && x0 + k < state.size.width; ++k)
      hold(sums[static_cast<std::size_t>(k)], crowds[static_cast<std::size_t>(k)], x0 + k, y);
  });
}

}  // namespace patina::brdf
