// SPDX-License-Identifier: GPL-3.0-or-later
// The form of a slate that is cleft into thin layers, and where on it the wind lays snow. Pure.
// Lengths in mm; heights in layers. Private to the twin.
#pragma once

#include <cmath>
#include <cstdint>

#include "devices/twin/noise.h"
#include "devices/twin/ramps.h"

namespace patina::devices::twin {

// A staircase of layers: flat, then up by one within `width` of a layer around the half.
inline float cleft(float layers, float width) {
  const float below = std::floor(layers);
  return below + smooth01(saturate((layers - below - 0.5f) / width + 0.5f));
}

class CleftSlate {
 public:
  static constexpr float kWindX = 0.83f, kWindY = -0.56f;  // where the wind blows to

  explicit CleftSlate(std::uint64_t seed);
  // Height before it is cleft; of the broad form only, which deep snow follows.
  float layersAt(float x_mm, float y_mm) const { return heightAt(layers_, x_mm, y_mm); }
  float formAt(float x_mm, float y_mm) const { return heightAt(form_, x_mm, y_mm); }
  // From -1, in the lee of a ledge and in hollows, to 1 on crests: the greatest slope upwind, as
  // in Winstral, Elder and Davis 2002, the height of the place, and chance.
  float exposureAt(float x_mm, float y_mm) const;
  // The same for deep snow, which knows no single ledge: smooth; from -1, deep, to 1.
  float driftAt(float x_mm, float y_mm) const;

 private:
  static float heightAt(const FractalNoise& noise, float x_mm, float y_mm);

  FractalNoise layers_, form_, chance_, gust_;
};

}  // namespace patina::devices::twin
