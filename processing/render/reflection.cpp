// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/render/reflection.h"

#include <algorithm>
#include <cmath>

#include "processing/brdf/ggx.h"

namespace patina::render {

using mesh::V3f;

// By what each part sends on: of the coat that of its mirror, of the rest its colour.
float Reflection::coatShare(float v_z) const {
  if (specular <= 0) return 0;
  const float coat = brdf::schlickFresnel(specular, v_z),
              rest = (1 - coat) * std::max({colour.x, colour.y, colour.z});
  return std::clamp(coat / (coat + rest + 1e-6f), 0.1f, 1.0f);
}

V3f Reflection::towards(const V3f& l, const V3f& v) const {
  if (l.z <= 0 || v.z <= 0) return V3f(0);
  if (specular <= 0) return colour * (brdf::kInversePi * l.z);
  const V3f h = (l + v).normalized();
  const float through =
      (1 - brdf::schlickFresnel(specular, l.z)) * (1 - brdf::schlickFresnel(specular, v.z));
  const float coat = brdf::ggxDistribution(h.z, roughness) *
                     brdf::smithVisibility(l.z, v.z, roughness) *
                     brdf::schlickFresnel(specular, std::max(0.0f, v.dot(h)));
  return (colour * (through * brdf::kInversePi) + V3f(coat)) * l.z;
}

float Reflection::density(const V3f& l, const V3f& v) const {
  if (l.z <= 0 || v.z <= 0) return 0;
  const float share = coatShare(v.z), even = l.z * brdf::kInversePi;
  if (share <= 0) return even;
  const V3f h = (l + v).normalized();
  const float coat = brdf::ggxDistribution(h.z, roughness) * h.z / (4 * std::max(v.dot(h), 1e-6f));
  return share * coat + (1 - share) * even;
}

V3f Reflection::draw(const V3f& v, std::array<float, 2> which, std::array<float, 2> where) const {
  const float around = 2 * brdf::kPi * where[1];
  if (which[0] >= coatShare(v.z)) {
    const float r = std::sqrt(where[0]);
    return {r * std::cos(around), r * std::sin(around), std::sqrt(std::max(0.0f, 1 - where[0]))};
  }
  // Half vectors in proportion to D cos (Walter et al. 2007, equations 35 and 36).
  const float a2 = roughness * roughness, z = std::sqrt((1 - where[0]) / (1 + (a2 - 1) * where[0])),
              r = std::sqrt(std::max(0.0f, 1 - z * z));
  const V3f h(r * std::cos(around), r * std::sin(around), z);
  return h * (2 * v.dot(h)) - v;
}

}  // namespace patina::render
