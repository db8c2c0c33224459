// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/synthesis/quilting/repetition.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <utility>

namespace patina::quilting {
namespace {

constexpr float kForbidden = std::numeric_limits<float>::infinity();
constexpr double kReachBlocks = 5;   // repetitions farther apart are not looked at
constexpr double kSideBySide = 2.0;  // blocks: closer is side by side
constexpr double kSideBySidePenalty = 5;
constexpr double kFarPenalty = 0.3;  // farther apart, falling with distance
constexpr double kFadeBlocks = 2.5;
constexpr double kSameCopy = 0.2;  // blocks: closer is no repetition, but the same copy going on

// The displacement between two places of a result that may wrap around: the shortest.
int shortest(int distance, int wrap) {
  if (wrap == 0) return distance;
  distance %= wrap;
  if (distance > wrap / 2) distance -= wrap;
  if (distance < -(wrap / 2)) distance += wrap;
  return distance;
}

}  // namespace

RepetitionGuard::RepetitionGuard(SizePx corners, SizePx block, SizePx wrap, double penalty,
                                 SizePx verbatim)
    : corners_(corners),
      block_(block),
      wrap_(wrap),
      penalty_(penalty),
      verbatim_(verbatim),
      reach_x_(static_cast<int>((kReachBlocks + 1) * block.width)),
      penalties_(2 * reach_x_ + 1, static_cast<int>((kReachBlocks + 1) * block.height) + 1, 1),
      same_(penalties_.width(), penalties_.height(), 1) {
  for (int dy = 0; dy < penalties_.height(); ++dy)
    for (int dx = -reach_x_; dx <= reach_x_; ++dx) {
      const double d = std::hypot(dx / double(block.width), dy / double(block.height));
      const double faded = kFarPenalty * std::exp(-d * d / (kFadeBlocks * kFadeBlocks));
      same_.at(reach_x_ + dx, dy) = d < kSameCopy;
      if (d >= kSameCopy)
        penalties_.at(reach_x_ + dx, dy) =
            static_cast<float>(penalty_ * (d < kSideBySide ? kSideBySidePenalty : faded));
    }
  for (int dx = 1 - block.width; dx < block.width; ++dx)
    shares_x_.push_back(1 - std::abs(dx) / static_cast<float>(block.width));
}

RepetitionGuard::Apart RepetitionGuard::apart(int x, int y, const PlacedBlock& other) const {
  return {shortest(x - other.x, wrap_.width), shortest(y - other.y, wrap_.height)};
}

bool RepetitionGuard::isTouching(Apart a) const {
  return std::abs(a.x) <= block_.width && std::abs(a.y) <= block_.height;
}

// Of a patch and a block at (x,y) beside it; where the result wraps, on the block's side.
RectPx RepetitionGuard::boundsWith(int patch, int x, int y) const {
  const RectPx& p = patches_[patch];
  const int px = x - shortest(x - p.x, wrap_.width), py = y - shortest(y - p.y, wrap_.height);
  const int x0 = std::min(x, px), y0 = std::min(y, py);
  return {x0, y0, std::max(x + block_.width, px + p.width) - x0,
          std::max(y + block_.height, py + p.height) - y0};
}

Image<float> RepetitionGuard::weights(int x, int y) const {
  struct Near {
    const PlacedBlock* block;
    Apart apart;
    bool copied_enough;
  };
  std::vector<Near> near;
  for (const PlacedBlock& block : blocks_) {
    const Apart a = apart(x, y, block);
    if (std::abs(a.x) > kReachBlocks * block_.width || std::abs(a.y) > kReachBlocks * block_.height)
      continue;
    const RectPx bounds = boundsWith(block.patch, x, y);
    near.push_back({&block, a, bounds.width > verbatim_.width || bounds.height > verbatim_.height});
  }
  Image<float> weights(corners_.width, corners_.height, 1, 1.0f);
  if (!(penalty_ > 0)) return weights;
  const ImageView<float> view = weights.view();
  tbb::parallel_for(0, corners_.height, [&](int corner_y) {
    for (const Near& n : near)
      stampRow(*n.block, n.apart, n.copied_enough, corner_y, view.row(corner_y));
  });
  return weights;
}

// A corner shows, `a` away from where `block` does, the part of the source that both share.
void RepetitionGuard::stampRow(const PlacedBlock& block, Apart a, bool copied_enough, int corner_y,
                               float* weights) const {
  const int dy = corner_y - block.source_y;
  if (std::abs(dy) >= block_.height) return;
  const float share_y = 1 - std::abs(dy) / static_cast<float>(block_.height);
  const int x0 = std::max(0, block.source_x - block_.width + 1),
            x1 = std::min(corners_.width, block.source_x + block_.width);
  // From the first corner on, all rise with it.
  const int first = x0 - block.source_x, at = reach_x_ + first - a.x;
  const float *penalties = penalties_.view().row(std::abs(a.y - dy)) + at,
              *shares = shares_x_.data() + (first + block_.width - 1);
  weights += x0;
  for (int i = 0; i < x1 - x0; ++i) weights[i] += penalties[i] * share_y * shares[i];
  if (!copied_enough) return;
  const std::uint8_t* same = same_.view().row(std::abs(a.y - dy)) + at;
  for (int i = 0; i < x1 - x0; ++i)
    if (same[i]) weights[i] = kForbidden;
}

void RepetitionGuard::place(int x, int y, int source_x, int source_y) {
  PlacedBlock placed{x, y, source_x, source_y, static_cast<int>(patches_.size())};
  for (const PlacedBlock& other : blocks_) {
    const Apart a = apart(x, y, other);
    const int shift_x = std::abs(a.x - (source_x - other.source_x)),
              shift_y = std::abs(a.y - (source_y - other.source_y));
    if (isTouching(a) && shift_x <= reach_x_ && shift_y < same_.height() &&
        same_.at(reach_x_ + shift_x, shift_y))
      placed.patch = other.patch;
  }
  if (placed.patch == static_cast<int>(patches_.size()))
    patches_.push_back({x, y, block_.width, block_.height});
  patches_[placed.patch] = boundsWith(placed.patch, x, y);
  blocks_.push_back(placed);
}

}  // namespace patina::quilting
