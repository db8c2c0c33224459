// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/synthesis/texture_optimization/copies.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numeric>
#include <utility>
#include <vector>

namespace patina::texture_optimization {
namespace {

constexpr int kCells = 16;
constexpr double kWholeEnough = 0.75;
constexpr double kLandmarkEnough = 1.0 / 8, kSamePlace = 1.0 / 12;

// Which copied region each patch belongs to: the index of one of its patches.
std::vector<std::int32_t> regionsOf(const OptimizedField& field) {
  const int width = field.size.width;
  std::vector<std::int32_t> parent(field.centres.size());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](std::int32_t i) {
    auto at = static_cast<std::size_t>(i);
    while (parent[at] != static_cast<std::int32_t>(at)) {
      parent[at] = parent[static_cast<std::size_t>(parent[at])];
      at = static_cast<std::size_t>(parent[at]);
    }
    return static_cast<std::int32_t>(at);
  };
  const auto join = [&](std::size_t a, std::size_t b, std::int32_t further) {
    if (field.centres[b] != field.centres[a] + further) return;
    const std::int32_t from = root(static_cast<std::int32_t>(b));
    parent[static_cast<std::size_t>(from)] = root(static_cast<std::int32_t>(a));
  };
  for (std::size_t i = 0; i < parent.size(); ++i) {
    if (static_cast<int>(i % static_cast<std::size_t>(width)) + 1 < width) join(i, i + 1, 1);
    if (i + static_cast<std::size_t>(width) < parent.size())
      join(i, i + static_cast<std::size_t>(width), field.source.width);
  }
  for (std::size_t i = 0; i < parent.size(); ++i) parent[i] = root(static_cast<std::int32_t>(i));
  return parent;
}

struct Place {
  double x = 0, y = 0;  // sums over patches; then of the result, in texels
  int patches = 0;
};

// Of each cell of the sample where the regions show it that show enough of it.
std::vector<std::vector<Place>> placesOf(const OptimizedField& field, int cell_px) {
  const int columns = (field.source.width + cell_px - 1) / cell_px,
            rows = (field.source.height + cell_px - 1) / cell_px;
  const std::vector<std::int32_t> regions = regionsOf(field);
  std::map<std::pair<int, std::int32_t>, Place> shown;
  for (std::size_t i = 0; i < regions.size(); ++i) {
    const int sx = field.centres[i] % field.source.width,
              sy = field.centres[i] / field.source.width,
              cell = sy / cell_px * columns + sx / cell_px;
    Place& place = shown[{cell, regions[i]}];
    const auto width = static_cast<std::size_t>(field.size.width);
    const std::size_t x = i % width, y = i / width;
    place.x += static_cast<double>(x);
    place.y += static_cast<double>(y);
    ++place.patches;
  }
  std::vector<std::vector<Place>> places(static_cast<std::size_t>(columns * rows));
  for (const auto& [key, place] : shown)
    if (place.patches >= kWholeEnough * cell_px * cell_px)
      places[static_cast<std::size_t>(key.first)].push_back(
          {place.x / place.patches, place.y / place.patches, place.patches});
  return places;
}

double apart(const Place& a, const Place& b, const OptimizedField& field) {
  double x = std::abs(a.x - b.x), y = std::abs(a.y - b.y);
  if (field.wraps) {
    x = std::abs(std::remainder(x, field.size.width));
    y = std::abs(std::remainder(y, field.size.height));
  }
  return std::hypot(x, y);
}

// Connected patches that show a landmark: their middle, and that of where the sample would begin.
struct LandmarkShown {
  Place middle, sample;
};

// In coordinates that go on beyond the edge where the result wraps. Takes what it covers from `of`.
LandmarkShown shownFrom(std::size_t first, const OptimizedField& field,
                        std::vector<std::int32_t>& of) {
  const std::int32_t landmark = of[first];
  const int width = field.size.width, height = field.size.height;
  struct Position {
    int x, y;
  };
  std::vector<Position> pending;
  LandmarkShown out;
  const auto take = [&](int x, int y) {
    const int tx = field.wraps ? (x % width + width) % width : x,
              ty = field.wraps ? (y % height + height) % height : y;
    if (tx < 0 || ty < 0 || tx >= width || ty >= height) return;
    const std::size_t at = static_cast<std::size_t>(ty) * static_cast<std::size_t>(width) +
                           static_cast<std::size_t>(tx);
    if (of[at] != landmark) return;
    of[at] = -1;
    const std::int32_t centre = field.centres[at];
    out.middle.x += x;
    out.middle.y += y;
    const int source_x = centre % field.source.width, source_y = centre / field.source.width;
    out.sample.x += x - source_x;
    out.sample.y += y - source_y;
    ++out.middle.patches;
    pending.push_back({x, y});
  };
  take(static_cast<int>(first) % width, static_cast<int>(first) / width);
  while (!pending.empty()) {
    const Position from = pending.back();
    pending.pop_back();
    for (int v = -1; v <= 1; ++v)
      for (int u = -1; u <= 1; ++u) take(from.x + u, from.y + v);
  }
  for (Place* place : {&out.middle, &out.sample}) {
    place->x /= out.middle.patches;
    place->y /= out.middle.patches;
  }
  return out;
}

}  // namespace

double landmarksApart(const OptimizedField& field) {
  const Landmarks& landmarks = field.landmarks;
  std::vector<int> size(static_cast<std::size_t>(landmarks.count));
  for (int y = 0; y < field.source.height; ++y)
    for (int x = 0; x < field.source.width; ++x)
      if (const std::int32_t of = landmarks.at(x, y, field.source); of >= 0)
        ++size[static_cast<std::size_t>(of)];
  std::vector<std::int32_t> of;
  for (const std::int32_t centre : field.centres)
    of.push_back(
        landmarks.at(centre % field.source.width, centre / field.source.width, field.source));
  std::vector<std::vector<LandmarkShown>> shown(size.size());
  for (std::size_t i = 0; i < of.size(); ++i) {
    if (of[i] < 0) continue;
    const auto landmark = static_cast<std::size_t>(of[i]);
    const LandmarkShown one = shownFrom(i, field, of);
    if (one.middle.patches >= kLandmarkEnough * size[landmark]) shown[landmark].push_back(one);
  }
  const int side = std::min(field.source.width, field.source.height);
  double least = std::numeric_limits<double>::max();
  for (const std::vector<LandmarkShown>& places : shown)
    for (std::size_t a = 0; a < places.size(); ++a)
      for (std::size_t b = a + 1; b < places.size(); ++b)
        if (apart(places[a].sample, places[b].sample, field) > kSamePlace * side)
          least = std::min(least, apart(places[a].middle, places[b].middle, field));
  return least < std::numeric_limits<double>::max() ? least / side : 0;
}

CopiesApart copiesApart(const OptimizedField& field) {
  const int side = std::min(field.source.width, field.source.height),
            cell_px = std::max(1, side / kCells);
  const std::vector<std::vector<Place>> places = placesOf(field, cell_px);
  std::vector<double> least;
  for (const std::vector<Place>& cell : places) {
    if (cell.size() < 2) continue;
    double nearest = std::numeric_limits<double>::max();
    for (std::size_t a = 0; a < cell.size(); ++a)
      for (std::size_t b = a + 1; b < cell.size(); ++b)
        nearest = std::min(nearest, apart(cell[a], cell[b], field));
    least.push_back(nearest / side);
  }
  CopiesApart out;
  if (least.empty()) return out;
  std::sort(least.begin(), least.end());
  out.shown_again = static_cast<double>(least.size()) / static_cast<double>(places.size());
  out.least = least.front();
  out.twentieth = least[least.size() / 20];
  out.median = least[least.size() / 2];
  return out;
}

}  // namespace patina::texture_optimization
