// SPDX-License-Identifier: GPL-3.0-or-later
// How a surface sends light on: Lambert under a GGX coat (processing/brdf/ggx.h), with directions
// drawn in proportion to it. Directions have length 1 and leave the surface; z is the normal.
#pragma once

#include <array>

#include "processing/mesh/triangle_mesh.h"

namespace patina::render {

struct Reflection {
  mesh::V3f colour;     // diffuse
  float specular = 0;   // at normal incidence; 0: no coat
  float roughness = 1;  // alpha

  // f(l, v) * l.z [1/sr]; 0 when one of them is below. What the coat reflects on the way in or out
  // the diffuse part does not get (Schlick's weights), so that no light is made.
  mesh::V3f towards(const mesh::V3f& l, const mesh::V3f& v) const;
  // Density of draw(), per sr.
  float density(const mesh::V3f& l, const mesh::V3f& v) const;
  // A direction for the light to come from; it may point below.
  mesh::V3f draw(const mesh::V3f& v, std::array<float, 2> which, std::array<float, 2> where) const;

 private:
  float coatShare(float v_z) const;
};

}  // namespace patina::render
