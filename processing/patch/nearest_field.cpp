// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/patch/nearest_field.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <climits>
#include <cmath>

#include "processing/image/random.h"

namespace patina::patch {
namespace {

constexpr int kLanesMax = 8;  // whatever the number of threads: it is part of the result
constexpr int kTileMaxPx = 32, kTileMinPx = 4;
// At most this part of the target is in work at a time: at a thirty-second the energy is 5 %
// higher.
constexpr std::int64_t kInWorkShare = 128;

struct Step {
  int x, y;
};
constexpr std::array<Step, 8> kAround{
    {{-1, 0}, {0, -1}, {1, 0}, {0, 1}, {-1, -1}, {1, -1}, {1, 1}, {-1, 1}}};

}  // namespace

void FieldOptions::check() const {
  if (patch != 3 && patch != 5 && patch != 7)
    throw ProcessingError(Exit::kUsage,
                          "the patch is " + std::to_string(patch) + " texels; allowed: 3, 5, 7");
  if (!(uniformity >= 0 && uniformity <= 1e6))
    throw ProcessingError(Exit::kUsage, "uniformity is " + std::to_string(uniformity) +
                                            "; it lies between 0 and 1e6");
  if (similar.count < 1 || similar.count > 16)
    throw ProcessingError(Exit::kUsage, "similar patches are " + std::to_string(similar.count) +
                                            "; there are 1 to 16");
}

NearestField::NearestField(ImageView<const std::int16_t> source, double scale, SizePx target,
                           const FieldOptions& options)
    : source_(source),
      scale_(scale),
      target_size_(target),
      options_(options),
      reach_(options.patch / 2),
      distance_(patchDistance(options.patch, source.channels, simdPath())),
      target_(target.width + 2 * (options.patch / 2), target.height + 2 * (options.patch / 2),
              source.channels) {
  options.check();
  PATINA_CHECK(std::min(source.width, source.height) >= options.patch && target.width >= 1 &&
               target.height >= 1);
  const double texels = static_cast<double>(target.width) * target.height,
               source_texels = static_cast<double>(source.width) * source.height,
               even = texels / source_texels * options.patch * options.patch;
  penalty_scale_ = static_cast<float>(options.uniformity * scale * scale /
                                      (options.patch * options.patch * even));
  if (options.search == SearchKind::kCoherent)
    similar_.emplace_back(source, options.patch, options.similar);
  layLanes();
}

void NearestField::layLanes() {
  const std::int64_t in_work =
      std::int64_t{target_size_.width} * target_size_.height / kInWorkShare;
  tile_px_ = kTileMaxPx;
  while (tile_px_ > kTileMinPx && std::int64_t{kLanesMax} * tile_px_ * tile_px_ > in_work)
    tile_px_ /= 2;
  const auto lanes = static_cast<int>(
      std::clamp<std::int64_t>(in_work / (std::int64_t{tile_px_} * tile_px_), 1, kLanesMax));
  columns_ = (target_size_.width + tile_px_ - 1) / tile_px_;
  rows_ = (target_size_.height + tile_px_ - 1) / tile_px_;
  // Bands of two tiles at least: neighbours of a tile in work are then at rest.
  band_ = std::max(2, (columns_ + lanes - 1) / lanes);
  lanes_ = (columns_ + band_ - 1) / band_;
  changes_.resize(static_cast<std::size_t>(lanes_));
}

void NearestField::start(std::vector<std::int32_t> centres) {
  centres_ = std::move(centres);
  PATINA_CHECK(centres_.size() == static_cast<std::size_t>(target_size_.width) *
                                      static_cast<std::size_t>(target_size_.height));
  distances_.assign(centres_.size(), 0);
  Occupancy occupancy({source_.width, source_.height}, options_.patch);
  for (const std::int32_t centre : centres_)
    occupancy.add(centre % source_.width, centre / source_.width);
  occupancy_.assign(static_cast<std::size_t>(lanes_), occupancy);
}

void NearestField::voteTexel(int x, int y) {
  const int channels = source_.channels, width = target_size_.width, height = target_size_.height;
  std::array<std::int32_t, 16> sum{};
  int votes = 0;
  for (int dy = -reach_; dy <= reach_; ++dy)
    for (int dx = -reach_; dx <= reach_; ++dx) {
      if (x + dx < 0 || x + dx >= width || y + dy < 0 || y + dy >= height) continue;
      const std::int32_t centre = centres_[indexOf(x + dx, y + dy)];
      const std::int16_t* texel =
          &source_.at(centre % source_.width - dx, centre / source_.width - dy);
      for (int k = 0; k < channels; ++k) sum[static_cast<std::size_t>(k)] += texel[k];
      ++votes;
    }
  std::int16_t* to = &target_.at(x + reach_, y + reach_);
  const float share = 1.0f / static_cast<float>(votes);
  for (int k = 0; k < channels; ++k)
    to[k] = static_cast<std::int16_t>(
        std::lrintf(static_cast<float>(sum[static_cast<std::size_t>(k)]) * share));
}

void NearestField::padTarget() {
  const int width = target_.width(), height = target_.height(), channels = target_.channels();
  const ImageView<std::int16_t> view = target_.view();
  for (int y = reach_; y < height - reach_; ++y)
    for (int i = 0; i < reach_; ++i) {
      std::copy_n(&view.at(reach_, y), channels, &view.at(i, y));
      std::copy_n(&view.at(width - 1 - reach_, y), channels, &view.at(width - 1 - i, y));
    }
  for (int i = 0; i < reach_; ++i) {
    std::copy_n(view.row(reach_), view.row_stride, view.row(i));
    std::copy_n(view.row(height - 1 - reach_), view.row_stride, view.row(height - 1 - i));
  }
}

void NearestField::vote() {
  tbb::parallel_for(0, target_size_.height, [&](int y) {
    for (int x = 0; x < target_size_.width; ++x) voteTexel(x, y);
  });
  padTarget();
}

void NearestField::refreshDistances() {
  tbb::parallel_for(0, target_size_.height, [&](int y) {
    for (int x = 0; x < target_size_.width; ++x) {
      const std::size_t i = indexOf(x, y);
      distances_[i] = distance_(&target_.at(x, y), sourceCorner(centres_[i]),
                                target_.view().row_stride, source_.row_stride, INT_MAX);
    }
  });
}

NearestField::Tile NearestField::tileOf(int lane, int column, int row, bool forward) const {
  const int in_band = forward ? column : band_ - 1 - column, tx = lane * band_ + in_band,
            ty = forward ? row : rows_ - 1 - row;
  if (tx >= columns_) return {0, 0, 0, 0};
  return {tx * tile_px_, std::min(target_size_.width, (tx + 1) * tile_px_), ty * tile_px_,
          std::min(target_size_.height, (ty + 1) * tile_px_)};
}

void NearestField::search(int pass) {
  const bool forward = pass % 2 == 0;
  for (int row = 0; row < rows_; ++row)
    for (int column = 0; column < band_; ++column) {
      tbb::parallel_for(0, lanes_, [&](int lane) {
        changes_[static_cast<std::size_t>(lane)].clear();
        sweep(lane, tileOf(lane, column, row, forward), pass, forward);
      });
      tbb::parallel_for(0, lanes_, [&](int lane) {
        Occupancy& own = occupancy_[static_cast<std::size_t>(lane)];
        for (int other = 0; other < lanes_; ++other)
          if (other != lane)
            for (const Change& change : changes_[static_cast<std::size_t>(other)]) {
              own.add(change.to % source_.width, change.to / source_.width);
              own.remove(change.from % source_.width, change.from / source_.width);
            }
      });
    }
}

void NearestField::propose(std::int32_t centre, const std::int16_t* target, int lane,
                           Candidate& best) {
  if (centre == best.centre) return;
  Occupancy& occupancy = occupancy_[static_cast<std::size_t>(lane)];
  const std::int32_t bound = best.distance + best.penalty - penalty(occupancy, centre);
  if (bound <= 0) return;
  const std::int32_t distance =
      distance_(target, sourceCorner(centre), target_.view().row_stride, source_.row_stride, bound);
  if (distance >= bound) return;
  changes_[static_cast<std::size_t>(lane)].push_back({best.centre, centre});
  occupancy.add(centre % source_.width, centre / source_.width);
  occupancy.remove(best.centre % source_.width, best.centre / source_.width);
  best = {centre, distance, penalty(occupancy, centre)};
}

void NearestField::proposeSimilar(std::int32_t to, const std::int16_t* target, int lane,
                                  Candidate& best) {
  const std::int32_t* similar = similar_[0].of(to);
  for (int k = 0; k < similar_[0].count() && similar[k] >= 0; ++k)
    propose(similar[k], target, lane, best);
}

void NearestField::proposeNeighbour(int x, int y, int dx, int dy, const std::int16_t* target,
                                    int lane, Candidate& best, bool with_similar) {
  if (x + dx < 0 || x + dx >= target_size_.width || y + dy < 0 || y + dy >= target_size_.height)
    return;
  const std::int32_t shown = centres_[indexOf(x + dx, y + dy)];
  const int sx = shown % source_.width - dx, sy = shown / source_.width - dy;
  if (sx < reach_ || sx >= source_.width - reach_ || sy < reach_ || sy >= source_.height - reach_)
    return;
  const std::int32_t centre = sy * source_.width + sx;
  propose(centre, target, lane, best);
  if (with_similar) proposeSimilar(centre, target, lane, best);
}

void NearestField::proposeRandom(int x, int y, int pass, const std::int16_t* target, int lane,
                                 Candidate& best) {
  const int width = source_.width, height = source_.height;
  std::uint64_t key = hashSeed(options_.seed, static_cast<std::uint64_t>(pass),
                               static_cast<std::uint64_t>(x), static_cast<std::uint64_t>(y));
  const int sx = best.centre % width, sy = best.centre / width;
  for (int radius = 1; radius < 2 * std::max(width, height); radius *= 2) {
    const int x0 = std::max(sx - radius, reach_), x1 = std::min(sx + radius, width - 1 - reach_),
              y0 = std::max(sy - radius, reach_), y1 = std::min(sy + radius, height - 1 - reach_);
    key = mixBits(key);
    const int cx = x0 + static_cast<int>(
                            (key & 0xffffffff) * static_cast<std::uint64_t>(x1 - x0 + 1) >> 32),
              cy = y0 +
                   static_cast<int>((key >> 32) * static_cast<std::uint64_t>(y1 - y0 + 1) >> 32);
    propose(cy * width + cx, target, lane, best);
  }
}

void NearestField::sweep(int lane, const Tile& tile, int pass, bool forward) {
  const int step = forward ? 1 : -1;
  const Occupancy& occupancy = occupancy_[static_cast<std::size_t>(lane)];
  const auto turn = static_cast<std::size_t>(pass) * 2;
  for (int j = 0; j < tile.y1 - tile.y0; ++j)
    for (int i = 0; i < tile.x1 - tile.x0; ++i) {
      const int x = forward ? tile.x0 + i : tile.x1 - 1 - i,
                y = forward ? tile.y0 + j : tile.y1 - 1 - j;
      const std::size_t at = indexOf(x, y);
      const std::int16_t* target = &target_.at(x, y);
      Candidate best{centres_[at], distances_[at], penalty(occupancy, centres_[at])};
      proposeNeighbour(x, y, -step, 0, target, lane, best, false);
      proposeNeighbour(x, y, 0, -step, target, lane, best, false);
      if (options_.search == SearchKind::kCoherent) {
        // Two of the eight neighbours a pass, in turn; with what is similar to what they show.
        for (std::size_t n = 0; n < 2; ++n) {
          const Step around = kAround[(turn + n) % kAround.size()];
          proposeNeighbour(x, y, around.x, around.y, target, lane, best, true);
        }
        proposeSimilar(best.centre, target, lane, best);
      } else {
        proposeRandom(x, y, pass, target, lane, best);
      }
      centres_[at] = best.centre;
      distances_[at] = best.distance;
    }
}

FieldEnergy NearestField::energy() const {
  const double texels = static_cast<double>(target_size_.width) * target_size_.height,
               source_texels = static_cast<double>(source_.width) * source_.height,
               even = texels / source_texels * std::pow(options_.patch, 4);
  FieldEnergy energy;
  for (std::size_t i = 0; i < centres_.size(); ++i) {
    energy.patch += distances_[i];
    energy.occupancy += occupancy_[0].at(centres_[i] % source_.width, centres_[i] / source_.width);
  }
  energy.patch /= texels * scale_ * scale_;
  energy.occupancy /= texels * even;
  return energy;
}

}  // namespace patina::patch
