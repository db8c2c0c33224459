// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/patch/similar_patches.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <array>
#include <cfloat>
#include <climits>
#include <cmath>
#include <memory>
#include <utility>

#include "processing/image/simd_path.h"
#include "processing/patch/patch_distance.h"

namespace patina::patch {
namespace {

constexpr std::size_t kComponents = 4, kDimensions = 3 * kComponents;
constexpr std::size_t kLeaf = 32;
constexpr std::size_t kShortList = 8,  // by their keys; then by the whole distance
    kListedMost = 16;

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

// The patches in an order in which each run of at most kLeaf is a leaf of a k-d tree. Trees differ
// by which of the wide dimensions they cut.
class Leaves {
 public:
  Leaves(const std::vector<Key>& keys, std::vector<std::int32_t> patches, int tree)
      : keys_(keys), tree_(tree), patches_(std::move(patches)) {
    if (!patches_.empty()) split(0, patches_.size(), 0);
  }
  std::size_t count() const { return starts_.size(); }
  std::span<const std::int32_t> leaf(std::size_t at) const {
    const std::size_t end = at + 1 < starts_.size() ? starts_[at + 1] : patches_.size();
    return {&patches_[starts_[at]], end - starts_[at]};
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
  std::vector<std::size_t> starts_;
};

// Of each patch the nearest few by their keys, nearest first; of equal ones what came first.
class ShortLists {
 public:
  ShortLists(std::size_t patches, std::size_t length)
      : length_(length), entries_(patches * length, {FLT_MAX, -1}) {}

  float worst(std::int32_t of) const { return list(of)[length_ - 1].difference; }
  void offer(std::int32_t of, float difference, std::int32_t patch) {
    Entry* entries = list(of);
    for (std::size_t i = 0; i < length_; ++i)
      if (entries[i].patch == patch) return;
    std::size_t at = length_ - 1;
    for (; at > 0 && difference < entries[at - 1].difference; --at) entries[at] = entries[at - 1];
    entries[at] = {difference, patch};
  }
  // -1: there are no more.
  std::int32_t patch(std::int32_t of, std::size_t at) const { return list(of)[at].patch; }

 private:
  struct Entry {
    float difference;
    std::int32_t patch;
  };
  const Entry* list(std::int32_t of) const {
    return &entries_[static_cast<std::size_t>(of) * length_];
  }
  Entry* list(std::int32_t of) { return &entries_[static_cast<std::size_t>(of) * length_]; }

  std::size_t length_;
  std::vector<Entry> entries_;
};

// Compares all patches of a leaf with each other. Leaves of one tree share no patch, so several
// threads may do this at once.
void compareLeaf(std::span<const std::int32_t> leaf, const std::vector<Key>& keys, int width,
                 int apart, ShortLists& lists) {
  std::array<std::array<float, kLeaf>, kDimensions> columns;
  std::array<int, kLeaf> x, y;
  for (std::size_t i = 0; i < leaf.size(); ++i) {
    const Key& key = keys[static_cast<std::size_t>(leaf[i])];
    for (std::size_t d = 0; d < kDimensions; ++d) columns[d][i] = key[d];
    x[i] = leaf[i] % width;
    y[i] = leaf[i] / width;
  }
  for (std::size_t d = 0; d < kDimensions; ++d)
    std::fill(columns[d].begin() + static_cast<std::ptrdiff_t>(leaf.size()), columns[d].end(), 0.f);
  for (std::size_t i = 0; i < leaf.size(); ++i) {
    std::array<float, kLeaf> difference{};
    for (std::size_t d = 0; d < kDimensions; ++d) {
      const float mine = columns[d][i];
      for (std::size_t j = 0; j < kLeaf; ++j)
        difference[j] += (columns[d][j] - mine) * (columns[d][j] - mine);
    }
    for (std::size_t j = 0; j < leaf.size(); ++j)
      if (difference[j] < lists.worst(leaf[i]) &&
          (std::abs(x[j] - x[i]) >= apart || std::abs(y[j] - y[i]) >= apart))
        lists.offer(leaf[i], difference[j], leaf[j]);
  }
}

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
  const auto most = static_cast<std::size_t>(count_);
  const std::size_t listed = std::max(most, kShortList);
  ShortLists lists(usable.size(), listed);
  for (const auto& tree : trees)
    tbb::parallel_for(std::size_t{0}, tree->count(), [&](std::size_t leaf) {
      compareLeaf(tree->leaf(leaf), keys, width, options.apart, lists);
    });
  const PatchDistance distance = patchDistance(patch, features.channels, simdPath());
  const auto corner = [&](std::int32_t c) {
    return &features.at(c % width - reach, c / width - reach);
  };
  similar_.assign(usable.size() * most, -1);
  tbb::parallel_for(reach, features.height - reach, [&](int y) {
    for (int x = reach; x < width - reach; ++x) {
      const std::int32_t me = y * width + x;
      if (usable[static_cast<std::size_t>(me)] == 0) continue;
      std::array<std::pair<std::int32_t, std::int32_t>, kListedMost> nearest;
      std::size_t found = 0;
      for (; found < listed && lists.patch(me, found) >= 0; ++found) {
        const std::int32_t other = lists.patch(me, found);
        nearest[found] = {
            distance(corner(me), corner(other), features.row_stride, features.row_stride, INT_MAX),
            other};
      }
      const auto end = nearest.begin() + static_cast<std::ptrdiff_t>(found);
      std::sort(nearest.begin(), end);
      for (std::size_t i = 0; i < std::min(found, most); ++i)
        similar_[static_cast<std::size_t>(me) * most + i] = nearest[i].second;
    }
  });
}

SimilarPatches::SimilarPatches(const SimilarPatches& coarse, SizePx coarse_size, SizePx size,
                               int patch, std::span<const std::uint8_t> usable)
    : count_(coarse.count_) {
  const int reach = patch / 2;
  const auto most = static_cast<std::size_t>(count_);
  PATINA_CHECK(usable.size() ==
               static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height));
  similar_.assign(usable.size() * most, -1);
  const auto above = [&](int i, int length) {
    return std::clamp(i / 2, reach, length - 1 - reach);
  };
  tbb::parallel_for(reach, size.height - reach, [&](int y) {
    for (int x = reach; x < size.width - reach; ++x) {
      const int cx = above(x, coarse_size.width), cy = above(y, coarse_size.height);
      const std::int32_t* at = coarse.of(cy * coarse_size.width + cx);
      std::int32_t* to = &similar_[static_cast<std::size_t>(y * size.width + x) * most];
      for (int k = 0; k < count_ && at[k] >= 0; ++k) {
        const int sx = x + 2 * (at[k] % coarse_size.width - cx),
                  sy = y + 2 * (at[k] / coarse_size.width - cy);
        if (sx < 0 || sy < 0 || sx >= size.width || sy >= size.height) continue;
        const std::int32_t other = sy * size.width + sx;
        if (usable[static_cast<std::size_t>(other)] != 0) *to++ = other;
      }
    }
  });
}

}  // namespace patina::patch
