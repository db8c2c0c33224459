// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/mesh/uv_bake.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

namespace patina::mesh {
namespace {

using Imath::V2d;

constexpr std::int64_t kTwiceOfCovered = 1000;  // rounding of an unwrap's slivers

[[noreturn]] void refuse(const std::string& why) { throw ProcessingError(Exit::kBadData, why); }

// Twice the area of a, b, p; the same but for its sign for b, a, p, so that of two triangles at an
// edge exactly one owns a point upon it.
double edgeAt(const V2d& a, const V2d& b, const V2d& p) {
  const auto from = [&p](const V2d& first, const V2d& second) {
    return (second.x - first.x) * (p.y - first.y) - (second.y - first.y) * (p.x - first.x);
  };
  const bool in_order = a.y < b.y || (a.y == b.y && a.x < b.x);
  return in_order ? from(a, b) : -from(b, a);
}

bool ownsEdge(const V2d& a, const V2d& b) { return a.y < b.y || (a.y == b.y && a.x > b.x); }

}  // namespace

UvBake::UvBake(const TriangleMesh& mesh, SizePx size)
    : mesh_(mesh),
      size_(size),
      texels_(static_cast<std::size_t>(size.width) * size.height),
      nearest_(texels_.size(), -1) {
  if (mesh.uv.empty())
    refuse("the mesh has no texture coordinates: unwrap it in a modelling program first");
  for (const V2f& uv : mesh.uv)
    if (!(uv.x >= -1e-4f && uv.x <= 1.0001f && uv.y >= -1e-4f && uv.y <= 1.0001f))
      refuse("the mesh repeats its texture (a texture coordinate is " + std::to_string(uv.x) +
             ", " + std::to_string(uv.y) +
             "): for an ageing of its own every place needs a texel of its own; unwrap it within 0 "
             "to 1");
  for (std::uint32_t t = 0; t < mesh.triangle.size(); ++t) rasterise(t);
  if (covered_ == 0) refuse("no texel of the texture lies on the mesh");
  if (twice_ * kTwiceOfCovered > covered_)
    refuse("the mesh uses parts of its texture twice (" + std::to_string(twice_) + " of " +
           std::to_string(covered_) + " texels, first by triangles " + std::to_string(first_[0]) +
           " and " + std::to_string(first_[1]) + "): unwrap it so that charts do not overlap");
  spread();
}

void UvBake::rasterise(std::uint32_t triangle) {
  const auto& corners = mesh_.triangle[triangle];
  std::array<V2d, 3> p;
  for (std::size_t i = 0; i < 3; ++i)
    p[i] = {static_cast<double>(mesh_.uv[corners[i]].x) * size_.width,
            static_cast<double>(mesh_.uv[corners[i]].y) * size_.height};
  const double area = edgeAt(p[0], p[1], p[2]);
  if (area == 0) return;
  const bool is_mirrored = area < 0;
  if (is_mirrored) std::swap(p[1], p[2]);
  const auto [left, right] = std::minmax({p[0].x, p[1].x, p[2].x});
  const auto [top, bottom] = std::minmax({p[0].y, p[1].y, p[2].y});
  const int x0 = std::max(0, static_cast<int>(std::floor(left - 0.5))),
            x1 = std::min(size_.width - 1, static_cast<int>(std::ceil(right - 0.5))),
            y0 = std::max(0, static_cast<int>(std::floor(top - 0.5))),
            y1 = std::min(size_.height - 1, static_cast<int>(std::ceil(bottom - 0.5)));
  for (int y = y0; y <= y1; ++y)
    for (int x = x0; x <= x1; ++x) {
      const V2d at(x + 0.5, y + 0.5);
      std::array<double, 3> w{};  // across from each corner
      bool is_inside = true;
      for (std::size_t i = 0; i < 3 && is_inside; ++i) {
        const V2d &a = p[(i + 1) % 3], &b = p[(i + 2) % 3];
        w[i] = edgeAt(a, b, at);
        is_inside = w[i] > 0 || (w[i] == 0 && ownsEdge(a, b));
      }
      if (!is_inside) continue;
      const std::size_t index = static_cast<std::size_t>(y) * size_.width + x;
      if (nearest_[index] >= 0) {
        if (twice_++ == 0) first_[0] = texels_[index].triangle, first_[1] = triangle;
        continue;
      }
      nearest_[index] = static_cast<std::int32_t>(index);
      ++covered_;
      const double sum = w[0] + w[1] + w[2];
      texels_[index] = {triangle, static_cast<float>(w[is_mirrored ? 2 : 1] / sum),
                        static_cast<float>(w[is_mirrored ? 1 : 2] / sum)};
    }
}

// Ring by ring from the charts outwards.
void UvBake::spread() {
  std::vector<std::int32_t> front;
  for (std::size_t i = 0; i < nearest_.size(); ++i)
    if (nearest_[i] >= 0) front.push_back(static_cast<std::int32_t>(i));
  while (!front.empty()) {
    std::vector<std::int32_t> next;
    for (const std::int32_t at : front) {
      const int x = at % size_.width, y = at / size_.width;
      for (const auto& [dx, dy] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
        const int nx = x + dx, ny = y + dy;
        if (nx < 0 || ny < 0 || nx >= size_.width || ny >= size_.height) continue;
        const std::int32_t to = ny * size_.width + nx;
        if (nearest_[to] >= 0) continue;
        nearest_[to] = nearest_[at];
        next.push_back(to);
      }
    }
    front.swap(next);
  }
}

Image<float> UvBake::map(const std::function<float(const UvTexel&)>& of) const {
  Image<float> out(size_.width, size_.height, 1);
  std::vector<float>& values = out.texels();
  tbb::parallel_for(0, size_.height, [&](int y) {
    const std::size_t first = static_cast<std::size_t>(y) * size_.width;
    for (std::size_t i = first; i < first + size_.width; ++i)
      if (nearest_[i] == static_cast<std::int32_t>(i)) values[i] = of(texels_[i]);
  });
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = values[nearest_[i]];
  return out;
}

Image<float> UvBake::map(const std::vector<float>& of_vertex) const {
  return map([&](const UvTexel& texel) {
    const auto& [a, b, c] = mesh_.triangle[texel.triangle];
    return of_vertex[a] * (1 - texel.b1 - texel.b2) + of_vertex[b] * texel.b1 +
           of_vertex[c] * texel.b2;
  });
}

double UvBake::covered_share() const {
  return static_cast<double>(covered_) / static_cast<double>(texels_.size());
}

}  // namespace patina::mesh
