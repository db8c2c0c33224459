// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/patch/grid_flow.h"

#include <algorithm>
#include <limits>

namespace patina::patch {
namespace {

constexpr std::int8_t opposite(int d) { return static_cast<std::int8_t>(d ^ 2); }

}  // namespace

GridFlow::GridFlow(int width, int height)
    : step_{1, width + 1, -1, -width - 1},
      nodes_(static_cast<std::size_t>(width + 1) * static_cast<std::size_t>(height + 2) + 1) {}

GridFlow::Flow GridFlow::outward(Tree tree, int v, int d) const {
  return tree == Tree::kSource ? nodes_[v].residual[d]
                               : nodes_[neighbour(v, d)].residual[opposite(d)];
}

void GridFlow::activate(int v) {
  if (nodes_[v].is_active) return;
  nodes_[v].is_active = true;
  coming_.push_back(v);
}

void GridFlow::run() {
  for (int v = 0; v < static_cast<int>(nodes_.size()); ++v) {
    Node& node = nodes_[v];
    if (node.terminal == 0) continue;
    node.tree = node.terminal > 0 ? Tree::kSource : Tree::kSink;
    node.parent = kTerminal;
    node.distance = 1;
    activate(v);
  }
  while (!coming_.empty()) {
    active_.swap(coming_);
    coming_.clear();
    for (int v : active_) {
      nodes_[v].is_active = false;
      if (nodes_[v].tree != Tree::kNone) grow(v);
    }
  }
}

// Along every edge that lets flow through: what is in no tree joins v's, and where the trees meet
// flow is sent.
void GridFlow::grow(int v) {
  for (int d = 0; d < 4; ++d) {
    const Tree tree = nodes_[v].tree;
    if (tree == Tree::kNone) return;
    if (outward(tree, v, d) <= 0) continue;
    Node& node = nodes_[v];
    const int u = neighbour(v, d);
    Node& other = nodes_[u];
    if (other.tree == Tree::kNone) {
      other.tree = tree;
      other.parent = opposite(d);
      other.stamp = node.stamp;
      other.distance = node.distance + 1;
      activate(u);
    } else if (other.tree != tree) {
      if (tree == Tree::kSource)
        augment(v, d);
      else
        augment(u, opposite(d));
      --d;  // there may be more to send
    } else if (other.stamp <= node.stamp && other.distance > node.distance) {
      other.parent = opposite(d);  // nearer to a terminal
      other.stamp = node.stamp;
      other.distance = node.distance + 1;
    }
  }
}

// From the source through v, along d and on to the sink.
void GridFlow::augment(int v, int d) {
  const int to = neighbour(v, d);
  Flow flow = nodes_[v].residual[d];
  int root = v;
  for (; nodes_[root].parent != kTerminal; root = neighbour(root, nodes_[root].parent)) {
    const std::int8_t up = nodes_[root].parent;
    flow = std::min(flow, nodes_[neighbour(root, up)].residual[opposite(up)]);
  }
  flow = std::min(flow, nodes_[root].terminal);
  for (root = to; nodes_[root].parent != kTerminal; root = neighbour(root, nodes_[root].parent))
    flow = std::min(flow, nodes_[root].residual[nodes_[root].parent]);
  flow = std::min(flow, -nodes_[root].terminal);

  nodes_[v].residual[d] -= flow;
  nodes_[to].residual[opposite(d)] += flow;
  const auto follow = [&](int node, bool from_source) {
    while (nodes_[node].parent != kTerminal) {
      const std::int8_t up = nodes_[node].parent;
      const int next = neighbour(node, up);
      Flow &inner = nodes_[next].residual[opposite(up)], &outer = nodes_[node].residual[up];
      Flow& used = from_source ? inner : outer;
      used -= flow;
      (from_source ? outer : inner) += flow;
      if (used == 0) makeOrphan(node);
      node = next;
    }
    nodes_[node].terminal += from_source ? -flow : flow;
    if (nodes_[node].terminal == 0) makeOrphan(node);
  };
  follow(v, true);
  follow(to, false);
  ++now_;
  for (std::size_t i = 0; i < orphans_.size(); ++i) adopt(orphans_[i]);
  orphans_.clear();
}

void GridFlow::makeOrphan(int v) {
  nodes_[v].parent = kOrphan;
  orphans_.push_back(v);
}

// Is there a way up to a terminal, and how long is it? What is found is marked for this round.
bool GridFlow::isRooted(int v, std::int32_t& distance) {
  distance = 0;
  for (int at = v;;) {
    Node& node = nodes_[at];
    if (node.stamp == now_) {
      distance += node.distance;
      break;
    }
    ++distance;
    if (node.parent == kTerminal) {
      node.stamp = now_;
      node.distance = 1;
      break;
    }
    if (node.parent == kOrphan) return false;
    at = neighbour(at, node.parent);
  }
  std::int32_t left = distance;
  for (int at = v; nodes_[at].stamp != now_; at = neighbour(at, nodes_[at].parent)) {
    nodes_[at].stamp = now_;
    nodes_[at].distance = left--;
  }
  return true;
}

// Finds the orphan another parent in its tree, or leaves it to none, and its children orphans.
void GridFlow::adopt(int v) {
  Node& node = nodes_[v];
  const Tree tree = node.tree;
  const auto comesFrom = [&](int d) {
    const int u = neighbour(v, d);
    return nodes_[u].tree == tree && outward(tree, u, opposite(d)) > 0;
  };
  std::int32_t least = std::numeric_limits<std::int32_t>::max();
  for (int d = 0; d < 4; ++d) {
    std::int32_t distance;
    if (!comesFrom(d) || !isRooted(neighbour(v, d), distance) || distance >= least) continue;
    least = distance;
    node.parent = static_cast<std::int8_t>(d);
  }
  if (node.parent != kOrphan) {
    node.stamp = now_;
    node.distance = least + 1;
    return;
  }
  for (int d = 0; d < 4; ++d) {
    const int u = neighbour(v, d);
    if (comesFrom(d)) activate(u);
    if (nodes_[u].tree == tree && nodes_[u].parent == opposite(d)) makeOrphan(u);
  }
  node.tree = Tree::kNone;
}

}  // namespace patina::patch
