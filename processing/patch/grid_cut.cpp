// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/patch/grid_cut.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace patina::patch {
namespace {

using Flow = std::int64_t;

// Right, down, left, up; the opposite of d is d ^ 2.
constexpr std::array<int, 4> kStepX{1, 0, -1, 0}, kStepY{0, 1, 0, -1};

double edgeCost(double s, double t) {
  if (s < 0 && t < 0) return 0;
  if (s < 0) return 2 * t;
  if (t < 0) return 2 * s;
  return s + t;
}

double costOf(const EdgeCosts& costs, int texel, int direction) {
  return (direction == 0 ? costs.right : costs.down).texels()[static_cast<std::size_t>(texel)];
}

// Maximum flow by Dinic's blocking flows, on the free texels; fixed ones are the terminals. Integer
// capacities: the result hangs on no rounding.
class GridFlow {
 public:
  GridFlow(const EdgeCosts& costs, ImageView<const Side> side) : GridFlow(side.width, side.height) {
    side_ = side;
    double largest = 0;
    forEdges([&](int s, int, int d) { largest = std::max(largest, costOf(costs, s, d)); });
    const double scale = largest > 0 ? 0x1p40 / largest : 0;
    forEdges([&](int s, int t, int d) {
      connect(s, t, d, 1 + std::llround(scale * costOf(costs, s, d)));
    });
  }
  // Old stands for 0, new for 1; all texels are free.
  explicit GridFlow(const GridTerms& terms) : GridFlow(terms.one.width(), terms.one.height()) {
    const std::vector<double>&one = terms.one.texels(), &right = terms.right.texels(),
          &down = terms.down.texels();
    double largest = 0;
    for (std::size_t v = 0; v < one.size(); ++v)
      largest = std::max({largest, std::abs(one[v]), right[v], down[v]});
    const double scale = largest > 0 ? 0x1p40 / largest : 0;
    for (std::size_t v = 0; v < one.size(); ++v)
      (one[v] > 0 ? from_source_ : to_sink_)[v] = std::llround(scale * std::abs(one[v]));
    forEdges([&](int s, int, int d) {
      residual_[s][d] = std::llround(scale * (d == 0 ? right : down)[s]);
    });
  }

  void run() {
    while (layer())
      for (int v : sources_) augmentFrom(v);
  }

  // After run(): texels that the source still reaches.
  bool isOld(int v) const { return isFree(v) ? level_[v] >= 0 : side_.data[v] == Side::kOld; }

  template <class Use>
  void forEdges(const Use& use) const {
    for (int y = 0; y < height_; ++y)
      for (int x = 0; x < width_; ++x) {
        const int v = y * width_ + x;
        if (x + 1 < width_) use(v, v + 1, 0);
        if (y + 1 < height_) use(v, v + width_, 1);
      }
  }

 private:
  GridFlow(int width, int height) : width_(width), height_(height) {
    const std::size_t n = static_cast<std::size_t>(width_) * height_;
    residual_.resize(n);
    from_source_.resize(n);
    to_sink_.resize(n);
    level_.resize(n);
    arc_.resize(n);
  }

  bool isFree(int v) const { return side_.empty() || side_.data[v] == Side::kFree; }

  void connect(int s, int t, int d, Flow capacity) {
    if (isFree(s) && isFree(t)) {
      residual_[s][d] = residual_[t][d ^ 2] = capacity;
    } else if (isFree(s) != isFree(t)) {
      const int inner = isFree(s) ? s : t, outer = isFree(s) ? t : s;
      (side_.data[outer] == Side::kOld ? from_source_ : to_sink_)[inner] += capacity;
    }
  }

  int neighbour(int v, int d) const { return v + kStepX[d] + kStepY[d] * width_; }

  // Levels by breadth from the source; false when the sink is out of reach.
  bool layer() {
    std::fill(level_.begin(), level_.end(), -1);
    std::fill(arc_.begin(), arc_.end(), 0);
    queue_.clear();
    for (int v = 0; v < width_ * height_; ++v)
      if (from_source_[v] > 0) {
        level_[v] = 0;
        queue_.push_back(v);
      }
    sources_.assign(queue_.begin(), queue_.end());
    bool reached = false;
    for (std::size_t i = 0; i < queue_.size(); ++i) {
      const int v = queue_[i];
      reached = reached || to_sink_[v] > 0;
      for (int d = 0; d < 4; ++d)
        if (residual_[v][d] > 0 && level_[neighbour(v, d)] < 0) {
          level_[neighbour(v, d)] = level_[v] + 1;
          queue_.push_back(neighbour(v, d));
        }
    }
    return reached;
  }

  // Pushes along level-rising paths from `source` until none is left.
  void augmentFrom(int source) {
    path_.assign(1, source);
    while (!path_.empty() && from_source_[source] > 0) {
      const int v = path_.back();
      if (to_sink_[v] > 0) {
        push();
        continue;
      }
      int& d = arc_[v];
      while (d < 4 && !(residual_[v][d] > 0 && level_[neighbour(v, d)] == level_[v] + 1)) ++d;
      if (d < 4) {
        path_.push_back(neighbour(v, d));
      } else {
        path_.pop_back();
        if (!path_.empty()) ++arc_[path_.back()];
      }
    }
  }

  void push() {
    Flow flow = std::min(from_source_[path_.front()], to_sink_[path_.back()]);
    for (std::size_t i = 0; i + 1 < path_.size(); ++i)
      flow = std::min(flow, residual_[path_[i]][arc_[path_[i]]]);
    from_source_[path_.front()] -= flow;
    to_sink_[path_.back()] -= flow;
    std::size_t keep = path_.size();
    for (std::size_t i = 0; i + 1 < path_.size(); ++i) {
      const int v = path_[i], d = arc_[v];
      residual_[v][d] -= flow;
      residual_[path_[i + 1]][d ^ 2] += flow;
      if (residual_[v][d] == 0) keep = std::min(keep, i + 1);  // go on before the first full edge
    }
    path_.resize(keep);
  }

  int width_, height_;
  ImageView<const Side> side_;  // empty: all are free
  std::vector<std::array<Flow, 4>> residual_;
  std::vector<Flow> from_source_, to_sink_;
  std::vector<int> level_, arc_, queue_, sources_, path_;
};

}  // namespace

GridCut minimumCut(const EdgeCosts& costs, ImageView<const Side> side) {
  PATINA_CHECK(costs.right.size() == side.size() && costs.down.size() == side.size() &&
               side.row_stride == side.width);
  GridFlow flow(costs, side);
  flow.run();
  GridCut cut{Image<std::uint8_t>(side.width, side.height, 1), 0, 0};
  std::uint8_t* take = cut.take_new.texels().data();
  for (int v = 0; v < side.width * side.height; ++v) take[v] = !flow.isOld(v);
  flow.forEdges([&](int s, int t, int d) {
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
  GridFlow flow(terms);
  flow.run();
  Image<std::uint8_t> choice(terms.one.width(), terms.one.height(), 1);
  for (int v = 0; v < choice.width() * choice.height(); ++v)
    choice.texels()[static_cast<std::size_t>(v)] = !flow.isOld(v);
  return choice;
}

}  // namespace patina::patch
