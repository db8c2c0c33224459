// SPDX-License-Identifier: GPL-3.0-or-later
// A spatio-temporal BRDF in memory: every parameter of every texel is a polynomial of time.
#pragma once

#include <string>
#include <vector>

#include "processing/brdf/manifest.h"
#include "processing/image/image.h"
#include "processing/stbrdf/basis.h"

namespace patina::stbrdf {

// One map over time: "Diffuse", "Specular", "Roughness", or extra: "Normal" "Height" "Occlusion".
struct TimeMap {
  std::string name;
  std::vector<Image<float>> coefficients;  // [degree + 1], each [h][w][1 or 3]
  float low = 0, high = 1;                 // what values may be; evaluation clamps to it on demand
};

struct StbrdfSet {
  int degree = 3;
  Basis basis = Basis::kMonomial;
  std::string model = "ggx", roughness = "alpha";
  std::vector<TimeMap> maps;  // "Diffuse" is among them
  brdf::Manifest facts;       // what else manifest.json says

  SizePx size() const { return maps.empty() ? SizePx{} : maps[0].coefficients[0].size(); }
  const TimeMap* find(const std::string& name) const {
    for (const TimeMap& map : maps)
      if (map.name == name) return &map;
    return nullptr;
  }
};

enum class Clamp { kNone, kToRange };

// The map at time t in [0,1]: one pass over its coefficients.
Image<float> evaluate(const TimeMap& map, Basis basis, double t, Clamp clamp);
// Every texel at a time of its own: `times` [h][w][1] in [0,1], of the map's size.
Image<float> evaluate(const TimeMap& map, Basis basis, ImageView<const float> times, Clamp clamp);

// The same polynomials in the other basis; in float64 inside.
void convert(StbrdfSet& set, Basis basis);

}  // namespace patina::stbrdf
