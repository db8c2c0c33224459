// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/mesh/curvature.h"

#include <algorithm>
#include <array>
#include <map>
#include <utility>

namespace patina::mesh {
namespace {

using Imath::V3d;

struct Place {
  V3d bend{0, 0, 0};    // sum of (cot a + cot b) (x_i - x_j)
  V3d normal{0, 0, 0};  // weighted by area
  double area = 0;      // mixed
  bool on_border = false;
};

// Of the angle at `at` in the triangle with `b` and `c`.
double cotangent(const V3d& at, const V3d& b, const V3d& c) {
  const V3d u = b - at, v = c - at;
  return u.dot(v) / std::max(u.cross(v).length(), 1e-300);
}

// One triangle's part in the sums of its corners.
void addTriangle(const std::array<V3d, 3>& x, const std::array<Place*, 3>& place) {
  std::array<double, 3> cot{};
  for (std::size_t i = 0; i < 3; ++i) cot[i] = cotangent(x[i], x[(i + 1) % 3], x[(i + 2) % 3]);
  const V3d twice = (x[1] - x[0]).cross(x[2] - x[0]);
  const double area = twice.length() / 2;
  const bool is_obtuse = cot[0] < 0 || cot[1] < 0 || cot[2] < 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
    const V3d to_j = x[i] - x[j], to_k = x[i] - x[k];
    place[i]->bend += to_j * cot[k] + to_k * cot[j];
    place[i]->normal += twice;
    if (is_obtuse)
      place[i]->area += cot[i] < 0 ? area / 2 : area / 4;
    else
      place[i]->area += (to_j.length2() * cot[k] + to_k.length2() * cot[j]) / 8;
  }
}

using Edge = std::pair<std::uint32_t, std::uint32_t>;

std::vector<Edge> edgesOf(const TriangleMesh& mesh, const std::vector<std::uint32_t>& place_of) {
  std::vector<Edge> edges;
  for (const auto& t : mesh.triangle)
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = place_of[t[i]], b = place_of[t[(i + 1) % 3]];
      if (a != b) edges.emplace_back(std::min(a, b), std::max(a, b));
    }
  std::sort(edges.begin(), edges.end());
  return edges;
}

void markBorders(const std::vector<Edge>& edges, std::vector<Place>& places) {
  for (std::size_t i = 0; i < edges.size();) {
    std::size_t next = i + 1;
    while (next < edges.size() && edges[next] == edges[i]) ++next;
    if (next - i != 2) places[edges[i].first].on_border = places[edges[i].second].on_border = true;
    i = next;
  }
}

}  // namespace

std::vector<float> meanCurvatureOf(const TriangleMesh& mesh) {
  const std::vector<std::uint32_t> place_of = placesOf(mesh);
  std::uint32_t count = 0;
  for (const std::uint32_t p : place_of) count = std::max(count, p + 1);
  std::vector<Place> places(count);
  for (const auto& t : mesh.triangle)
    addTriangle(
        {V3d(mesh.position_mm[t[0]]), V3d(mesh.position_mm[t[1]]), V3d(mesh.position_mm[t[2]])},
        {&places[place_of[t[0]]], &places[place_of[t[1]]], &places[place_of[t[2]]]});
  const std::vector<Edge> edges = edgesOf(mesh, place_of);
  markBorders(edges, places);
  std::vector<double> value(count, 0.0), sum(count, 0.0);
  std::vector<int> neighbours(count, 0);
  for (std::uint32_t p = 0; p < count; ++p)
    if (!places[p].on_border && places[p].area > 0)
      value[p] = places[p].bend.dot(places[p].normal.normalized()) / (4 * places[p].area);
  for (const auto& [a, b] : edges) {
    if (places[a].on_border && !places[b].on_border) sum[a] += value[b], ++neighbours[a];
    if (places[b].on_border && !places[a].on_border) sum[b] += value[a], ++neighbours[b];
  }
  std::vector<float> out;
  out.reserve(place_of.size());
  for (const std::uint32_t p : place_of)
    out.push_back(static_cast<float>(neighbours[p] > 0 ? sum[p] / neighbours[p] : value[p]));
  return out;
}

}  // namespace patina::mesh
