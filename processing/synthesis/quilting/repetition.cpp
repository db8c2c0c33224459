// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/synthesis/quilting/repetition.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

namespace patina::quilting {
namespace {

constexpr float kForbidden = std::numeric_limits<float>::infinity();
constexpr double kReachBlocks = 5;   // repetitions farther apart are not looked at
constexpr double kSideBySide = 2.0;  // blocks: closer is side by side, forbidden
constexpr double kEcho = 1.0;        // blocks: closer than that is a double image
constexpr double kShareSeen = 0.1;   // of a block that must come back to be seen as a repetition
constexpr double kFadeBlocks = 2.5;  // the penalty falls with distance

// The displacement between two places of a result that may wrap around: the shortest.
int shortest(int distance, int wrap) {
  if (wrap == 0) return distance;
  distance %= wrap;
  if (distance > wrap / 2) distance -= wrap;
  if (distance < -(wrap / 2)) distance += wrap;
  return distance;
}

double forbiddenWithin(Strictness strictness) {
  switch (strictness) {
    case Strictness::kNoNeighbour:
      return kSideBySide;
    case Strictness::kNoEcho:
      return kEcho;
    case Strictness::kPenaltyOnly:
      return 0;
  }
  return 0;
}

}  // namespace

RepetitionGuard::RepetitionGuard(SizePx corners, SizePx block, SizePx wrap, double penalty,
                                 int verbatim_blocks)
    : corners_(corners),
      block_(block),
      wrap_(wrap),
      penalty_(penalty),
      verbatim_blocks_(verbatim_blocks) {}

RepetitionGuard::Apart RepetitionGuard::apart(int x, int y, const PlacedBlock& other) const {
  return {shortest(x - other.x, wrap_.width), shortest(y - other.y, wrap_.height)};
}

Image<float> RepetitionGuard::weights(int x, int y, Strictness strictness) const {
  Image<float> weights(corners_.width, corners_.height, 1, 1.0f);
  for (const PlacedBlock& block : blocks_) {
    const Apart a = apart(x, y, block);
    if (std::abs(a.x) <= kReachBlocks * block_.width &&
        std::abs(a.y) <= kReachBlocks * block_.height)
      stamp(block, x, y, strictness, weights.view());
  }
  return weights;
}

// A corner c shows, `apart` from where `block` shows it, the part of the source both share.
void RepetitionGuard::stamp(const PlacedBlock& block, int x, int y, Strictness strictness,
                            ImageView<float> weights) const {
  const Apart a = apart(x, y, block);
  const double forbidden = forbiddenWithin(strictness);
  const int x0 = std::max(0, block.source_x - block_.width + 1),
            x1 = std::min(corners_.width, block.source_x + block_.width),
            y0 = std::max(0, block.source_y - block_.height + 1),
            y1 = std::min(corners_.height, block.source_y + block_.height);
  for (int cy = y0; cy < y1; ++cy)
    for (int cx = x0; cx < x1; ++cx) {
      const int dx = cx - block.source_x, dy = cy - block.source_y;
      const double share =
          (1 - std::abs(dx) / double(block_.width)) * (1 - std::abs(dy) / double(block_.height));
      float& weight = weights.at(cx, cy);
      if (dx == a.x && dy == a.y) {  // goes on with the same copy
        if (patch_blocks_[block.patch] >= verbatim_blocks_) weight = kForbidden;
        continue;
      }
      const double distance =
          std::hypot((a.x - dx) / double(block_.width), (a.y - dy) / double(block_.height));
      if (share > kShareSeen && distance < forbidden)
        weight = kForbidden;
      else
        weight += static_cast<float>(penalty_ * share *
                                     std::exp(-distance * distance / (kFadeBlocks * kFadeBlocks)));
    }
}

void RepetitionGuard::place(int x, int y, int source_x, int source_y) {
  PlacedBlock placed{x, y, source_x, source_y, static_cast<int>(patch_blocks_.size())};
  for (const PlacedBlock& other : blocks_) {
    const Apart a = apart(x, y, other);
    const bool touches = std::abs(a.x) <= block_.width && std::abs(a.y) <= block_.height;
    if (touches && source_x - other.source_x == a.x && source_y - other.source_y == a.y)
      placed.patch = other.patch;
  }
  if (placed.patch == static_cast<int>(patch_blocks_.size())) patch_blocks_.push_back(0);
  ++patch_blocks_[placed.patch];
  blocks_.push_back(placed);
}

}  // namespace patina::quilting
