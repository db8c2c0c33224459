// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/stbrdf/material.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace patina::stbrdf {
namespace {

// Of a single-channel map that is stored as three equal ones.
Image<float> firstChannel(const Image<float>& map) {
  Image<float> out(map.width(), map.height(), 1);
  for (int y = 0; y < map.height(); ++y)
    for (int x = 0; x < map.width(); ++x) out.at(x, y) = map.at(x, y);
  return out;
}

// Unit vectors; maps in [0,1] hold (n + 1) / 2.
void normalise(Image<float>& normals, bool encoded) {
  for (int y = 0; y < normals.height(); ++y)
    for (int x = 0; x < normals.width(); ++x) {
      const auto n = normals.view().texel(x, y);
      if (encoded)
        for (float& v : n) v = 2 * v - 1;
      const float length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
      if (length > 1e-6f)
        for (float& v : n) v /= length;
      else
        n[0] = n[1] = 0, n[2] = 1;
    }
}

void checkLocal(const Image<float>& map, const char* name, SizePx size, float least) {
  if (map.empty()) return;
  if (map.size() != size || map.channels() != 1)
    throw ProcessingError(Exit::kUsage,
                          std::string("the map of ") + name + " is " + std::to_string(map.width()) +
                              "x" + std::to_string(map.height()) + "; the set is " +
                              std::to_string(size.width) + "x" + std::to_string(size.height));
  for (const float v : map.texels())
    if (!std::isfinite(v) || v < least)
      throw ProcessingError(Exit::kBadData,
                            std::string("the map of ") + name + " holds " + std::to_string(v));
}

}  // namespace

Image<float> timesOf(const LocalTime& local, SizePx size) {
  PATINA_CHECK(local.time >= 0 && local.time <= 1);
  checkLocal(local.rate, "rates", size, 0);
  checkLocal(local.start, "starts", size, -1e30f);
  Image<float> times(size.width, size.height, 1);
  for (std::size_t i = 0; i < times.texels().size(); ++i) {
    const double rate = local.rate.empty() ? 1 : local.rate.texels()[i],
                 start = local.start.empty() ? 0 : local.start.texels()[i];
    times.texels()[i] = static_cast<float>(std::clamp(start + rate * local.time, 0.0, 1.0));
  }
  return times;
}

Material materialAt(const StbrdfSet& set, const LocalTime& local) {
  Material material;
  material.info.model = brdf::modelOf(set.model);
  material.info.roughness = brdf::roughnessKindOf(set.roughness);
  material.info.size = set.size();
  if (const auto mm = set.facts.number("mm_per_texel"))
    material.info.facts.number("mm_per_texel", *mm);
  material.info.facts.number("time", local.time);
  const Image<float> times = local.isEverywhere() ? Image<float>() : timesOf(local, set.size());
  brdf::BrdfMaps& maps = material.maps;
  for (const TimeMap& map : set.maps) {
    Image<float> at = times.empty() ? evaluate(map, set.basis, local.time, Clamp::kToRange)
                                    : evaluate(map, set.basis, times.view(), Clamp::kToRange);
    if (map.name == "Diffuse") {
      maps.diffuse = std::move(at);
    } else if (map.name == "Specular") {
      maps.specular = std::move(at);
    } else if (map.name == "Roughness") {
      maps.roughness = at.channels() == 1 ? std::move(at) : firstChannel(at);
    } else if (map.name == "Normal" && at.channels() == 3) {
      normalise(at, map.low >= 0);
      maps.normal = std::move(at);
    } else {
      maps.extra[map.name] = std::move(at);
    }
  }
  return material;
}

}  // namespace patina::stbrdf
