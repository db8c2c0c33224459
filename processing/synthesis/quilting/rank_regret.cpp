// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/synthesis/quilting/rank_regret.h"

#include <algorithm>
#include <utility>

#include "processing/image/random.h"
#include "processing/patch/overlap_search.h"

namespace patina::quilting {
namespace {

Image<float> leading(ImageView<const float> features, int rank) {
  Image<float> out(features.width, features.height, rank);
  for (int y = 0; y < features.height; ++y)
    for (int x = 0; x < features.width; ++x)
      std::copy_n(features.texel(x, y).data(), rank, &out.at(x, y));
  return out;
}

}  // namespace

std::vector<Placement> drawPlacements(SizePx corners, int count, std::uint64_t seed) {
  std::vector<Placement> placements;
  for (int i = 0; i < count; ++i) {
    const auto draw = [&](int key, int below) {
      return static_cast<int>(uniformBelow(hashSeed(seed, i, key), below));
    };
    placements.push_back({{draw(1, corners.width), draw(2, corners.height)},
                          {draw(3, corners.width), draw(4, corners.height)}});
  }
  return placements;
}

std::vector<RankRegret> rankRegret(ImageView<const float> features, const std::vector<int>& ranks,
                                   SizePx block, SizePx overlap,
                                   const std::vector<Placement>& placements, Progress& progress) {
  Image<std::uint8_t> known(block.width, block.height, 1);
  for (int y = 0; y < block.height; ++y)
    for (int x = 0; x < block.width; ++x) known.at(x, y) = x < overlap.width || y < overlap.height;
  std::vector<Image<float>> targets;
  patch::OverlapSearch whole(features, block);
  std::vector<patch::Candidate> best;
  const auto overlapOf = [&](const Image<float>& target) {
    return patch::Overlap{target.view(), std::as_const(known).view()};
  };
  const std::size_t count = placements.size();
  progress.begin("regret", static_cast<std::int64_t>(count * (ranks.size() + 1)));
  for (const Placement& place : placements) {
    const auto blockFrom = [&](PointPx corner) {
      return copyOf(features.crop({corner.x, corner.y, block.width, block.height}));
    };
    Image<float> target = blockFrom(place.whole);
    const Image<float> left = blockFrom(place.left);
    for (int y = overlap.height; y < block.height; ++y)
      std::copy_n(left.view().row(y), overlap.width * features.channels, target.view().row(y));
    targets.push_back(std::move(target));
    best.push_back(whole.candidates(overlapOf(targets.back()), {0, 0, {}}).front());
    progress.step();
  }
  std::vector<RankRegret> result;
  for (int rank : ranks) {
    const Image<float> few = leading(features, rank);
    patch::OverlapSearch search(few.view(), block);
    RankRegret regret{rank, 0, 0};
    for (std::size_t i = 0; i < count; ++i) {
      const Image<float> target = leading(targets[i].view(), rank);
      const patch::Candidate chosen = search.candidates(overlapOf(target), {0, 0, {}}).front();
      const double cost = whole.squaredDistance(overlapOf(targets[i]), chosen.x, chosen.y);
      regret.mean += best[i].cost > 0 ? (cost - best[i].cost) / best[i].cost : 0;
      regret.choices.push_back({chosen.x, chosen.y});
      regret.same_share += chosen.x == best[i].x && chosen.y == best[i].y;
      progress.step();
    }
    regret.mean /= static_cast<double>(count);
    regret.same_share /= static_cast<double>(count);
    result.push_back(std::move(regret));
  }
  return result;
}

}  // namespace patina::quilting
