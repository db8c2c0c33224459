// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/patch/grid_cut.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "processing/patch/grid_flow.h"

namespace patina::patch {
namespace {

constexpr double kScale = 0x1p40;  // the dearest edge as an integer

double edgeCost(double s, double t) {
  if (s < 0 && t < 0) return 0;
  if (s < 0) return 2 * t;
  if (t < 0) return 2 * s;
  return s + t;
}

double costOf(const EdgeCosts& costs, int texel, int direction) {
  return (direction == 0 ? costs.right : costs.down).texels()[static_cast<std::size_t>(texel)];
}

// Use(s, t, d) over all neighbours: t lies to the right of s (d = 0) or below (1).
template <class Use>
void forEdges(SizePx size, const Use& use) {
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      const int v = y * size.width + x;
      if (x + 1 < size.width) use(v, v + 1, 0);
      if (y + 1 < size.height) use(v, v + size.width, 1);
    }
}

// The source stands for old, or 0; the sink for new, or 1. Ties go to new: the source's side is the
// least.
Image<std::uint8_t> newSide(GridFlow& flow, SizePx size) {
  flow.run();
  Image<std::uint8_t> take(size.width, size.height, 1);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) take.at(x, y) = !flow.isSourceSide(flow.at(x, y));
  return take;
}

}  // namespace

GridCut minimumCut(const EdgeCosts& costs, ImageView<const Side> side) {
  PATINA_CHECK(costs.right.size() == side.size() && costs.down.size() == side.size() &&
               side.row_stride == side.width);
  const SizePx size = side.size();
  double largest = 0;
  forEdges(size, [&](int s, int, int d) { largest = std::max(largest, costOf(costs, s, d)); });
  const double scale = largest > 0 ? kScale / largest : 0;
  GridFlow flow(size.width, size.height);
  forEdges(size, [&](int s, int t, int d) {
    const GridFlow::Flow capacity = 1 + std::llround(scale * costOf(costs, s, d));
    const bool s_free = side.data[s] == Side::kFree, t_free = side.data[t] == Side::kFree;
    const int from = flow.at(s % size.width, s / size.width), to = flow.neighbour(from, d);
    if (s_free && t_free) {
      flow.addEdge(from, d, capacity);
      flow.addEdge(to, d + 2, capacity);
    } else if (s_free != t_free) {  // fixed ones are terminals
      const Side fixed = side.data[s_free ? t : s];
      flow.addTerminal(s_free ? from : to, fixed == Side::kOld ? capacity : -capacity);
    }
  });
  GridCut cut{newSide(flow, size), 0, 0};
  std::uint8_t* take = cut.take_new.texels().data();
  for (int v = 0; v < size.width * size.height; ++v)
    if (side.data[v] != Side::kFree) take[v] = side.data[v] == Side::kNew;
  forEdges(size, [&](int s, int t, int d) {
    if (take[s] == take[t]) return;
    cut.cost += costOf(costs, s, d);
    ++cut.cut_edges;
  });
  return cut;
}

Image<double> edgeCosts(ImageView<const double> difference, std::size_t direction) {
  const int right = direction == 0 ? 1 : 0, down = 1 - right;
  Image<double> costs(difference.width, difference.height, 1);
  for (int y = 0; y + down < difference.height; ++y)
    for (int x = 0; x + right < difference.width; ++x)
      costs.at(x, y) = edgeCost(difference.at(x, y), difference.at(x + right, y + down));
  return costs;
}

GridCut minimumCut(ImageView<const double> difference, ImageView<const Side> side) {
  return minimumCut({edgeCosts(difference, 0), edgeCosts(difference, 1)}, side);
}

Image<std::uint8_t> minimumChoice(const GridTerms& terms) {
  PATINA_CHECK(terms.one.size() == terms.right.size() && terms.one.size() == terms.down.size());
  const std::vector<double>&one = terms.one.texels(), &right = terms.right.texels(),
        &down = terms.down.texels();
  double largest = 0;
  for (std::size_t v = 0; v < one.size(); ++v)
    largest = std::max({largest, std::abs(one[v]), right[v], down[v]});
  const double scale = largest > 0 ? kScale / largest : 0;
  const SizePx size = terms.one.size();
  GridFlow flow(size.width, size.height);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      const auto v = static_cast<std::size_t>(y) * size.width + x;
      flow.addTerminal(flow.at(x, y), std::llround(scale * one[v]));
      if (x + 1 < size.width) flow.addEdge(flow.at(x, y), 0, std::llround(scale * right[v]));
      if (y + 1 < size.height) flow.addEdge(flow.at(x, y), 1, std::llround(scale * down[v]));
    }
  return newSide(flow, size);
}

}  // namespace patina::patch
