// SPDX-License-Identifier: GPL-3.0-or-later
// What a texture lies on, as maps over its texels: a relief, flat if need be, or a mesh through its
// texture coordinates, with other meshes about it that throw shadows. One frame for all: x right, y
// up, z to the viewer, mm, the middle of a relief at the origin.
#pragma once

#include <memory>
#include <vector>

#include "processing/image/image.h"
#include "processing/mesh/lamp.h"
#include "processing/mesh/triangle_mesh.h"

namespace patina::workflow {

using SharedMesh = std::shared_ptr<const mesh::TriangleMesh>;

class ControlSurface {
 public:
  virtual ~ControlSurface() = default;
  // Each [h][w][1] of the texture's size.
  virtual Image<float> height() const = 0;     // mm; of a mesh: z above its lowest place
  virtual Image<float> slope() const = 0;      // degrees between the normal and z
  virtual Image<float> curvature() const = 0;  // mean, 1/mm
  virtual Image<float> sky() const = 0;        // share that is open, 0 to 1
  virtual Image<float> light(const mesh::Lamp& lamp) const = 0;  // equation 9, as it is
  virtual Image<float> shadow(const mesh::Lamp& lamp, const mesh::ShadowOptions& how) const = 0;
};

// Throw ProcessingError: see mesh::HeightMap, mesh::UvBake.
std::unique_ptr<ControlSurface> surfaceOfRelief(Image<float> height_mm, double mm_per_texel,
                                                const std::vector<SharedMesh>& casters);
std::unique_ptr<ControlSurface> surfaceOfMesh(const SharedMesh& mesh, SizePx size,
                                              const std::vector<SharedMesh>& casters);

}  // namespace patina::workflow
