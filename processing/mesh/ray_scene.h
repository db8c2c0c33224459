// SPDX-License-Identifier: GPL-3.0-or-later
// Which surface a ray meets, by Embree.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "processing/mesh/triangle_mesh.h"

namespace patina::mesh {

struct RayHit {
  float distance_mm = 0;
  std::uint32_t mesh = 0, triangle = 0;
  float b1 = 0, b2 = 0;  // weights of the triangle's second and third corner
};

// Immutable; any number of threads may ask. Built the same way on any number of threads.
class RayScene {
 public:
  // Copies what it needs. Throws ProcessingError(kUnavailable) when Embree cannot start.
  explicit RayScene(const std::vector<const TriangleMesh*>& meshes);
  ~RayScene();
  RayScene(RayScene&&) noexcept;
  RayScene& operator=(RayScene&&) noexcept;

  // `direction` of length 1; from both sides of a triangle.
  std::optional<RayHit> nearest(const V3f& from, const V3f& direction) const;
  bool isBlocked(const V3f& from, const V3f& direction,
                 float within_mm = std::numeric_limits<float>::infinity()) const;
  // How far a ray starts off the surface it leaves, so that it does not meet it again: of the size
  // of rounding at the scene's reach.
  float clearance_mm() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace patina::mesh
