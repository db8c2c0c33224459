// SPDX-License-Identifier: GPL-3.0-or-later
// Shadows that a specimen's relief casts on itself, with the penumbra of a lamp of some size.
//
// Heights stand on a square grid in the rig's frame, somewhat larger than what pictures see; what
// lies beyond casts no shadow. From texel p the ray to the lamp L rises by
// (L_z - h(p)) / |L_xy - p_xy| a mm. With k = 1, 2, ... whole steps along the greater axis of the
// way to the lamp (64 of one texel, then each a 32nd of the way so far: what is
// thinner may be missed), s_k mm long, heights
// between texels linear along the lesser axis, the clearance of the ray is c_k, and
//
//   visibility = min_k saturate(1/2 + c_k / (2 s_k rho)),  rho = radius |L - p| / |L_xy - p_xy|^2
//
// 1 fully lit, 1/2 where the lamp's middle is just hidden, 0 in the umbra.
#pragma once

#include <vector>

#include "devices/twin/lamp_field.h"
#include "devices/twin/specimen.h"

namespace patina::devices::twin {

// Steps of a ray, in texels of the greater axis. Pure.
constexpr int nextShadowStep(int k) { return k + (k < 64 ? 1 : k / 32); }

class ReliefShadow {
 public:
  // Square texels of texel_mm covering [x0,x1] x [y0,y1].
  ReliefShadow(float x0_mm, float y0_mm, float x1_mm, float y1_mm, float texel_mm);

  // Square texels already.
  explicit ReliefShadow(SampleGrid square) : grid_(std::move(square)) {}

  const SampleGrid& grid() const { return grid_; }
  // [h][w] of grid(), mm.
  void setHeights(std::vector<float> heights);
  // [h][w] of grid(). Rows in parallel; O(texels x steps until the ray is above all).
  std::vector<float> visibility(const LampPlace& lamp) const;

 private:
  float at(int x, int y, const LampPlace& lamp) const;

  SampleGrid grid_;
  std::vector<float> heights_;
  float highest_ = 0;
  Image<float> near_;  // highest in a block of the grid and in those around it
};

// Reads values on a square grid at the places of another, bilinearly. Immutable.
class GridReader {
 public:
  GridReader(const SampleGrid& from, const SampleGrid& to);
  void readRow(const std::vector<float>& values, int y, float* out) const;

 private:
  struct Place {
    int index;
    float x, y;  // share of the way to the next column and row
  };
  int from_width_, to_width_;
  std::vector<Place> places_;
};

}  // namespace patina::devices::twin
