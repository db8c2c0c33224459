// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/patch/nearest_field.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <climits>
#include <cmath>

#include "processing/image/parallel_rows.h"
#include "processing/image/random.h"
#include "processing/patch/usable_patches.h"

namespace patina::patch {
namespace {

// Of the penalty of even use: a candidate that is better by less is not worth a change, which wakes
// its neighbours. Half of all changes were; without them the energy is no higher.
constexpr double kLeastGain = 1.0 / 64;
constexpr std::int32_t kGivesWay = INT_MAX / 2;  // distance of what the labels refuse
constexpr int kPassesAwake = 4;                  // in which all eight neighbours have their turn

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
  if (similar.count < 1 || similar.count > 16 || similar.trees < 1 || similar.trees > 16)
    throw ProcessingError(Exit::kUsage, "similar patches are " + std::to_string(similar.count) +
                                            " from " + std::to_string(similar.trees) +
                                            " trees; there are 1 to 16 of both");
}

NearestField::NearestField(ImageView<const std::int16_t> source, double scale, SizePx target,
                           const FieldOptions& options, const FieldLimits& limits)
    : source_(source),
      scale_(scale),
      target_size_(target),
      options_(options),
      reach_(options.patch / 2),
      kept_(limits.kept.begin(), limits.kept.end()),
      labels_(limits.labels == nullptr ? Labels{} : *limits.labels),
      leading_(source, target, options.patch, limits.guide),
      wakefulness_(target, options.wraps, kPassesAwake),
      order_(target, options.wraps) {
  options.check();
  PATINA_CHECK(
      std::min(source.width, source.height) >= options.patch &&
      std::min(target.width, target.height) >= 1 &&
      (kept_.empty() || kept_.size() == indexOf(0, target.height)) &&
      (labels_.of_source.empty() || (labels_.source == source.size() && labels_.target == target)));
  const double texels = static_cast<double>(target.width) * target.height,
               source_texels = static_cast<double>(source.width) * source.height,
               even = texels / source_texels * options.patch * options.patch;
  penalty_scale_ = static_cast<float>(options.uniformity * scale * scale /
                                      (options.patch * options.patch * even));
  least_gain_ =
      static_cast<std::int32_t>(std::min(kLeastGain * options.uniformity * scale * scale, 1e9));
  usable_ = usablePatches(limits.usable, source.size(), options.patch);
  for (const FurtherComponents& more : limits.further) {
    PATINA_CHECK(more.source.size() == source.size());
    further_.emplace_back(more.source, target, options.patch, more.guide);
  }
  if (options.search == SearchKind::kCoherent && limits.coarse != nullptr)
    similar_.emplace_back(limits.coarse->similar_[0], limits.coarse->source_.size(), source.size(),
                          options.patch, usable_);
  else if (options.search == SearchKind::kCoherent)
    similar_.emplace_back(source, options.patch, usable_, options.similar);
}

void NearestField::start(std::vector<std::int32_t> centres) {
  centres_ = std::move(centres);
  PATINA_CHECK(centres_.size() == indexOf(0, target_size_.height));
  std::vector<std::int32_t> places;
  for (std::size_t i = 0; i < usable_.size(); ++i)
    if (usable_[i] != 0) places.push_back(static_cast<std::int32_t>(i));
  for (std::size_t i = 0; i < centres_.size(); ++i) {
    if (fixed(i)) centres_[i] = kept_[i];
    if (usable_[static_cast<std::size_t>(centres_[i])] == 0)
      centres_[i] = places[uniformBelow(hashSeed(options_.seed, i), places.size())];
  }
  distances_.assign(centres_.size(), 0);
  refused_.clear();
  for (std::size_t i = 0; i < centres_.size() && !labels_.of_source.empty(); ++i)
    refused_.push_back(labels_.refuse(centres_[i], i));
  Occupancy occupancy(source_.size(), options_.patch);
  occupancy.addAll(centres_);
  lanes_.clear();
  for (int lane = 0; lane < order_.count(); ++lane)
    lanes_.push_back({.occupancy = occupancy, .changes = {}});
  wakefulness_.wakeAll();
  for (std::size_t i = 0; i < centres_.size(); ++i) wakefulness_.noteChange(i);
}

void NearestField::wakeSeams() {
  const int width = target_size_.width, height = target_size_.height;
  std::vector<std::uint8_t> seams(centres_.size(), 0);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (const Step after : {Step{1, 0}, Step{0, 1}}) {
        const std::int32_t at = neighbour(x + after.x, y + after.y);
        const std::size_t here = indexOf(x, y);
        if (at < 0 || centres_[static_cast<std::size_t>(at)] ==
                          centres_[here] + after.y * source_.width + after.x)
          continue;
        seams[here] = 1;
        seams[static_cast<std::size_t>(at)] = 1;
      }
  for (std::size_t i = 0; i < refused_.size(); ++i)
    if (refused_[i] != 0) seams[i] = 1;
  wakefulness_.wakeOnly(seams);
}

Votes NearestField::votes() const {
  return {centres_, target_size_, source_.width, reach_, options_.wraps, kept_};
}

void NearestField::vote() {
  const Votes all = votes();
  const std::vector<std::uint8_t> texels = wakefulness_.takeChangesWithin(reach_),
                                  patches = wakefulness_.spread(texels, reach_);
  constexpr std::int64_t kCostTexel = 30;
  forEachRow(target_size_.height, kCostTexel * target_size_.width, [&](int y) {
    for (int x = 0; x < target_size_.width; ++x)
      if (texels[indexOf(x, y)] != 0) {
        leading_.vote(all, x, y);
        for (PatchComponents& more : further_) more.vote(all, x, y);
      }
  });
  leading_.pad(options_.wraps);
  for (PatchComponents& more : further_) more.pad(options_.wraps);
  forEachRow(target_size_.height, kCostTexel * target_size_.width, [&](int y) {
    for (int x = 0; x < target_size_.width; ++x) {
      const std::size_t i = indexOf(x, y);
      if (patches[i] != 0)
        distances_[i] = further(leading_.distance(leading_.patchAt(x, y), centres_[i], INT_MAX), x,
                                y, centres_[i], INT_MAX);
    }
  });
}

void NearestField::search(int pass) {
  const bool forward = pass % 2 == 0;
  if (options_.search == SearchKind::kPatchMatch) wakefulness_.wakeAll();
  wakefulness_.beginPass();
  for (int step = 0; step < order_.steps(); ++step)
    tbb::parallel_for(0, order_.count(), [&](int lane) {
      takeOver(lane, step - 1);
      sweep(lane, step, pass, forward);
    });
  tbb::parallel_for(0, order_.count(), [&](int lane) { takeOver(lane, order_.steps() - 1); });
}

void NearestField::Lane::take(const Change& change) {
  occupancy.add(change.to);
  occupancy.remove(change.from);
}

void NearestField::takeOver(int lane, int step) {
  if (step < 0) return;
  for (int other = 0; other < order_.count(); ++other)
    if (other != lane)
      for (const Change& change : lanes_[static_cast<std::size_t>(other)].changes[step % 2])
        lanes_[static_cast<std::size_t>(lane)].take(change);
}

void NearestField::sweep(int lane, int step, int pass, bool forward) {
  const Tile tile = order_.tile(lane, step, forward);
  Lane& own = lanes_[static_cast<std::size_t>(lane)];
  std::vector<Change>& changes = own.changes[step % 2];
  changes.clear();
  const int ahead = forward ? 1 : -1, width = target_size_.width;
  for (int j = 0; j < tile.y1 - tile.y0; ++j)
    for (int i = 0; i < tile.x1 - tile.x0; ++i) {
      const int x = forward ? tile.x0 + i : tile.x1 - 1 - i,
                y = forward ? tile.y0 + j : tile.y1 - 1 - j;
      const std::size_t at = indexOf(x, y);
      const int left = x - ahead, up = y - ahead;
      const bool moved =
          (left >= 0 && left < width && wakefulness_.changedNow(indexOf(left, y))) ||
          (up >= 0 && up < target_size_.height && wakefulness_.changedNow(indexOf(x, up)));
      if (!moved && !wakefulness_.awake(at)) continue;
      if (fixed(at)) continue;
      const std::int32_t before = centres_[at];
      judge(own, x, y, pass, ahead);
      if (centres_[at] == before) continue;
      wakefulness_.noteChange(at);
      changes.push_back({before, centres_[at]});
      own.take(changes.back());
    }
}

std::int32_t NearestField::neighbour(int x, int y) const {
  const int width = target_size_.width, height = target_size_.height;
  if (options_.wraps) {
    x = x < 0 ? x + width : x >= width ? x - width : x;
    y = y < 0 ? y + height : y >= height ? y - height : y;
  } else if (x < 0 || x >= width || y < 0 || y >= height) {
    return -1;
  }
  return static_cast<std::int32_t>(indexOf(x, y));
}

std::int32_t NearestField::further(std::int32_t distance, int x, int y, std::int32_t centre,
                                   std::int32_t bound) const {
  for (const PatchComponents& more : further_) {
    if (distance >= bound) break;
    distance += more.distance(more.patchAt(x, y), centre, bound - distance);
  }
  return distance;
}

struct NearestField::Judge {
  NearestField& field;
  const Occupancy& occupancy;
  int x, y;
  const std::int16_t* target;
  Candidate best;

  std::int32_t penalty(std::int32_t centre) const {
    return static_cast<std::int32_t>(field.penalty_scale_ *
                                     static_cast<float>(occupancy.at(centre)));
  }
  [[gnu::always_inline]] inline void propose(std::int32_t centre) {
    if (centre == best.centre) return;
    const std::int32_t its_penalty = penalty(centre),
                       bound = best.distance + best.penalty - its_penalty - field.least_gain_;
    if (bound <= 0) return;
    std::int32_t distance = field.leading_.distance(target, centre, bound);
    if (distance >= bound) return;
    distance = field.further(distance, x, y, centre, bound);
    if (distance < bound && !field.labels_.refuse(centre, field.indexOf(x, y)))
      best = {centre, distance, its_penalty};
  }
  // Candidates lie anywhere in the source: asked for before the neighbours' are judged.
  void fetchSimilar(std::int32_t to) const {
    const SimilarPatches& similar = field.similar_[0];
    const std::int32_t* at = similar.of(to);
    for (int k = 0; k < similar.count() && at[k] >= 0; ++k) {
      occupancy.fetch(at[k]);
      __builtin_prefetch(field.leading_.sourcePatch(at[k]));
      __builtin_prefetch(field.leading_.sourcePatch(at[k] + field.source_.width));
    }
  }
  void proposeSimilar(std::int32_t to) {
    const SimilarPatches& similar = field.similar_[0];
    const std::int32_t* at = similar.of(to);
    for (int k = 0; k < similar.count() && at[k] >= 0; ++k) propose(at[k]);
  }
  // What the patch at (dx, dy) shows, moved along; -1 where there is none.
  std::int32_t continued(Step d) const {
    const std::int32_t at = field.neighbour(x + d.x, y + d.y);
    if (at < 0) return -1;
    const std::int32_t centre =
        field.centres_[static_cast<std::size_t>(at)] - d.y * field.source_.width - d.x;
    return field.usable_[static_cast<std::size_t>(centre)] != 0 ? centre : -1;
  }
  void proposeRandom(std::uint64_t key) {
    const int width = field.source_.width, height = field.source_.height, reach = field.reach_;
    const int sx = best.centre % width, sy = best.centre / width;
    for (int radius = 1; radius < 2 * std::max(width, height); radius *= 2) {
      const int x0 = std::max(sx - radius, reach), x1 = std::min(sx + radius, width - 1 - reach),
                y0 = std::max(sy - radius, reach), y1 = std::min(sy + radius, height - 1 - reach);
      key = mixBits(key);
      const auto cx = x0 + static_cast<int>(
                               (key & 0xffffffff) * static_cast<std::uint64_t>(x1 - x0 + 1) >> 32),
                 cy = y0 +
                      static_cast<int>((key >> 32) * static_cast<std::uint64_t>(y1 - y0 + 1) >> 32);
      const std::int32_t centre = cy * width + cx;
      if (field.usable_[static_cast<std::size_t>(centre)] != 0) propose(centre);
    }
  }
};

void NearestField::judge(const Lane& lane, int x, int y, int pass, int ahead) {
  const std::size_t at = indexOf(x, y);
  Judge judge{*this, lane.occupancy,         x,
              y,     leading_.patchAt(x, y), {centres_[at], distances_[at], 0}};
  const bool refused = !refused_.empty() && refused_[at] != 0;
  if (refused) judge.best.distance = kGivesWay;
  judge.best.penalty = judge.penalty(centres_[at]);
  if (!similar_.empty()) judge.fetchSimilar(centres_[at]);
  for (const Step before : {Step{-ahead, 0}, Step{0, -ahead}})
    if (const std::int32_t centre = judge.continued(before); centre >= 0) judge.propose(centre);
  if (options_.search == SearchKind::kCoherent) {
    // Two of the eight neighbours a pass, in turn; with what is similar to what they show.
    for (std::size_t n = 0; n < 2; ++n) {
      const Step around = kAround[(static_cast<std::size_t>(pass) * 2 + n) % kAround.size()];
      const std::int32_t centre = judge.continued(around);
      if (centre < 0) continue;
      judge.propose(centre);
      // What is similar to what stays has been judged.
      if (centre != judge.best.centre && wakefulness_.changedLately(static_cast<std::size_t>(
                                             neighbour(x + around.x, y + around.y))))
        judge.proposeSimilar(centre);
    }
    if (judge.best.centre != centres_[at] || wakefulness_.changedLately(at))
      judge.proposeSimilar(judge.best.centre);
  } else {
    judge.proposeRandom(hashSeed(options_.seed, static_cast<std::uint64_t>(pass),
                                 static_cast<std::uint64_t>(x), static_cast<std::uint64_t>(y)));
  }
  if (refused && judge.best.centre != centres_[at]) refused_[at] = 0;
  centres_[at] = judge.best.centre;
  if (judge.best.distance != kGivesWay) distances_[at] = judge.best.distance;
}

FieldEnergy NearestField::energy() const {
  const double texels = static_cast<double>(target_size_.width) * target_size_.height,
               source_texels = static_cast<double>(source_.width) * source_.height,
               even = texels / source_texels * std::pow(options_.patch, 4);
  FieldEnergy energy;
  for (std::size_t i = 0; i < centres_.size(); ++i) {
    energy.patch += distances_[i];
    energy.occupancy += lanes_[0].occupancy.at(centres_[i]);
  }
  energy.patch /= texels * scale_ * scale_;
  energy.occupancy /= texels * even;
  return energy;
}

}  // namespace patina::patch
