// SPDX-License-Identifier: GPL-3.0-or-later
// Which place of a mesh each texel of its texture lies on.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "processing/image/image.h"
#include "processing/mesh/triangle_mesh.h"

namespace patina::mesh {

struct UvTexel {
  std::uint32_t triangle = 0;
  float b1 = 0, b2 = 0;  // weights of the triangle's second and third corner
};

class UvBake {
 public:
  // `mesh` outlives it. A texel belongs to the triangle its centre lies in. Throws
  // ProcessingError(kBadData), saying which: the mesh has no uv, some lie outside of [0,1], none
  // covers a texel's centre, more than 1 of 1000 covered texels is covered twice. O(texels +
  // triangles).
  UvBake(const TriangleMesh& mesh, SizePx size);

  // [h][w][1] of `of`, called once a covered texel, in parallel. A texel outside of every chart
  // takes the value of the covered one nearest to it, so that filtering across a chart's border
  // finds nothing foreign.
  Image<float> map(const std::function<float(const UvTexel&)>& of) const;
  // Values of vertices, interpolated.
  Image<float> map(const std::vector<float>& of_vertex) const;

  double covered_share() const;  // of the texels

 private:
  void rasterise(std::uint32_t triangle);
  void spread();

  const TriangleMesh& mesh_;
  SizePx size_;
  std::vector<UvTexel> texels_;        // [h][w]
  std::vector<std::int32_t> nearest_;  // [h][w] index of the covered texel to take; -1: none yet
  std::int64_t covered_ = 0, twice_ = 0;
  std::uint32_t first_[2] = {0, 0};  // of two triangles that overlap
};

}  // namespace patina::mesh
