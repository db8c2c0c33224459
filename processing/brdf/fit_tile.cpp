// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/brdf/fit_tile.h"

#include "processing/brdf/ggx.h"

namespace patina::brdf {

using lanes::kLanes;

FitTile::FitTile(const std::vector<FitSample>& samples, const MultiLightOptions& options)
    : from_(samples),
      options_(options),
      size_(samples[0].picture.size()),
      channels_(samples[0].picture.channels),
      lanes_(samples.size()),
      colours_(samples.size() * static_cast<std::size_t>(channels_)) {
  for (std::size_t i = 0; i < samples.size(); ++i) lanes_.light[i].view = samples[i].view;
}

void FitTile::load(int x0, int y) {
  lanes_.shadowed = {};
  for (std::size_t i = 0; i < from_.size(); ++i) {
    const FitSample& sample = from_[i];
    LightRay ray = rayAt(sample.light, sample.view, 0, 0);
    for (int k = 0; k < kLanes; ++k) {
      const int x = column(x0, k);
      if (sample.light.near) {
        const PlaceMm place = placeOf(x, y, size_, options_.mm_per_texel);
        ray = rayAt(sample.light, sample.view, place.x, place.y);
      }
      put(i, k, ray);
      putLevel(i, k, sample.picture.texel(x, y));
    }
  }
}

void FitTile::put(std::size_t i, int k, const LightRay& ray) {
  lanes::Light& to = lanes_.light[i];
  to.lx[k] = ray.l.x;
  to.ly[k] = ray.l.y;
  to.lz[k] = ray.l.z;
  to.hx[k] = ray.h.x;
  to.hy[k] = ray.h.y;
  to.hz[k] = ray.h.z;
  to.v_h[k] = ray.v_h;
  to.half[k] = 0.5f / ray.v_h;
  to.m[k] = options_.model == Model::kGgx ? schlickWeight(ray.v_h) : 0.0f;
  to.e[k] = ray.irradiance;
}

void FitTile::putLevel(std::size_t i, int k, std::span<const float> texel) {
  lanes::Light& to = lanes_.light[i];
  float sum = 0;
  bool usable = to.e[k] > 0;
  for (const float v : texel) {
    usable = usable && v < options_.saturated && v > -1.0f;  // NaN fails both
    sum += v;
  }
  const float level = usable ? sum / static_cast<float>(texel.size()) : 0;
  const FitNoise& noise = options_.noise;
  const float above = std::max(level, 0.0f);
  const float variance =
      noise.floor * noise.floor + noise.shot * above + noise.gain * noise.gain * above * above;
  for (std::size_t c = 0; c < texel.size(); ++c)
    colours_[i * texel.size() + c][k] = usable ? texel[c] : 0;
  to.y[k] = level;
  to.noise[k] = usable ? 1 / variance : 0;
}

FitTile::Products FitTile::productsOf(int channel) const {
  Products sum;
  for (std::size_t i = 0; i < lanes_.count; ++i) {
    const lanes::Light& light = lanes_.light[i];
    const lanes::Lane& level = colour(i, channel);
    for (int k = 0; k < kLanes; ++k) {
      const float w = light.weight.v[k], m = light.m.v[k], g = light.g.v[k];
      const float rest = level.v[k] - m * g;
      sum.diffuse.v[k] += w * light.a.v[k] * rest;
      sum.gloss.v[k] += w * (1 - m) * g * rest;
    }
  }
  return sum;
}

}  // namespace patina::brdf
