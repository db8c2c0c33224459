// SPDX-License-Identifier: GPL-3.0-or-later
// Maximum flow through a grid of texels, each with an edge to its four neighbours, one from the
// source and one to the sink (Boykov and Kolmogorov 2004: two search trees that are kept from one
// path to the next). Inside this room only.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace patina::patch {

class GridFlow {
 public:
  using Flow = std::int64_t;  // integer capacities: the result hangs on no rounding

  GridFlow(int width, int height);

  int at(int x, int y) const { return (y + 1) * step_[1] + x; }  // a texel's number

  // From the source to texel v; below 0: from it to the sink. What comes and goes at one texel
  // passes at once.
  void addTerminal(int v, Flow capacity) { nodes_[v].terminal += capacity; }
  // From v to its neighbour to the right (d = 0), below (1), left (2), above (3), which there is:
  // capacities add up.
  void addEdge(int v, int d, Flow capacity) { nodes_[v].residual[d] += capacity; }
  int neighbour(int v, int d) const { return v + step_[d]; }

  // Once. About O(texels) where terminals are many, O(texels^1.5) where flow must go far.
  void run();
  // After run(): does the source still reach it? The least such set of all minimum cuts.
  bool isSourceSide(int v) const { return nodes_[v].tree == Tree::kSource; }

 private:
  enum class Tree : std::int8_t { kNone, kSource, kSink };
  static constexpr std::int8_t kTerminal = 4, kOrphan = 5;
  struct Node {
    std::array<Flow, 4> residual{};
    Flow terminal = 0;  // above 0: left from the source; below: to the sink
    std::int32_t stamp = 0, distance = 0;
    Tree tree = Tree::kNone;
    std::int8_t parent = kTerminal;  // a direction, or one of the above; within a tree
    bool is_active = false;
  };

  // What may still flow from v along d in the direction in which its tree's flow goes when the tree
  // grows: of the source's out of v, of the sink's into it.
  Flow outward(Tree tree, int v, int d) const;
  void activate(int v);
  void grow(int v);
  void augment(int v, int d);
  void makeOrphan(int v);
  void adopt(int v);
  bool isRooted(int v, std::int32_t& distance);

  std::array<int, 4> step_;
  std::vector<Node> nodes_;  // by rows, between texels without edges
  std::vector<int> active_, coming_, orphans_;
  std::int32_t now_ = 0;
};

}  // namespace patina::patch
