// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/synthesis/texture_optimization/layout.h"

#include <immintrin.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "processing/image/failure.h"
#include "processing/image/random.h"
#include "processing/synthesis/texture_optimization/layout_landmarks.h"

namespace patina::texture_optimization {
namespace {

constexpr int kBlocksAside = 4;  // of the source
constexpr int kRimPx = 2;
constexpr int kSweeps = 12, kColdSweeps = 4;
constexpr std::size_t kPlacesMost = 700;  // judged a block and sweep

// Costs, where rims that have nothing to do with one another cost 1. Of a whole block that is shown
// again `apart` of the source's sides away, kRepeat (1 - apart / kApart)^2: weighed by where copies
// end up (docs/optimization.md).
constexpr double kRepeat = 4, kApart = 1.1;
// Of one copy that goes on beyond two blocks, for each block there: else whole samples lie side by
// side.
constexpr double kLongCopy = 0.8;
constexpr double kHeat = 0.3;

std::size_t texelsOf(SizePx size) {
  return static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height);
}

// What there is beside a block: a target texel by its place in the block, and what it shows.
struct Rim {
  int x, y;
  std::ptrdiff_t offset;  // in the source, in numbers
  const std::int16_t* shown;
  float weight;  // of its mismatch
};

class Layout {
 public:
  Layout(ImageView<const std::int16_t> source, SizePx target, const LayoutLimits& limits,
         std::uint64_t seed)
      : source_(source),
        target_(target),
        wraps_(limits.wraps),
        seed_(seed),
        block_(std::max(2, std::min(source.width, source.height) / kBlocksAside)),
        columns_((target.width + block_ - 1) / block_),
        rows_((target.height + block_ - 1) / block_),
        kept_(limits.kept.begin(), limits.kept.end()),
        shown_(limits.kept.begin(), limits.kept.end()),
        repeats_(texelsOf(source.size())) {
    shown_.resize(texelsOf(target), -1);
    for (int y = 0; y + block_ <= source.height; ++y)
      for (int x = 0; x + block_ <= source.width; ++x)
        if (holdsBlock(limits.usable, x, y)) places_.push_back(y * source.width + x);
    makeKernel();
    if (limits.landmarks != nullptr)
      landmarks_ = LayoutLandmarks(
          *limits.landmarks, source.size(), block_, places_,
          static_cast<float>(texelsOf(target)) / static_cast<float>(texelsOf(source.size())));
    mismatch_unit_ = varianceOfDifferences();
  }

  bool possible() const { return !places_.empty(); }

  std::vector<std::int32_t> run(Progress& progress) {
    progress.begin("laying out", kSweeps);
    const std::size_t count = texelsOf({columns_, rows_});
    for (std::size_t b = 0; b < count; ++b) {
      blocks_.push_back(places_[uniformBelow(hashSeed(seed_, 0x6c, b), places_.size())]);
      show(b, Shown::kBlock);
    }
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
      const double left = 1 - static_cast<double>(sweep) / (kSweeps - kColdSweeps);
      for (std::size_t i = 0; i < count; ++i)
        move(sweep % 2 == 0 ? i : count - 1 - i, sweep, kHeat * std::max(0.0, left));
      progress.step();
    }
    return shown_;
  }

 private:
  enum class Shown { kNothing, kBlock };

  int columnOf(std::size_t b) const { return static_cast<int>(b) % columns_; }
  int rowOf(std::size_t b) const { return static_cast<int>(b) / columns_; }
  std::size_t targetIndex(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(target_.width) +
           static_cast<std::size_t>(x);
  }
  bool isKept(int x, int y) const { return !kept_.empty() && kept_[targetIndex(x, y)] >= 0; }

  bool holdsBlock(std::span<const std::uint8_t> usable, int x, int y) const {
    for (int j = 0; j < block_ && !usable.empty(); ++j)
      for (int i = 0; i < block_; ++i)
        if (const int at = (y + j) * source_.width + x + i;
            usable[static_cast<std::size_t>(at)] == 0)
          return false;
    return true;
  }

  // By how far a repeat lies away, along x and y.
  void makeKernel() {
    const double reach = kApart * std::min(source_.width, source_.height);
    kernel_reach_ = static_cast<int>(std::ceil(reach));
    for (int y = -kernel_reach_; y <= kernel_reach_; ++y)
      for (int x = -kernel_reach_; x <= kernel_reach_; ++x) {
        const double near = std::max(0.0, 1 - std::hypot(x, y) / reach);
        kernel_.push_back(x == 0 && y == 0 ? 0.0f : static_cast<float>(kRepeat * near * near));
      }
  }

  // (x, y) from `place`.
  std::size_t sourceIndex(std::int32_t place, int x, int y) const {
    return static_cast<std::size_t>(place + std::ptrdiff_t{y} * source_.width + x);
  }

  // Mean squared difference of two texels anywhere in the source.
  double varianceOfDifferences() const {
    const auto texels = static_cast<double>(texelsOf(source_.size()));
    double out = 0;
    for (int c = 0; c < source_.channels; ++c) {
      std::int64_t sum = 0, squares = 0;
      for (int y = 0; y < source_.height; ++y)
        for (int x = 0; x < source_.width; ++x) {
          const std::int64_t v = source_.at(x, y, c);
          sum += v;
          squares += v * v;
        }
      const double mean = static_cast<double>(sum) / texels;
      out += 2 * (static_cast<double>(squares) / texels - mean * mean);
    }
    return std::max(out, 1e-3);
  }

  void show(std::size_t b, Shown what) {
    if (what == Shown::kBlock)
      landmarks_.appear(blocks_[b]);
    else
      landmarks_.vanish(blocks_[b]);
    const int x0 = columnOf(b) * block_, y0 = rowOf(b) * block_;
    for (int y = y0; y < std::min(y0 + block_, target_.height); ++y)
      for (int x = x0; x < std::min(x0 + block_, target_.width); ++x)
        if (!isKept(x, y))
          shown_[targetIndex(x, y)] =
              what == Shown::kNothing ? -1 : blocks_[b] + (y - y0) * source_.width + x - x0;
  }

  void move(std::size_t b, int sweep, double heat) {
    show(b, Shown::kNothing);
    findRim(b);
    countRepeats(b);
    landmarks_.takeOwed(repeats_);
    const std::uint64_t key = hashSeed(seed_, 0x6d, b, static_cast<std::uint64_t>(sweep));
    std::int32_t best = blocks_[b];
    double least = heat * uniform(key) + cost(best, std::numeric_limits<double>::max());
    // All places, or every n-th, others each time.
    const std::size_t step = (places_.size() + kPlacesMost - 1) / kPlacesMost;
    for (std::size_t i = uniformBelow(key, step); i < places_.size(); i += step) {
      const double noise = heat * uniform(hashSeed(key, i));
      const double its_cost = noise + cost(places_[i], least - noise);
      if (its_cost >= least) continue;
      least = its_cost;
      best = places_[i];
    }
    blocks_[b] = best;
    show(b, Shown::kBlock);
  }

  // `most` or more as soon as it is no less.
  double cost(std::int32_t place, double most) const {
    const double repeats = repeats_[static_cast<std::size_t>(place)];
    return repeats >= most ? most : repeats + mismatch(place, most - repeats);
  }

  void findRim(std::size_t b) {
    rim_.clear();
    const int x0 = columnOf(b) * block_, y0 = rowOf(b) * block_;
    for (int j = -kRimPx; j < block_ + kRimPx; ++j)
      for (int i = -kRimPx; i < block_ + kRimPx; ++i) {
        int x = x0 + i, y = y0 + j;
        if (wraps_) {
          x = (x + target_.width * kRimPx) % target_.width;
          y = (y + target_.height * kRimPx) % target_.height;
        }
        if (x < 0 || y < 0 || x >= target_.width || y >= target_.height) continue;
        const std::int32_t shown = shown_[targetIndex(x, y)];
        if (shown < 0) continue;
        rim_.push_back({i, j, (std::ptrdiff_t{j} * source_.width + i) * source_.channels,
                        source_.data + static_cast<std::ptrdiff_t>(shown) * source_.channels,
                        landmarks_.weight(static_cast<std::size_t>(shown))});
      }
  }

  double mismatch(std::int32_t place, double most) const {
    const int x = place % source_.width, y = place / source_.width;
    const bool inside = std::min(x, y) >= kRimPx && x + block_ + kRimPx <= source_.width &&
                        y + block_ + kRimPx <= source_.height;
    const std::int16_t* corner =
        source_.data + static_cast<std::ptrdiff_t>(place) * source_.channels;
    const double enough = most * mismatch_unit_ * static_cast<double>(rim_.size());
    double sum = 0;
    int count = 0;
    for (const Rim& rim : rim_) {
      if (!inside && (x + rim.x < 0 || y + rim.y < 0 || x + rim.x >= source_.width ||
                      y + rim.y >= source_.height))
        continue;
      const float weight =
          std::max(rim.weight, landmarks_.weight(sourceIndex(place, rim.x, rim.y)));
      sum += weight * squaredDifference(corner + rim.offset, rim.shown);
      if (++count % 16 == 0 && sum >= enough) return most;
    }
    return count == 0 ? 0 : sum / (count * mismatch_unit_);
  }

  std::int32_t squaredDifference(const std::int16_t* a, const std::int16_t* b) const {
    __m128i sum = _mm_setzero_si128();
    for (int c = 0; c < source_.channels; c += 4) {
      const __m128i off = _mm_sub_epi16(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(a + c)),
                                        _mm_loadl_epi64(reinterpret_cast<const __m128i*>(b + c)));
      sum = _mm_add_epi32(sum, _mm_madd_epi16(off, off));
    }
    return _mm_cvtsi128_si32(sum) + _mm_extract_epi32(sum, 1);
  }

  // For a block at each place of the source: how much of it others show, the nearer the more.
  void countRepeats(std::size_t b) {
    std::fill(repeats_.begin(), repeats_.end(), 0.0f);
    const int reach = (kernel_reach_ + block_) / block_ + 1;
    struct Range {
      int first, last;
    };
    const auto around = [&](int i, int count) {
      if (wraps_) return Range{std::max(-reach, -(count - 1) / 2), std::min(reach, count / 2)};
      return Range{std::max(-reach, -i), std::min(reach, count - 1 - i)};
    };
    const Range across = around(columnOf(b), columns_), down = around(rowOf(b), rows_);
    for (int r = down.first; r <= down.last; ++r)
      for (int c = across.first; c <= across.last; ++c) {
        if (r == 0 && c == 0) continue;
        const int row = (rowOf(b) + r + rows_) % rows_,
                  column = (columnOf(b) + c + columns_) % columns_;
        const int block = row * columns_ + column;
        addRepeats(blocks_[static_cast<std::size_t>(block)], c, r);
        landmarks_.addNear(blocks_[static_cast<std::size_t>(block)], c * block_, r * block_,
                           repeats_);
      }
  }

  // Of a block that shows `place`, so many blocks to the right and below.
  void addRepeats(std::int32_t place, int right, int below) {
    const int px = place % source_.width, py = place / source_.width, tx = right * block_,
              ty = below * block_;
    const auto at = [&](int x, int y) {
      return static_cast<std::size_t>(y) * static_cast<std::size_t>(source_.width) +
             static_cast<std::size_t>(x);
    };
    const int same_x = px - tx, same_y = py - ty;
    if (std::max(std::abs(right), std::abs(below)) >= 2 && same_x >= 0 && same_y >= 0 &&
        same_x < source_.width && same_y < source_.height)
      repeats_[at(same_x, same_y)] += static_cast<float>(kLongCopy);
    const int first_x = std::max({1 - block_, -px, -kernel_reach_ - tx}),
              last_x = std::min({block_ - 1, source_.width - 1 - px, kernel_reach_ - tx}),
              first_y = std::max({1 - block_, -py, -kernel_reach_ - ty}),
              last_y = std::min({block_ - 1, source_.height - 1 - py, kernel_reach_ - ty});
    const int side = 2 * kernel_reach_ + 1;
    for (int dy = first_y; dy <= last_y && first_x <= last_x; ++dy) {
      const int from = (dy + ty + kernel_reach_) * side + first_x + tx + kernel_reach_;
      const float* kernel = &kernel_[static_cast<std::size_t>(from)];
      float* to = &repeats_[at(px + first_x, py + dy)];
      const float share =
          static_cast<float>(block_ - std::abs(dy)) / static_cast<float>(block_ * block_);
      for (int dx = first_x; dx <= last_x; ++dx)
        *to++ += share * static_cast<float>(block_ - std::abs(dx)) * *kernel++;
    }
  }

  ImageView<const std::int16_t> source_;
  SizePx target_;
  bool wraps_;
  std::uint64_t seed_;
  int block_, columns_, rows_, kernel_reach_ = 0;
  std::vector<std::int32_t> kept_, shown_;  // [h][w] of the target
  std::vector<std::int32_t> places_;        // where in the source a block may lie: its first texel
  std::vector<std::int32_t> blocks_;        // the place that each shows
  std::vector<Rim> rim_;                    // of the block that moves
  LayoutLandmarks landmarks_;
  std::vector<float> kernel_, repeats_;  // repeats_: of the block that moves, by its place
  double mismatch_unit_ = 1;
};

}  // namespace

std::vector<std::int32_t> laidOut(ImageView<const std::int16_t> source, SizePx target,
                                  const LayoutLimits& limits, std::uint64_t seed,
                                  Progress& progress) {
  PATINA_CHECK(source.channels % 4 == 0 &&
               source.row_stride == std::ptrdiff_t{source.width} * source.channels &&
               (limits.kept.empty() || limits.kept.size() == texelsOf(target)));
  Layout layout(source, target, limits, seed);
  if (!layout.possible()) return {};
  return layout.run(progress);
}

}  // namespace patina::texture_optimization
