// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/patch/similar_patches.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <climits>
#include <cmath>

#include "processing/image/simd_path.h"
#include "processing/patch/patch_distance.h"

namespace patina::patch {
namespace {

constexpr int kComponents = 4, kDimensions = 3 * kComponents;
constexpr int kLeaf = 12;
constexpr std::size_t kOpenMax = 64;

using Key = std::array<float, kDimensions>;

// Mean and both gradients of the leading components: orthonormal, so distances of keys are lower
// bounds of distances of patches.
Key keyOf(ImageView<const std::int16_t> f, int x, int y, int reach) {
  double moment = 0;
  for (int d = -reach; d <= reach; ++d) moment += d * d;
  const int side = 2 * reach + 1;
  const auto mean = static_cast<float>(1.0 / side),
             gradient = static_cast<float>(1 / std::sqrt(moment * side));
  Key key{};
  for (int dy = -reach; dy <= reach; ++dy)
    for (int dx = -reach; dx <= reach; ++dx) {
      const auto texel = f.texel(x + dx, y + dy);
      for (std::size_t k = 0; k < kComponents; ++k) {
        const float v = texel[k];
        key[k] += mean * v;
        key[kComponents + k] += gradient * v * static_cast<float>(dx);
        key[2 * kComponents + k] += gradient * v * static_cast<float>(dy);
      }
    }
  return key;
}

struct Node {
  int first, last;     // of the leaf's patches
  int dimension = -1;  // -1: a leaf
  float cut = 0;
  int below = -1, above = -1;
};

class Tree {
 public:
  Tree(ImageView<const std::int16_t> f, int reach) : width_(f.width) {
    keys_.resize(static_cast<std::size_t>(f.width) * static_cast<std::size_t>(f.height));
    tbb::parallel_for(reach, f.height - reach, [&](int y) {
      for (int x = reach; x < f.width - reach; ++x)
        keys_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
              static_cast<std::size_t>(x)] = keyOf(f, x, y, reach);
    });
    for (int y = reach; y < f.height - reach; ++y)
      for (int x = reach; x < f.width - reach; ++x) patches_.push_back(y * width_ + x);
    build(0, static_cast<int>(patches_.size()));
  }

  // Calls visit(patch) for the patches of the nearest `leaves`, nearest first.
  template <class Visit>
  void nearest(std::int32_t patch, int leaves, const Visit& visit) const {
    struct Open {
      float distance;
      int node;
    };
    const Key& key = keys_[static_cast<std::size_t>(patch)];
    std::array<Open, kOpenMax> open;
    std::size_t count = 0;
    open[count++] = {0, 0};
    for (int leaf = 0; leaf < leaves && count > 0; ++leaf) {
      const auto nearest =
          std::min_element(open.begin(), open.begin() + static_cast<std::ptrdiff_t>(count),
                           [](const Open& a, const Open& b) { return a.distance < b.distance; });
      const float distance = nearest->distance;
      int at = nearest->node;
      *nearest = open[--count];
      while (nodes_[static_cast<std::size_t>(at)].dimension >= 0) {
        const Node& node = nodes_[static_cast<std::size_t>(at)];
        const float off = key[static_cast<std::size_t>(node.dimension)] - node.cut;
        if (count < kOpenMax)
          open[count++] = {distance + off * off, off < 0 ? node.above : node.below};
        at = off < 0 ? node.below : node.above;
      }
      const Node& node = nodes_[static_cast<std::size_t>(at)];
      for (int i = node.first; i < node.last; ++i) visit(patches_[static_cast<std::size_t>(i)]);
    }
  }

 private:
  float value(int patch, int dimension) const {
    return keys_[static_cast<std::size_t>(patch)][static_cast<std::size_t>(dimension)];
  }

  int widest(int first, int last) const {
    int best = 0;
    double most = -1;
    const int step = std::max(1, (last - first) / 64);
    for (int d = 0; d < kDimensions; ++d) {
      double sum = 0, squares = 0;
      int n = 0;
      for (int i = first; i < last; i += step, ++n) {
        const double v = value(patches_[static_cast<std::size_t>(i)], d);
        sum += v;
        squares += v * v;
      }
      const double variance = squares / n - (sum / n) * (sum / n);
      if (variance > most) {
        most = variance;
        best = d;
      }
    }
    return best;
  }

  int build(int first, int last) {  // NOLINT(misc-no-recursion): as deep as log2(patches)
    const int me = static_cast<int>(nodes_.size());
    nodes_.push_back({first, last});
    if (last - first <= kLeaf) return me;
    const int d = widest(first, last), middle = (first + last) / 2;
    std::nth_element(patches_.begin() + first, patches_.begin() + middle, patches_.begin() + last,
                     [&](std::int32_t a, std::int32_t b) {
                       const float va = value(a, d), vb = value(b, d);
                       return va < vb || (va == vb && a < b);
                     });
    const float cut = value(patches_[static_cast<std::size_t>(middle)], d);
    const int below = build(first, middle), above = build(middle, last);
    Node& node = nodes_[static_cast<std::size_t>(me)];
    node.dimension = d;
    node.cut = cut;
    node.below = below;
    node.above = above;
    return me;
  }

  int width_;
  std::vector<Key> keys_;
  std::vector<std::int32_t> patches_;
  std::vector<Node> nodes_;
};

struct Found {
  std::int32_t distance, patch;
};

}  // namespace

SimilarPatches::SimilarPatches(ImageView<const std::int16_t> features, int patch,
                               const SimilarOptions& options)
    : count_(options.count) {
  PATINA_CHECK(options.count >= 1 && options.count <= 16 && features.width >= patch &&
               features.height >= patch);
  const int reach = patch / 2, width = features.width;
  const auto most = static_cast<std::size_t>(count_);
  similar_.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(features.height) *
                      static_cast<std::size_t>(count_),
                  -1);
  const Tree tree(features, reach);
  const PatchDistance distance = patchDistance(patch, features.channels, simdPath());
  const auto corner = [&](int x, int y) { return &features.at(x - reach, y - reach); };
  tbb::parallel_for(reach, features.height - reach, [&](int y) {
    for (int x = reach; x < width - reach; ++x) {
      std::array<Found, 16> best;
      std::size_t found = 0;
      tree.nearest(y * width + x, options.leaves, [&](std::int32_t other) {
        const int ox = other % width, oy = other / width;
        if (std::abs(ox - x) < options.apart && std::abs(oy - y) < options.apart) return;
        const std::int32_t bound = found < most ? INT_MAX : best[found - 1].distance;
        const std::int32_t d =
            distance(corner(x, y), corner(ox, oy), features.row_stride, features.row_stride, bound);
        if (d >= bound) return;
        std::size_t at = found < most ? found++ : found - 1;
        for (; at > 0 && best[at - 1].distance > d; --at) best[at] = best[at - 1];
        best[at] = {d, other};
      });
      std::int32_t* to = &similar_[(static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                                    static_cast<std::size_t>(x)) *
                                   most];
      for (std::size_t i = 0; i < found; ++i) to[i] = best[i].patch;
    }
  });
}

}  // namespace patina::patch
