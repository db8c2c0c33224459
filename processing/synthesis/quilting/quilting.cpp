// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/synthesis/quilting/quilting.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "processing/image/random.h"
#include "processing/patch/overlap_search.h"
#include "processing/synthesis/quilting/block_groups.h"
#include "processing/synthesis/quilting/canvas.h"
#include "processing/synthesis/quilting/repetition.h"
#include "processing/synthesis/quilting/seam_statistics.h"
#include "processing/synthesis/quilting/time_warp.h"

namespace patina::quilting {
namespace {

constexpr std::int64_t kTexelsMost = 40'000'000;  // of the source: 60 bytes of features each
constexpr double kMore = 1 + 1e-9;  // so that no rounding ends an estimate at its limit
constexpr int kTries = 64;          // candidates whose seams are looked at
// How much liveliness counts for seams at first and at most; how lively their places should be
// against the rest, as features see it (as frames do, some 5 to 10 % more), and how near that is
// near enough; it rises by about so much with an exponent larger by 1.
constexpr double kLiveliness = 0.5, kLivelinessMost = 1.5, kSelectionWanted = 0.92,
                 kSelectionNear = 0.02, kSelectionSlope = 0.5;
constexpr int kRecuts = 4, kBlocksTuned = 5;

std::string text(SizePx s) { return std::to_string(s.width) + "x" + std::to_string(s.height); }

// Where blocks go along one side: every `step`, the last ones wherever they must lie to cover it.
std::vector<int> placesAlong(int length, int block, int overlap, bool wraps) {
  const int step = block - overlap;
  std::vector<int> places;
  if (wraps) {  // evenly, so that the last overlaps the first no less than any other
    const int count = std::max(1, (length + step - 1) / step);
    for (int i = 0; i < count; ++i)
      places.push_back(static_cast<int>(static_cast<std::int64_t>(i) * length / count));
    return places;
  }
  places.push_back(0);
  while (places.back() + block < length) places.push_back(places.back() + step);
  return places;
}

// Mean squared feature distance of a texel from its right neighbour: the scale on which a mismatch
// is large or small.
double neighbourDistance(ImageView<const float> features) {
  double sum = 0;
  std::int64_t pairs = 0;
  for (int y = 0; y < features.height; ++y)
    for (int x = 0; x + 1 < features.width; ++x, ++pairs) {
      const auto a = features.texel(x, y), b = features.texel(x + 1, y);
      for (std::size_t c = 0; c < a.size(); ++c) sum += (a[c] - b[c]) * (a[c] - b[c]);
    }
  return pairs ? sum / pairs : 0;
}

// The smallest part that blocks may come from: what one copy may span follows from it.
SizePx smallestOf(const std::vector<RectPx>& parts, SizePx source) {
  for (const RectPx& part : parts) {
    source.width = std::min(source.width, part.width);
    source.height = std::min(source.height, part.height);
  }
  return source;
}

// [corners]: 0 where a block would reach beyond the part that it begins in. Empty: all are allowed.
Image<std::uint8_t> allowedCorners(const std::vector<RectPx>& parts, SizePx corners, SizePx block) {
  if (parts.empty()) return {};
  Image<std::uint8_t> allowed(corners.width, corners.height, 1);
  for (const RectPx& part : parts)
    for (int y = part.y; y <= part.y + part.height - block.height; ++y)
      for (int x = part.x; x <= part.x + part.width - block.width; ++x) allowed.at(x, y) = 1;
  return allowed;
}

// Of the texels shown, those that come from a part.
double shareOf(const RectPx& part, ImageView<const std::int32_t> source_xy) {
  std::int64_t count = 0;
  for (int y = 0; y < source_xy.height; ++y)
    for (int x = 0; x < source_xy.width; ++x) {
      const auto from = source_xy.texel(x, y);
      count += from[0] >= part.x && from[0] < part.x + part.width && from[1] >= part.y &&
               from[1] < part.y + part.height;
    }
  return static_cast<double>(count) / (static_cast<double>(source_xy.width) * source_xy.height);
}

SizePx verbatimPx(SizePx source, double share) {
  return {static_cast<int>(share * source.width), static_cast<int>(share * source.height)};
}

class Quilter {
 public:
  Quilter(ImageView<const float> features, const QuiltingOptions& options, SizePx block,
          SizePx canvas, TimeWarps* warps, const SeamMetric* metric)
      : options_(options),
        block_(block),
        overlap_(options.overlapFor(block)),
        search_(features, block),
        guard_(search_.corners(), block, options.tile ? canvas : SizePx{},
               options.repetition_penalty,
               verbatimPx(smallestOf(options.parts, features.size()), options.verbatim)),
        allowed_(allowedCorners(options.parts, search_.corners(), block)),
        floor_per_texel_(0.05 * neighbourDistance(features)),
        canvas_(features, canvas, block, options.tile, warps, metric),
        warps_(warps) {
    if (options.keep.empty()) return;
    if (warps_) warps_->add();
    canvas_.keep(options.keep.view(), options.keep_from.x, options.keep_from.y, index_++);
  }

  void place(int x, int y) {
    const std::uint64_t draw = hashSeed(options_.seed, 0x7175696c74, index_);
    if (warps_) warps_->add();
    const patch::Candidate chosen = choose(draw, canvas_.look(x, y, index_), x, y);
    const patch::GridCut cut = canvas_.paste(chosen.x, chosen.y);
    ++index_;
    guard_.place(x, y, chosen.x, chosen.y);
    index_of_.push_back(index_ - 1);
    seam_cost_ += cut.cost;
    seam_edges_ += cut.cut_edges;
  }

  // All seams at once, by every block in turn, until none can be bettered. How much liveliness
  // counts is found first, on some blocks at the upper left: so that seams run neither through the
  // calm nor through the liveliest.
  void recut(ImageView<const float> features, Progress& progress) {
    if (options_.seam_sweeps == 0) return;
    const SizePx part{std::min(options_.size.width, kBlocksTuned * block_.width),
                      std::min(options_.size.height, kBlocksTuned * block_.height)};
    progress.begin("seams", kRecuts + options_.seam_sweeps);
    double exponent = kLiveliness, before = 0, selected_before = 0;
    for (int i = 0; i < kRecuts; ++i) {
      weighAnew(exponent);
      sweep(part);
      progress.step();
      const double selected = seamSelection(features, canvas_.cropped(part));
      if (std::abs(selected - kSelectionWanted) < kSelectionNear) break;
      const double slope = i > 0 && (selected - selected_before) * (exponent - before) > 0
                               ? (selected - selected_before) / (exponent - before)
                               : kSelectionSlope;
      selected_before = selected;
      before = std::exchange(exponent, std::clamp(exponent - (selected - kSelectionWanted) / slope,
                                                  0.0, kLivelinessMost));
      if (exponent == before) break;
    }
    if (exponent != liveliness_) weighAnew(exponent);
    for (int i = 0; i < options_.seam_sweeps; ++i) {
      const std::int64_t changed = sweep(options_.size);
      recut_ += changed;
      progress.step();
      if (changed == 0) break;
    }
  }

  QuiltResult finish(ImageView<const float> features) const {
    QuiltResult result{canvas_.cropped(options_.size), {}};
    result.report.texels_recut = recut_;
    result.report.blocks = static_cast<int>(index_of_.size());
    result.report.rank = features.channels;
    result.report.seam_cost_mean = seam_edges_ ? seam_cost_ / (2.0 * seam_edges_) : 0;
    for (const RectPx& part : options_.parts)
      result.report.part_shares.push_back(shareOf(part, result.quilt.source_xy.view()));
    result.report.seam_ratio = seamRatio(canvas_.shown(options_.size).view(), result.quilt);
    return result;
  }

 private:
  void weighAnew(double liveliness) {
    canvas_.setLiveliness(liveliness_ = liveliness);
    swept_.assign(index_of_.size(), kNever);
  }
  // Every block that begins within that part of the result, in the order in which they were laid;
  // those that do not meet at the same time. One about which nothing has changed since its last
  // turn could take nothing now. Returns how many texels changed.
  std::int64_t sweep(SizePx part) {
    std::vector<std::size_t> within;
    std::vector<PointPx> corners;
    for (std::size_t i = 0; i < index_of_.size(); ++i) {
      const PlacedBlock& b = guard_.blocks()[i];
      if (b.x >= part.width || b.y >= part.height) continue;
      within.push_back(i);
      corners.push_back({b.x, b.y});
    }
    std::atomic<std::int64_t> changed = 0;
    for (const auto& group :
         blockGroups(corners, block_, options_.tile ? options_.size : SizePx{})) {
      canvas_.setStep(++step_);
      tbb::parallel_for(std::size_t{0}, group.size(), [&](std::size_t i) {
        const std::size_t block = within[group[i]];
        const PlacedBlock& b = guard_.blocks()[block];
        if (swept_[block] == kNever || canvas_.isChangedSince(b.x, b.y, swept_[block]))
          changed += canvas_.expand(b.x, b.y, index_of_[block], b.source_x, b.source_y);
        swept_[block] = step_;
      });
    }
    return changed;
  }
  // Of some drawn from those that agree well all over the overlap, the one that joins best.
  patch::Candidate choose(std::uint64_t draw, const patch::Overlap& overlap, int x, int y) {
    const std::int64_t known = canvas_.knownTexels();
    if (options_.first && index_of_.empty()) return {options_.first->x, options_.first->y, 0};
    if (known == 0) return anyCorner(draw);
    Image<float> weights = guard_.weights(x, y);
    forbidCorners(weights);
    if (std::none_of(weights.texels().begin(), weights.texels().end(),
                     [](float w) { return std::isfinite(w); })) {  // a source hardly above a block
      std::fill(weights.texels().begin(), weights.texels().end(), 1.0f);
      forbidCorners(weights);
    }
    const std::vector<patch::Candidate> found = search_.candidates(
        overlap, {options_.tolerance, floor_per_texel_ * known, std::as_const(weights).view()});
    PATINA_CHECK(!found.empty());
    std::vector<patch::Candidate> tried;
    std::vector<bool> drawn(found.size());
    for (int i = 0; i < kTries; ++i) {
      const std::size_t one = uniformBelow(hashSeed(draw, i), found.size());
      if (!drawn[one]) tried.push_back(found[one]);
      drawn[one] = true;
    }
    const double floor = floor_per_texel_ * (block_.width + block_.height);
    std::atomic<double> least = std::numeric_limits<double>::infinity();
    tbb::parallel_for(std::size_t{0}, tried.size(), [&](std::size_t i) {
      patch::Candidate& c = tried[i];
      const double weight = weights.at(c.x, c.y), most = least.load() / weight * kMore - floor;
      c.cost = weight * (floor + canvas_.seamEstimate(c.x, c.y, overlap_, most));
      for (double best = least.load(); c.cost < best;)
        if (least.compare_exchange_weak(best, c.cost)) break;
    });
    return *std::min_element(tried.begin(), tried.end(),
                             [](const auto& a, const auto& b) { return a.cost < b.cost; });
  }

  patch::Candidate anyCorner(std::uint64_t draw) const {
    const SizePx corners = search_.corners();
    for (int i = 0;; ++i) {
      const patch::Candidate drawn{
          static_cast<int>(uniformBelow(hashSeed(draw, 2 * i + 1), corners.width)),
          static_cast<int>(uniformBelow(hashSeed(draw, 2 * i + 2), corners.height)), 0};
      if (allowed_.empty() || allowed_.at(drawn.x, drawn.y)) return drawn;
    }
  }
  void forbidCorners(Image<float>& weights) const {
    for (std::size_t i = 0; i < allowed_.texels().size(); ++i)
      if (!allowed_.texels()[i]) weights.texels()[i] = std::numeric_limits<float>::infinity();
  }

  const QuiltingOptions& options_;
  SizePx block_;
  SizePx overlap_;
  patch::OverlapSearch search_;
  RepetitionGuard guard_;
  Image<std::uint8_t> allowed_;
  double floor_per_texel_;
  Canvas canvas_;
  TimeWarps* warps_;
  int index_ = 0;
  std::vector<int> index_of_;  // each placed block's
  static constexpr int kNever = -1;
  double liveliness_ = 0;
  std::vector<int> swept_;  // each placed block's last step, with these weights
  int step_ = 0;
  std::int64_t recut_ = 0;
  double seam_cost_ = 0;
  std::int64_t seam_edges_ = 0;
};

[[noreturn]] void refuse(const std::string& field, const std::string& value,
                         const std::string& allowed) {
  throw ProcessingError(Exit::kUsage,
                        "quilting: " + field + " is " + value + "; allowed: " + allowed);
}

// What was given a place by hand lies within the source, of several the first.
void checkPlaces(const QuiltingOptions& options, SizePx source, SizePx block) {
  const auto text = [](int x, int y) { return std::to_string(x) + "," + std::to_string(y); };
  if (options.first && (options.first->x < 0 || options.first->y < 0 ||
                        options.first->x > source.width - block.width ||
                        options.first->y > source.height - block.height))
    refuse("first", text(options.first->x, options.first->y),
           "0,0 to " + text(source.width - block.width, source.height - block.height));
  const Image<std::uint8_t>& keep = options.keep;
  if (keep.empty()) return;
  if (keep.size() != options.size)
    refuse("the mask of what stays",
           std::to_string(keep.width()) + "x" + std::to_string(keep.height()), "the result's size");
  for (int y = 0; y < keep.height(); ++y)
    for (int x = 0; x < keep.width(); ++x) {
      const int u = x + options.keep_from.x, v = y + options.keep_from.y;
      if (keep.at(x, y) && (u < 0 || v < 0 || u >= source.width || v >= source.height))
        refuse("what stays at " + text(x, y), "the source's " + text(u, v),
               "what lies within the source");
    }
}

}  // namespace

SizePx QuiltingOptions::blockFor(SizePx source) const {
  if (block_px != SizePx{}) return block_px;
  source = smallestOf(parts, source);
  const int side = std::clamp(std::min(source.width, source.height) / 6, 24, 160);
  return {std::min(side, source.width), std::min(side, source.height)};
}

SizePx QuiltingOptions::overlapFor(SizePx block) const {
  if (overlap_px > 0) return {overlap_px, overlap_px};
  return {std::max(1, block.width * 2 / 5), std::max(1, block.height * 2 / 5)};
}

double QuiltingOptions::lowFrequencyFor(SizePx block) const {
  if (low_frequency_px > 0) return low_frequency_px;
  return std::max(2, std::min(block.width, block.height));
}

void QuiltingOptions::check(SizePx source) const {
  const auto within = [](double v, double low, double high) { return v >= low && v <= high; };
  if (size.width < 1 || size.height < 1 || size.width > 65535 || size.height > 65535)
    refuse("size", text(size), "1x1 to 65535x65535");
  if (static_cast<std::int64_t>(source.width) * source.height > kTexelsMost)
    throw ProcessingError(Exit::kUsage, "quilting: the sample is " + text(source) +
                                            "; at most 40 million texels can be compared: cut a "
                                            "part out of it (patina ttf build --roi)");
  const SizePx block = blockFor(source);
  const SizePx smallest = smallestOf(parts, source);
  if (block.width < 2 || block.height < 2 || block.width > smallest.width ||
      block.height > smallest.height)
    refuse("block_px", text(block),
           "2x2 to the source's " + text(smallest) + (parts.empty() ? "" : ", the smallest's"));
  for (const RectPx& p : parts)
    PATINA_CHECK(p.x >= 0 && p.y >= 0 && p.x + p.width <= source.width &&
                 p.y + p.height <= source.height);
  const int smaller = std::min(block.width, block.height);
  if (overlap_px < 0 || overlap_px > smaller / 2)
    refuse("overlap_px", std::to_string(overlap_px),
           "0 (two fifths of the block) to " + std::to_string(smaller / 2) + ", half the block");
  if (tile && (size.width < block.width || size.height < block.height))
    refuse("size", text(size), "at least one block of " + text(block) + " where it wraps around");
  if (seam_sweeps < 0 || seam_sweeps > 20)
    refuse("seam_sweeps", std::to_string(seam_sweeps), "0 to 20");
  if (svd_rank < 1 || svd_rank > 1000) refuse("svd_rank", std::to_string(svd_rank), "1 to 1000");
  if (rank_error && !(*rank_error > 0 && *rank_error < 1))
    refuse("rank_error", std::to_string(*rank_error), "above 0 and below 1");
  if (!within(tolerance, 0, 100)) refuse("tolerance", std::to_string(tolerance), "0 to 100");
  if (!within(repetition_penalty, 0, 1e6))
    refuse("repetition_penalty", std::to_string(repetition_penalty), "0 to 1000000");
  if (low_frequency_px != 0 && !within(low_frequency_px, 2, 65535))
    refuse("low_frequency_px", std::to_string(low_frequency_px), "0 (a block) or 2 to 65535");
  if (parts.size() > 1 && low_frequency != LowFrequencyUse::kKeep)
    refuse("low_frequency", "drop or restore",
           "keep where samples come from several sources: take it out of each first");
  if (tile && low_frequency == LowFrequencyUse::kRestore)
    refuse("low_frequency", "restore", "keep or drop where the result wraps around");
  checkPlaces(*this, parts.empty() ? source : SizePx{parts[0].width, parts[0].height}, block);
  if (!within(blend_px, 0, 256)) refuse("blend_px", std::to_string(blend_px), "0 to 256");
  if (!within(jitter_frames, 0, 10000))
    refuse("jitter_frames", std::to_string(jitter_frames), "0 to 10000");
  if (!within(jitter_event_frames, 0, 10000))
    refuse("jitter_event_frames", std::to_string(jitter_event_frames), "0 to 10000");
  if (!within(verbatim, 0, 1)) refuse("verbatim", std::to_string(verbatim), "0 to 1");
}

QuiltResult quilt(ImageView<const float> features, const QuiltingOptions& options,
                  Progress& progress, TimeWarps* warps, const SeamMetric* metric) {
  options.check(features.size());
  const SizePx block = options.blockFor(features.size());
  const SizePx overlap = options.overlapFor(block);
  const std::vector<int> across =
      placesAlong(options.size.width, block.width, overlap.width, options.tile);
  const std::vector<int> down =
      placesAlong(options.size.height, block.height, overlap.height, options.tile);
  const SizePx canvas =
      options.tile ? options.size : SizePx{across.back() + block.width, down.back() + block.height};
  progress.begin("quilting", static_cast<std::int64_t>(across.size() * down.size()));
  Quilter quilter(features, options, block, canvas, warps, metric);
  for (int y : down)
    for (int x : across) {
      quilter.place(x, y);
      progress.step();
    }
  quilter.recut(features, progress);
  return quilter.finish(features);
}

}  // namespace patina::quilting
