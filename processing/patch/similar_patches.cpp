// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/patch/similar_patches.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <array>
#include <climits>
#include <cmath>
#include <memory>

#include "processing/image/simd_path.h"
#include "processing/patch/patch_distance.h"

namespace patina::patch {
namespace {

constexpr std::size_t kComponents = 4, kDimensions = 3 * kComponents;
constexpr int kLeaf = 32;
constexpr std::size_t kShortList = 8;  // by their keys; then by the whole distance

using Key = std::array<float, kDimensions>;

// Mean and both gradients of the leading components: orthonormal, so distances of keys are lower
// bounds of distances of patches.
Key keyOf(ImageView<const std::int16_t> f, int x, int y, int reach) {
  float moment = 0;
  for (int d = -reach; d <= reach; ++d) moment += static_cast<float>(d * d);
  const int side = 2 * reach + 1;
  std::array<std::int32_t, kDimensions> sum{};
  for (int dy = -reach; dy <= reach; ++dy) {
    const std::int16_t* texel = &f.at(x - reach, y + dy);
    for (int dx = -reach; dx <= reach; ++dx, texel += f.channels)
      for (std::size_t k = 0; k < kComponents; ++k) {
        const std::size_t i = 3 * k;
        sum[i] += texel[k];
        sum[i + 1] += texel[k] * dx;
        sum[i + 2] += texel[k] * dy;
      }
  }
  const float mean = 1.0f / static_cast<float>(side),
              gradient = 1 / std::sqrt(moment * static_cast<float>(side));
  Key key;
  for (std::size_t i = 0; i < kDimensions; ++i)
    key[i] = static_cast<float>(sum[i]) * (i % 3 == 0 ? mean : gradient);
  return key;
}

float difference(const Key& a, const Key& b) {
  // Four sums, so that they may be added side by side.
  std::array<float, 4> sum{};
  for (std::size_t i = 0; i < kDimensions; i += 4)
    for (std::size_t k = 0; k < 4; ++k) sum[k] += (a[i + k] - b[i + k]) * (a[i + k] - b[i + k]);
  return sum[0] + sum[1] + (sum[2] + sum[3]);
}

// The patches in an order in which each run of at most kLeaf is a leaf of a k-d tree. Trees differ
// by which of the wide dimensions they cut.
class Leaves {
 public:
  Leaves(const std::vector<Key>& keys, std::vector<std::int32_t> patches, int tree)
      : keys_(keys), tree_(tree), patches_(std::move(patches)), leaf_of_(keys.size(), 0) {
    if (!patches_.empty()) split(0, patches_.size(), 0);
  }
  // Leaf mates of a patch, itself among them.
  std::span<const std::int32_t> mates(std::int32_t patch) const {
    const auto leaf = static_cast<std::size_t>(leaf_of_[static_cast<std::size_t>(patch)]);
    return {&patches_[starts_[leaf]],
            (leaf + 1 < starts_.size() ? starts_[leaf + 1] : patches_.size()) - starts_[leaf]};
  }

 private:
  float value(std::int32_t patch, std::size_t dimension) const {
    return keys_[static_cast<std::size_t>(patch)][dimension];
  }

  // The widest dimension; the second widest every so often, at another depth in each tree.
  std::size_t dimensionFor(std::size_t first, std::size_t last, int depth) const {
    std::array<double, kDimensions> variance;
    const std::size_t step = std::max<std::size_t>(1, (last - first) / 64);
    for (std::size_t d = 0; d < kDimensions; ++d) {
      double sum = 0, squares = 0, n = 0;
      for (std::size_t i = first; i < last; i += step, ++n) {
        const double v = value(patches_[i], d);
        sum += v;
        squares += v * v;
      }
      variance[d] = squares / n - (sum / n) * (sum / n);
    }
    const auto widest = std::max_element(variance.begin(), variance.end());
    const auto at = static_cast<std::size_t>(widest - variance.begin());
    if (tree_ == 0 || (depth + tree_) % 3 != 0) return at;
    *widest = -1;
    return static_cast<std::size_t>(std::max_element(variance.begin(), variance.end()) -
                                    variance.begin());
  }

  void split(std::size_t first, std::size_t last, int depth) {  // NOLINT(misc-no-recursion)
    if (last - first <= kLeaf) {
      for (std::size_t i = first; i < last; ++i)
        leaf_of_[static_cast<std::size_t>(patches_[i])] = static_cast<std::int32_t>(starts_.size());
      starts_.push_back(first);
      return;
    }
    const std::size_t d = dimensionFor(first, last, depth);
    // Not always the middle, so that the leaves of two trees have other borders.
    const std::size_t middle =
        first + (last - first) * static_cast<std::size_t>(8 + tree_ % 3) / 17;
    const auto at = [&](std::size_t i) {
      return patches_.begin() + static_cast<std::ptrdiff_t>(i);
    };
    std::nth_element(at(first), at(middle), at(last), [&](std::int32_t a, std::int32_t b) {
      const float va = value(a, d), vb = value(b, d);
      return va < vb || (va == vb && a < b);
    });
    split(first, middle, depth + 1);
    split(middle, last, depth + 1);
  }

  const std::vector<Key>& keys_;
  int tree_;
  std::vector<std::int32_t> patches_;
  std::vector<std::int32_t> leaf_of_;
  std::vector<std::size_t> starts_;
};

// The `size` least of what is offered, in order; the first offered wins a tie.
template <class Distance, std::size_t kMost>
struct Least {
  struct Entry {
    Distance distance;
    std::int32_t patch;
  };
  std::array<Entry, kMost> entries;
  std::size_t found = 0, size = kMost;

  bool full() const { return found == size; }
  void offer(Distance distance, std::int32_t patch) {
    if (full() && !(distance < entries[found - 1].distance)) return;
    for (std::size_t i = 0; i < found; ++i)
      if (entries[i].patch == patch) return;
    std::size_t at = full() ? found - 1 : found++;
    for (; at > 0 && distance < entries[at - 1].distance; --at) entries[at] = entries[at - 1];
    entries[at] = {distance, patch};
  }
};

}  // namespace

SimilarPatches::SimilarPatches(ImageView<const std::int16_t> features, int patch,
                               std::span<const std::uint8_t> usable, const SimilarOptions& options)
    : count_(options.count) {
  const int reach = patch / 2, width = features.width;
  PATINA_CHECK(
      options.count >= 1 && options.count <= 16 && width >= patch && features.height >= patch &&
      usable.size() == static_cast<std::size_t>(width) * static_cast<std::size_t>(features.height));
  std::vector<Key> keys(usable.size());
  std::vector<std::int32_t> patches;
  for (std::size_t i = 0; i < usable.size(); ++i)
    if (usable[i] != 0) patches.push_back(static_cast<std::int32_t>(i));
  tbb::parallel_for(reach, features.height - reach, [&](int y) {
    for (int x = reach; x < width - reach; ++x)
      keys[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(x)] = keyOf(features, x, y, reach);
  });
  std::vector<std::unique_ptr<Leaves>> trees(static_cast<std::size_t>(options.trees));
  tbb::parallel_for(0, options.trees, [&](int i) {
    trees[static_cast<std::size_t>(i)] = std::make_unique<Leaves>(keys, patches, i);
  });
  const PatchDistance distance = patchDistance(patch, features.channels, simdPath());
  const auto corner = [&](std::int32_t c) {
    return &features.at(c % width - reach, c / width - reach);
  };
  const auto most = static_cast<std::size_t>(count_);
  similar_.assign(usable.size() * most, -1);
  tbb::parallel_for(reach, features.height - reach, [&](int y) {
    for (int x = reach; x < width - reach; ++x) {
      const std::int32_t me = y * width + x;
      if (usable[static_cast<std::size_t>(me)] == 0) continue;
      Least<float, 16> listed;
      listed.size = std::max(most, kShortList);
      for (const auto& tree : trees)
        for (const std::int32_t other : tree->mates(me)) {
          const float d =
              difference(keys[static_cast<std::size_t>(me)], keys[static_cast<std::size_t>(other)]);
          if (listed.full() && !(d < listed.entries[listed.found - 1].distance)) continue;
          if (std::abs(other % width - x) < options.apart &&
              std::abs(other / width - y) < options.apart)
            continue;
          listed.offer(d, other);
        }
      Least<std::int32_t, 16> nearest;
      nearest.size = most;
      for (std::size_t i = 0; i < listed.found; ++i) {
        const std::int32_t other = listed.entries[i].patch;
        nearest.offer(
            distance(corner(me), corner(other), features.row_stride, features.row_stride, INT_MAX),
            other);
      }
      for (std::size_t i = 0; i < nearest.found; ++i)
        similar_[static_cast<std::size_t>(me) * most + i] = nearest.entries[i].patch;
    }
  });
}

}  // namespace patina::patch
