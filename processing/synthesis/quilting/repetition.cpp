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
constexpr double kSideBySidePenalty = 16;
constexpr double kFadeBlocks = 2.5;  // farther apart the penalty falls with distance
constexpr double kSameCopy = 0.2;    // blocks: closer is no repetition, but the same copy going on

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
                                 int verbatim_blocks)
    : corners_(corners),
      block_(block),
      wrap_(wrap),
      penalty_(penalty),
      verbatim_blocks_(verbatim_blocks),
      penalties_(static_cast<int>((kReachBlocks + 1) * block.width) + 1,
                 static_cast<int>((kReachBlocks + 1) * block.height) + 1, 1) {
  for (int dy = 0; dy < penalties_.height(); ++dy)
    for (int dx = 0; dx < penalties_.width(); ++dx) {
      const double d = std::hypot(dx / double(block.width), dy / double(block.height));
      const double faded = std::exp(-d * d / (kFadeBlocks * kFadeBlocks));
      penalties_.at(dx, dy) = static_cast<float>(
          d < kSameCopy ? -1 : penalty_ * (d < kSideBySide ? kSideBySidePenalty : faded));
    }
}

RepetitionGuard::Apart RepetitionGuard::apart(int x, int y, const PlacedBlock& other) const {
  return {shortest(x - other.x, wrap_.width), shortest(y - other.y, wrap_.height)};
}

Image<float> RepetitionGuard::weights(int x, int y) const {
  std::vector<std::pair<const PlacedBlock*, Apart>> near;
  for (const PlacedBlock& block : blocks_) {
    const Apart a = apart(x, y, block);
    if (std::abs(a.x) <= kReachBlocks * block_.width &&
        std::abs(a.y) <= kReachBlocks * block_.height)
      near.push_back({&block, a});
  }
  Image<float> weights(corners_.width, corners_.height, 1, 1.0f);
  if (!(penalty_ > 0)) return weights;
  const ImageView<float> view = weights.view();
  tbb::parallel_for(0, corners_.height, [&](int corner_y) {
    for (const auto& [block, a] : near) stampRow(*block, a, corner_y, view.row(corner_y));
  });
  return weights;
}

// A corner shows, `a` away from where `block` does, the part of the source that both share.
void RepetitionGuard::stampRow(const PlacedBlock& block, Apart a, int corner_y,
                               float* weights) const {
  const int dy = corner_y - block.source_y;
  if (std::abs(dy) >= block_.height) return;
  const float share_y = 1 - std::abs(dy) / static_cast<float>(block_.height);
  const float* penalties = penalties_.view().row(std::abs(a.y - dy));
  const bool copied_enough = patch_blocks_[block.patch] >= verbatim_blocks_;
  const int x0 = std::max(0, block.source_x - block_.width + 1),
            x1 = std::min(corners_.width, block.source_x + block_.width);
  for (int corner_x = x0; corner_x < x1; ++corner_x) {
    const int dx = corner_x - block.source_x;
    const float penalty = penalties[std::abs(a.x - dx)];
    if (penalty >= 0)
      weights[corner_x] +=
          penalty * share_y * (1 - std::abs(dx) / static_cast<float>(block_.width));
    else if (copied_enough)
      weights[corner_x] = kForbidden;
  }
}

void RepetitionGuard::place(int x, int y, int source_x, int source_y) {
  PlacedBlock placed{x, y, source_x, source_y, static_cast<int>(patch_blocks_.size())};
  for (const PlacedBlock& other : blocks_) {
    const Apart a = apart(x, y, other);
    const bool touches = std::abs(a.x) <= block_.width && std::abs(a.y) <= block_.height;
    const int shift_x = std::abs(a.x - (source_x - other.source_x)),
              shift_y = std::abs(a.y - (source_y - other.source_y));
    if (touches && shift_x < penalties_.width() && shift_y < penalties_.height() &&
        penalties_.at(shift_x, shift_y) < 0)
      placed.patch = other.patch;
  }
  if (placed.patch == static_cast<int>(patch_blocks_.size())) patch_blocks_.push_back(0);
  ++patch_blocks_[placed.patch];
  blocks_.push_back(placed);
}

}  // namespace patina::quilting
