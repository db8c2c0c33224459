// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/cleft_slate.h"

#include <algorithm>

#include "processing/image/random.h"

namespace patina::devices::twin {

namespace {

constexpr float kLayers = 4.2f;  // a unit of noise
constexpr float kGrain = 1.5f;   // forms are so much longer along x
constexpr float kEdge = 0.1f;    // of a layer, how wide a ledge is to the wind

}  // namespace

CleftSlate::CleftSlate(std::uint64_t seed)
    : layers_{hashSeed(seed, 1), 44, 5, 0.46f},
      form_{hashSeed(seed, 1), 44, 2, 0.46f},
      chance_{hashSeed(seed, 2), 16, 4, 0.55f},
      gust_{hashSeed(seed, 3), 30, 2, 0.4f} {}

float CleftSlate::heightAt(const FractalNoise& noise, float x_mm, float y_mm) {
  return kLayers * noise.at(x_mm / kGrain, y_mm, kAsIs);
}

float CleftSlate::exposureAt(float x_mm, float y_mm) const {
  const float layers = layersAt(x_mm, y_mm), here = cleft(layers, kEdge);
  float shelter = 0;
  for (const float distance_mm : {1.2f, 2.6f, 4.5f, 7.0f, 10.0f}) {
    const float upwind =
        cleft(layersAt(x_mm - kWindX * distance_mm, y_mm - kWindY * distance_mm), kEdge);
    shelter = std::max(shelter, (upwind - here) / (1 + 0.22f * distance_mm));
  }
  return std::clamp(0.25f + 0.30f * layers - 1.0f * shelter + 0.9f * chance_.at(x_mm, y_mm, kAsIs),
                    -1.0f, 1.0f);
}

float CleftSlate::driftAt(float x_mm, float y_mm) const {
  const float here = formAt(x_mm, y_mm);
  float shelter = 0;
  for (const float distance_mm : {3.0f, 6.0f, 10.0f})
    shelter += formAt(x_mm - kWindX * distance_mm, y_mm - kWindY * distance_mm) - here;
  return std::clamp(0.12f * here - 0.26f * shelter + 0.5f * gust_.at(x_mm, y_mm, kAsIs), -1.0f,
                    1.0f);
}

}  // namespace patina::devices::twin
