// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/brdf/lane_fit.h"

#include <cmath>

namespace patina::brdf::lanes {
namespace {

constexpr int kFewestBrighter = 2;  // one is a glint
constexpr float kBrighterSigmas = 4, kBrighterShare = 0.05f;
constexpr float kDarkest = 0.015f;  // reflectance: water alone has 0.02

}  // namespace

LaneFit fitOf(const Samples& samples, const Estimate& at, float lamp_noise, int k) {
  LaneFit fit;
  for (const Light& light : samples.light) {
    if (!(light.weight[k] > 0)) continue;
    ++fit.used;
    const double y = light.y[k], off = y - predicted(light, at, k), lamp = lamp_noise * y;
    fit.square += off * off;
    fit.chi2 += off * off * light.weight[k];
    fit.lamps += lamp * lamp * light.noise[k];
  }
  fit.lamps /= std::max(fit.used, 1);
  return fit;
}

bool isSpoilt(const Samples& samples, const Estimate& at, int k) {
  if (at.kd[k] + at.ks[k] < kDarkest) return true;
  int brighter = 0;
  for (const Light& light : samples.light) {
    if (!(light.noise[k] > 0)) continue;
    const float there = predicted(light, at, k);
    brighter +=
        light.y[k] - there > kBrighterSigmas / std::sqrt(light.noise[k]) + kBrighterShare * there;
  }
  return brighter >= kFewestBrighter;
}

}  // namespace patina::brdf::lanes
