// SPDX-License-Identifier: GPL-3.0-or-later
// Maps of a known surface and pictures of it under many lights, with a sensor's noise.
#pragma once

#include <cmath>
#include <vector>

#include "processing/brdf/multi_light_fit.h"
#include "processing/brdf/relight.h"
#include "processing/image/random.h"

namespace patina::brdf {

// `count` directions spread evenly within `reach_deg` of straight above.
inline std::vector<SurfaceLight> dome(int count, double reach_deg = 70) {
  std::vector<SurfaceLight> lights;
  for (int i = 0; i < count; ++i) {
    const double z = 1 - (1 - std::cos(reach_deg * M_PI / 180)) * (i + 0.5) / count;
    const double phi = i * 2.399963229728653, s = std::sqrt(1 - z * z);
    SurfaceLight light;
    light.direction = normalized({static_cast<float>(s * std::cos(phi)),
                                  static_cast<float>(s * std::sin(phi)), static_cast<float>(z)});
    lights.push_back(light);
  }
  return lights;
}

struct PlainGloss {
  float specular, roughness;
};

// A gently rolling surface, its colour in broad waves, of one gloss.
inline BrdfMaps rollingMaps(int width, int height, PlainGloss gloss) {
  BrdfMaps maps;
  maps.diffuse = Image<float>(width, height, 3);
  maps.specular = Image<float>(width, height, 3, gloss.specular);
  maps.roughness = Image<float>(width, height, 1, gloss.roughness);
  maps.normal = Image<float>(width, height, 3);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const auto fx = static_cast<float>(x), fy = static_cast<float>(y);
      const Vec3 n = normalized({0.25f * std::sin(0.4f * fx), 0.2f * std::cos(0.3f * fy), 1});
      const auto to = maps.normal.view().texel(x, y);
      to[0] = n.x, to[1] = n.y, to[2] = n.z;
      for (int c = 0; c < 3; ++c)
        maps.diffuse.at(x, y, c) = 0.3f + 0.1f * static_cast<float>(c) * std::sin(0.1f * fx);
    }
  return maps;
}

struct LitSurface {
  std::vector<Image<float>> pictures;
  std::vector<FitSample> samples;  // of the pictures: neither may move
};

// `noise`: RMS of a level of 1, with its square root's law.
inline LitSurface lit(const BrdfMaps& maps, Model model, const std::vector<SurfaceLight>& lights,
                      double noise = 0.004) {
  LitSurface out;
  BrdfSetInfo info;
  info.model = model;
  for (std::size_t i = 0; i < lights.size(); ++i) {
    out.pictures.push_back(relight(maps, info, lights[i]));
    auto& texels = out.pictures.back().texels();
    for (std::size_t j = 0; j < texels.size(); ++j)
      texels[j] += static_cast<float>(noise * std::sqrt(std::max(texels[j], 0.0f) + 1e-4f) *
                                      gaussian(hashSeed(11, i, j)));
  }
  for (std::size_t i = 0; i < lights.size(); ++i) {
    FitSample sample;
    sample.picture = out.pictures[i].view();
    sample.light = lights[i];
    out.samples.push_back(sample);
  }
  return out;
}

inline MultiLightOptions calmOptions(Model model = Model::kGgx) {
  MultiLightOptions options;
  options.model = model;
  options.noise = {0.0005f, 1.6e-5f, 0.0005f};
  options.saturated = 50;
  return options;
}

inline double rms(const Image<float>& a, const Image<float>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.texels().size(); ++i) {
    const double off = double{a.texels()[i]} - b.texels()[i];
    sum += off * off;
  }
  return std::sqrt(sum / static_cast<double>(a.texels().size()));
}

inline double medianAngleDeg(const Image<float>& a, const Image<float>& b) {
  std::vector<double> angles;
  for (int y = 0; y < a.height(); ++y)
    for (int x = 0; x < a.width(); ++x) {
      const auto p = a.view().texel(x, y), q = b.view().texel(x, y);
      const double cosine = double{p[0]} * q[0] + double{p[1]} * q[1] + double{p[2]} * q[2];
      angles.push_back(std::acos(std::clamp(cosine, -1.0, 1.0)) * 180 / M_PI);
    }
  std::nth_element(angles.begin(), angles.begin() + static_cast<long>(angles.size() / 2),
                   angles.end());
  return angles[angles.size() / 2];
}

}  // namespace patina::brdf
