// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/patch/grid_flow.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "processing/image/random.h"

namespace patina::patch {
namespace {

using Flow = GridFlow::Flow;

// Capacities as they were given, and the least source side by shortest paths over all texels.
struct Plain {
  int width, height;
  std::vector<std::array<Flow, 4>> edges;
  std::vector<Flow> terminal;

  Plain(int w, int h) : width(w), height(h), edges(w * h), terminal(w * h) {}
  int next(int v, int d) const { return v + (d == 0) - (d == 2) + width * ((d == 1) - (d == 3)); }
  bool has(int v, int d) const {
    const int x = v % width, y = v / width;
    return d == 0 ? x + 1 < width : d == 1 ? y + 1 < height : d == 2 ? x > 0 : y > 0;
  }
  std::vector<bool> sourceSide() {
    for (;;) {
      std::vector<int> from(edges.size(), -2), queue;  // the direction back; -1: the source
      for (std::size_t v = 0; v < edges.size(); ++v)
        if (terminal[v] > 0) {
          from[v] = -1;
          queue.push_back(static_cast<int>(v));
        }
      int sink = -1;
      for (std::size_t i = 0; i < queue.size() && sink < 0; ++i) {
        const int v = queue[i];
        if (terminal[v] < 0) sink = v;
        for (int d = 0; d < 4; ++d)
          if (has(v, d) && edges[v][d] > 0 && from[next(v, d)] == -2) {
            from[next(v, d)] = d ^ 2;
            queue.push_back(next(v, d));
          }
      }
      if (sink < 0) {
        std::vector<bool> reached;
        for (int f : from) reached.push_back(f != -2);
        return reached;
      }
      Flow most = -terminal[sink];
      int v = sink;
      for (; from[v] >= 0; v = next(v, from[v]))
        most = std::min(most, edges[next(v, from[v])][from[v] ^ 2]);
      most = std::min(most, terminal[v]);
      terminal[v] -= most;
      terminal[sink] += most;
      for (v = sink; from[v] >= 0; v = next(v, from[v])) {
        edges[next(v, from[v])][from[v] ^ 2] -= most;
        edges[v][from[v]] += most;
      }
    }
  }
};

// Terminals at a texel in `sparse`, the same seed the same capacities.
void expectTheSameSide(int width, int height, int sparse, Flow most, std::uint64_t seed) {
  Plain plain(width, height);
  GridFlow flow(width, height);
  const auto drawn = [&](std::uint64_t v, std::uint64_t what) {
    return static_cast<Flow>(
        uniformBelow(hashSeed(seed, v, what), static_cast<std::uint64_t>(most)));
  };
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const int v = y * width + x;
      if (drawn(v, 9) % sparse == 0) {
        plain.terminal[v] = drawn(v, 5) - most / 2;
        flow.addTerminal(flow.at(x, y), plain.terminal[v]);
      }
      for (int d = 0; d < 4; ++d) {
        if (!plain.has(v, d)) continue;
        plain.edges[v][d] = drawn(v, d);
        flow.addEdge(flow.at(x, y), d, plain.edges[v][d]);
      }
    }
  flow.run();
  const std::vector<bool> source_side = plain.sourceSide();
  for (int v = 0; v < width * height; ++v)
    ASSERT_EQ(flow.isSourceSide(flow.at(v % width, v / width)), source_side[v])
        << width << "x" << height << " seed " << seed << " texel " << v;
}

TEST(GridFlow, LeavesTheSourceTheLeastSideOfAnyMaximumFlow) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    expectTheSameSide(1 + static_cast<int>(seed % 7), 1 + static_cast<int>(seed % 5), 2, 20, seed);
    expectTheSameSide(17, 12, 5, 1000, seed);
  }
}

TEST(GridFlow, DoesSoWhereCapacitiesAreFewAndTiesMany) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) expectTheSameSide(14, 19, 6, 4, seed);
}

TEST(GridFlow, DoesSoWhereFlowGoesFar) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) expectTheSameSide(40, 30, 100, 1000, seed);
}

}  // namespace
}  // namespace patina::patch
