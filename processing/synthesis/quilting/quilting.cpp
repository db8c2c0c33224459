// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/synthesis/quilting/quilting.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "processing/image/random.h"
#include "processing/patch/grid_cut.h"
#include "processing/patch/overlap_search.h"
#include "processing/synthesis/quilting/repetition.h"
#include "processing/synthesis/quilting/seam_statistics.h"

namespace patina::quilting {
namespace {

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

// The result while it is being covered, at least as large as asked for.
class Canvas {
 public:
  Canvas(ImageView<const float> features, SizePx size, SizePx block, bool wraps)
      : features_(features),
        block_(block),
        size_(size),
        wraps_(wraps),
        source_(size.width, size.height, 2, -1),
        index_(size.width, size.height, 1, -1),
        target(block.width, block.height, features.channels),
        known(block.width, block.height, 1) {}

  // Fills `target` and `known` with what lies under a block at (x0,y0).
  void look(int x0, int y0) {
    for (int j = 0; j < block_.height; ++j)
      for (int i = 0; i < block_.width; ++i) {
        const auto source = sourceAt(x0 + i, y0 + j);
        known.at(i, j) = source[0] >= 0;
        if (source[0] < 0) continue;
        const auto from = features_.texel(source[0], source[1]);
        std::copy(from.begin(), from.end(), target.view().texel(i, j).begin());
      }
  }

  // Lays source block (sx,sy) over (x0,y0), cut where it differs least; look() came before.
  patch::GridCut paste(int x0, int y0, int sx, int sy, int index) {
    Image<double> difference(block_.width, block_.height, 1, -1.0);
    Image<patch::Side> side(block_.width, block_.height, 1, patch::Side::kNew);
    for (int j = 0; j < block_.height; ++j)
      for (int i = 0; i < block_.width; ++i) {
        if (!known.at(i, j)) continue;
        const auto a = target.view().texel(i, j);
        const auto b = features_.texel(sx + i, sy + j);
        double squares = 0;
        for (std::size_t c = 0; c < a.size(); ++c) squares += (a[c] - b[c]) * (a[c] - b[c]);
        difference.at(i, j) = squares;
        side.at(i, j) = bordersOld(x0, y0, i, j) ? patch::Side::kOld : patch::Side::kFree;
      }
    patch::GridCut cut =
        patch::minimumCut(std::as_const(difference).view(), std::as_const(side).view());
    for (int j = 0; j < block_.height; ++j)
      for (int i = 0; i < block_.width; ++i) {
        if (!cut.take_new.at(i, j)) continue;
        const auto to = sourceAt(x0 + i, y0 + j);
        to[0] = sx + i;
        to[1] = sy + j;
        index_.at(wrapped(x0 + i, size_.width), wrapped(y0 + j, size_.height)) = index;
      }
    return cut;
  }

  Quilt cropped(SizePx size) const {
    const RectPx rect{0, 0, size.width, size.height};
    return {copyOf(source_.view().crop(rect)), copyOf(index_.view().crop(rect))};
  }

 private:
  int wrapped(int v, int length) const { return wraps_ ? (v % length + length) % length : v; }
  std::span<std::int32_t> sourceAt(int x, int y) {
    return source_.view().texel(wrapped(x, size_.width), wrapped(y, size_.height));
  }
  // A texel beside old ones outside of the block: they stay, so it must go with them.
  bool bordersOld(int x0, int y0, int i, int j) {
    const auto oldOutside = [&](int di, int dj) {
      const int x = x0 + i + di, y = y0 + j + dj;
      const bool within =
          i + di >= 0 && i + di < block_.width && j + dj >= 0 && j + dj < block_.height;
      const bool on_canvas = wraps_ || (x >= 0 && x < size_.width && y >= 0 && y < size_.height);
      return !within && on_canvas && sourceAt(x, y)[0] >= 0;
    };
    return oldOutside(-1, 0) || oldOutside(1, 0) || oldOutside(0, -1) || oldOutside(0, 1);
  }

  ImageView<const float> features_;
  SizePx block_, size_;
  bool wraps_;
  Image<std::int32_t> source_, index_;

 public:
  Image<float> target;
  Image<std::uint8_t> known;
};

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

class Quilter {
 public:
  Quilter(ImageView<const float> features, const QuiltingOptions& options, SizePx canvas)
      : options_(options),
        search_(features, options.block_px),
        guard_(search_.corners(), options.block_px, options.tile ? canvas : SizePx{},
               options.repetition_penalty, options.verbatim_blocks),
        floor_per_texel_(0.05 * neighbourDistance(features)),
        canvas_(features, canvas, options.block_px, options.tile) {}

  void place(int x, int y) {
    canvas_.look(x, y);
    const int index = static_cast<int>(guard_.blocks().size());
    const patch::Candidate chosen = choose(x, y, index);
    const patch::GridCut cut = canvas_.paste(x, y, chosen.x, chosen.y, index);
    guard_.place(x, y, chosen.x, chosen.y);
    seam_cost_ += cut.cost;
    seam_edges_ += cut.cut_edges;
  }

  QuiltResult finish(ImageView<const float> features) const {
    QuiltResult result{canvas_.cropped(options_.size), {}};
    result.report.blocks = static_cast<int>(guard_.blocks().size());
    result.report.rank = features.channels;
    result.report.seam_cost_mean = seam_edges_ ? seam_cost_ / (2.0 * seam_edges_) : 0;
    result.report.seam_ratio = seamRatio(features, result.quilt);
    return result;
  }

 private:
  patch::Candidate choose(int x, int y, int index) {
    const std::uint64_t draw = hashSeed(options_.seed, 0x7175696c74, index);
    const auto known = std::count(canvas_.known.texels().begin(), canvas_.known.texels().end(), 1);
    if (known == 0)
      return {static_cast<int>(uniformBelow(hashSeed(draw, 1), search_.corners().width)),
              static_cast<int>(uniformBelow(hashSeed(draw, 2), search_.corners().height)), 0};
    const Image<float> weights = weightsFor(x, y);
    const std::vector<patch::Candidate> found = search_.candidates(
        {std::as_const(canvas_.target).view(), std::as_const(canvas_.known).view()},
        {options_.tolerance, floor_per_texel_ * known, weights.view()});
    PATINA_CHECK(!found.empty());
    return found[uniformBelow(draw, found.size())];
  }

  // Where nothing is allowed (a source hardly larger than a block), anything is.
  Image<float> weightsFor(int x, int y) const {
    Image<float> weights = guard_.weights(x, y);
    if (std::none_of(weights.texels().begin(), weights.texels().end(),
                     [](float w) { return std::isfinite(w); }))
      std::fill(weights.texels().begin(), weights.texels().end(), 1.0f);
    return weights;
  }

  const QuiltingOptions& options_;
  patch::OverlapSearch search_;
  RepetitionGuard guard_;
  double floor_per_texel_;
  Canvas canvas_;
  double seam_cost_ = 0;
  std::int64_t seam_edges_ = 0;
};

template <class T>
Image<T> copyByMap(ImageView<const T> frame, const Quilt& quilt) {
  const ImageView<const std::int32_t> map = quilt.source_xy.view();
  Image<T> out(map.width, map.height, frame.channels);
  const ImageView<T> view = out.view();
  tbb::parallel_for(0, map.height, [&](int y) {
    for (int x = 0; x < map.width; ++x) {
      const auto from = map.texel(x, y);
      const auto texel = frame.texel(from[0], from[1]);
      std::copy(texel.begin(), texel.end(), view.texel(x, y).begin());
    }
  });
  return out;
}

}  // namespace

int QuiltingOptions::overlap() const {
  if (overlap_px > 0) return overlap_px;
  return std::max(1, std::min(block_px.width, block_px.height) / 4);
}

void QuiltingOptions::check(SizePx source) const {
  const auto refuse = [](const std::string& field, const std::string& value,
                         const std::string& allowed) {
    throw ProcessingError(Exit::kUsage,
                          "quilting: " + field + " is " + value + "; allowed: " + allowed);
  };
  const auto within = [](double v, double low, double high) { return v >= low && v <= high; };
  if (size.width < 1 || size.height < 1 || size.width > 65535 || size.height > 65535)
    refuse("size", text(size), "1x1 to 65535x65535");
  if (block_px.width < 2 || block_px.height < 2 || block_px.width > source.width ||
      block_px.height > source.height)
    refuse("block_px", text(block_px), "2x2 to the source's " + text(source));
  const int smaller = std::min(block_px.width, block_px.height);
  if (overlap_px < 0 || overlap_px > smaller / 2)
    refuse("overlap_px", std::to_string(overlap_px),
           "0 (a quarter of the block) to " + std::to_string(smaller / 2) + ", half the block");
  if (tile && (size.width < block_px.width || size.height < block_px.height))
    refuse("size", text(size),
           "at least one block of " + text(block_px) + " where it wraps around");
  if (svd_rank < 1 || svd_rank > 1000) refuse("svd_rank", std::to_string(svd_rank), "1 to 1000");
  if (rank_error && !(*rank_error > 0 && *rank_error < 1))
    refuse("rank_error", std::to_string(*rank_error), "above 0 and below 1");
  if (!within(tolerance, 0, 100)) refuse("tolerance", std::to_string(tolerance), "0 to 100");
  if (!within(repetition_penalty, 0, 1e6))
    refuse("repetition_penalty", std::to_string(repetition_penalty), "0 to 1000000");
  if (!within(verbatim_blocks, 1, 1e6))
    refuse("verbatim_blocks", std::to_string(verbatim_blocks), "1 to 1000000");
}

QuiltResult quilt(ImageView<const float> features, const QuiltingOptions& options,
                  Progress& progress) {
  options.check(features.size());
  const SizePx block = options.block_px;
  const std::vector<int> across =
      placesAlong(options.size.width, block.width, options.overlap(), options.tile);
  const std::vector<int> down =
      placesAlong(options.size.height, block.height, options.overlap(), options.tile);
  const SizePx canvas =
      options.tile ? options.size : SizePx{across.back() + block.width, down.back() + block.height};
  progress.begin("quilting", static_cast<std::int64_t>(across.size() * down.size()));
  Quilter quilter(features, options, canvas);
  for (int y : down)
    for (int x : across) {
      quilter.place(x, y);
      progress.step();
    }
  return quilter.finish(features);
}

Image<std::uint16_t> applyQuilt(ImageView<const std::uint16_t> frame, const Quilt& quilt) {
  return copyByMap(frame, quilt);
}
Image<float> applyQuilt(ImageView<const float> frame, const Quilt& quilt) {
  return copyByMap(frame, quilt);
}

}  // namespace patina::quilting
