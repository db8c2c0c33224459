// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/mesh/shapes.h"

#include <cmath>
#include <functional>
#include <numbers>

namespace patina::mesh {
namespace {

using Imath::V3d;

struct Spot {
  V3d position, normal;
};

V3f single(const V3d& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

// Over a grid of u (right) and v (down), each from 0 to 1.
TriangleMesh gridMesh(int columns, int rows, const std::function<Spot(double, double)>& at) {
  if (columns < 1 || rows < 1 || columns > 20000 || rows > 20000)
    throw ProcessingError(Exit::kUsage, "a shape has 1 to 20000 columns and rows");
  const auto corner = [&](int x, int y) {
    const double u = static_cast<double>(x) / columns, v = static_cast<double>(y) / rows;
    const Spot spot = at(u, v);
    return Corner{
        single(spot.position), single(spot.normal), {static_cast<float>(u), static_cast<float>(v)}};
  };
  std::vector<Corner> corners;
  for (int y = 0; y < rows; ++y)
    for (int x = 0; x < columns; ++x) {
      const Corner a = corner(x, y), b = corner(x, y + 1), c = corner(x + 1, y + 1),
                   d = corner(x + 1, y);
      for (const Corner& one : {a, b, c, a, c, d}) corners.push_back(one);
    }
  return meshOfCorners(corners);
}

double aroundOf(double u) { return u == 1 ? 0 : 2 * std::numbers::pi * u; }  // closes exactly

void needPositive(double value, const char* what) {
  if (!(value > 0) || !(value < 1e9))
    throw ProcessingError(Exit::kUsage, std::string(what) + " is above 0 mm");
}

}  // namespace

TriangleMesh planeMesh(double width_mm, double height_mm, int columns, int rows) {
  needPositive(width_mm, "a plane's width");
  needPositive(height_mm, "a plane's height");
  return gridMesh(columns, rows, [&](double u, double v) {
    return Spot{{(u - 0.5) * width_mm, (0.5 - v) * height_mm, 0}, {0, 0, 1}};
  });
}

TriangleMesh sphereMesh(double radius_mm, int rings) {
  needPositive(radius_mm, "a sphere's radius");
  return gridMesh(2 * rings, rings, [&](double u, double v) {
    const double around = aroundOf(u), down = std::numbers::pi * v,
                 across = v == 0 || v == 1 ? 0 : std::sin(down);
    const V3d n(across * std::cos(around), across * std::sin(around), std::cos(down));
    return Spot{n * radius_mm, n};
  });
}

TriangleMesh cylinderMesh(double radius_mm, double height_mm, int segments, int rows) {
  needPositive(radius_mm, "a cylinder's radius");
  needPositive(height_mm, "a cylinder's height");
  return gridMesh(segments, rows, [&](double u, double v) {
    const double around = aroundOf(u);
    const V3d n(std::cos(around), std::sin(around), 0);
    return Spot{V3d(n.x * radius_mm, n.y * radius_mm, (0.5 - v) * height_mm), n};
  });
}

TriangleMesh reliefMesh(const HeightMap& map) {
  const Image<float> normals = normalsOf(map);
  const ImageView<const float> heights = map.height_mm;
  if (heights.width < 2 || heights.height < 2)
    throw ProcessingError(Exit::kUsage, "a relief has at least 2x2 texels");
  return gridMesh(heights.width - 1, heights.height - 1, [&](double u, double v) {
    const int x = static_cast<int>(std::lround(u * (heights.width - 1))),
              y = static_cast<int>(std::lround(v * (heights.height - 1)));
    return Spot{{(x + 0.5 - heights.width / 2.0) * map.mm_per_texel,
                 (heights.height / 2.0 - y - 0.5) * map.mm_per_texel, heights.at(x, y)},
                {normals.at(x, y, 0), normals.at(x, y, 1), normals.at(x, y, 2)}};
  });
}

}  // namespace patina::mesh
