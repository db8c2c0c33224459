// SPDX-License-Identifier: GPL-3.0-or-later
// A scene: meshes, what they are made of, lights, a camera. One frame for all: x right, y away, z
// up, in mm; a flat texture lies in z = 0. Light is linear RGB.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "processing/image/image.h"
#include "processing/mesh/triangle_mesh.h"

namespace patina::render {

using mesh::V3f;

struct Material {
  V3f colour{0.5f, 0.5f, 0.5f};             // diffuse reflectance in [0,1]
  std::shared_ptr<const Image<float>> map;  // in place of it, through uv: [h][w][1 or 3] linear
  float map_gain = 1;                       // what the map's numbers are multiplied by
  float repeat = 1;                         // of the map along u and v; 1: held at its edges
  float specular = 0;                       // reflectance at normal incidence of a GGX coat
  float roughness = 0.3f;                   // its alpha, 0.03 to 1
};

struct SceneMesh {
  std::string name;  // for messages
  std::shared_ptr<const mesh::TriangleMesh> mesh;
  Material material;
};

// A disc in the sky; `irradiance` on a surface that faces it.
struct Sun {
  V3f direction{0, 0, 1};  // to it
  V3f irradiance{0, 0, 0};
  float angle_deg = 0.53f;  // across
};

// A parallelogram that shines from one side, that of half_u x half_v.
struct AreaLight {
  V3f middle_mm{0, 0, 0}, half_u_mm{0, 0, 0}, half_v_mm{0, 0, 0}, radiance{0, 0, 0};
};

// Light from infinitely far. From `ground` straight below over `horizon` to `zenith` straight
// above, smoothly; or a picture of the whole sphere, columns by longitude with +y in the middle and
// +x right of it, rows from the zenith down.
struct Sky {
  V3f zenith{0, 0, 0}, horizon{0, 0, 0}, ground{0, 0, 0};
  std::shared_ptr<const Image<float>> picture;
  float picture_gain = 1;
};

struct Camera {
  V3f from_mm{0, -500, 300}, to_mm{0, 0, 0}, up{0, 0, 1};
  float field_of_view_deg = 35;  // of the picture's height
  SizePx size{640, 480};
};

struct Scene {
  Camera camera;
  std::vector<SceneMesh> meshes;
  std::vector<Sun> suns;
  std::vector<AreaLight> areas;
  Sky sky;
  // Throws ProcessingError(kUsage) naming what is out of range: no mesh, a map on a mesh without
  // uv, a camera that looks nowhere, light below 0, no light at all.
  void check() const;
};

V3f skyRadiance(const Sky& sky, const V3f& direction);

// Reflectance of a material at a place of its texture.
V3f colourAt(const Material& material, const mesh::V2f& uv);

}  // namespace patina::render
