// SPDX-License-Identifier: GPL-3.0-or-later
// The result while it is being covered: which source texel lies where, block by block.
#pragma once

#include <array>

#include "processing/patch/grid_cut.h"
#include "processing/patch/overlap_search.h"
#include "processing/synthesis/quilting/quilting.h"
#include "processing/synthesis/quilting/seam_metric.h"
#include "processing/synthesis/quilting/seam_weights.h"
#include "processing/synthesis/quilting/time_warp.h"

namespace patina::quilting {

class Canvas {
 public:
  // What is passed is borrowed. `wraps`: the right edge meets the left one, the bottom the top.
  // Without `metric` seams are judged as blocks are, by the distance of features.
  Canvas(ImageView<const float> features, SizePx size, SizePx block, bool wraps,
         const TimeWarps* warps = nullptr, const SeamMetric* metric = nullptr);

  // Shows the source from (from_x, from_y) on wherever `mask` is not 0, as block `index`, for good.
  void keep(ImageView<const std::uint8_t> mask, int from_x, int from_y, int index);

  // What lies under block `index` at (x,y), as a search at its true time needs it; valid until the
  // next look().
  patch::Overlap look(int x, int y, int index);
  std::int64_t knownTexels() const { return known_texels_; }

  // What a seam would cost, were source block (source_x, source_y) laid over the place last looked
  // at: cut straight through each of the overlapping sides, as wide as `overlap` says. For
  // comparing. Once it is above `limit` it may come out as anything above it.
  double seamEstimate(int source_x, int source_y, SizePx overlap, double limit) const;
  // Lays it there, cut where it differs least.
  patch::GridCut paste(int source_x, int source_y);

  // Lets block `index`, laid at (x,y), take whatever of its place lowers the cost of all seams
  // there, old ones too (Kwatra et al. 2003, section 3.1; an expansion move of Boykov et al. 2001).
  // A seam between neighbours costs how far their sources are apart at both, as distances: these
  // keep to the triangle inequality, so the minimum is exact. Returns the texels that changed.
  std::int64_t expand(int x, int y, int index, int source_x, int source_y);
  // Has anything changed by expansions, within or beside the block at (x,y), since step `step`?
  // What changes from now on does so in `step`; blocks of one step neither share nor neighbour a
  // texel.
  bool isChangedSince(int x, int y, int step) const;
  void setStep(int step) { step_ = step; }

  // How much the liveliness of a place counts for seams from now on (seam_weights.h).
  void setLiveliness(double exponent) { weights_.setExponent(exponent); }

  Quilt cropped(SizePx size) const;
  Image<float> shown(SizePx size) const;  // its features, every block at its own time

 private:
  int wrapped(int v, int length) const { return wraps_ ? (v % length + length) % length : v; }
  bool isOn(int x, int y) const {
    return wraps_ || (x >= 0 && x < size_.width && y >= 0 && y < size_.height);
  }
  std::span<std::int32_t> sourceAt(int x, int y) {
    return source_.view().texel(wrapped(x, size_.width), wrapped(y, size_.height));
  }
  bool isKept(int x, int y) const {
    return !kept_.empty() && kept_.at(wrapped(x, size_.width), wrapped(y, size_.height)) != 0;
  }
  bool isCovered(int x, int y) const {
    return isOn(x, y) && source_.at(wrapped(x, size_.width), wrapped(y, size_.height), 0) >= 0;
  }
  bool bordersOld(int i, int j) const;
  struct Copy {
    int index, x, y;  // block and source texel
    bool operator==(const Copy&) const = default;
  };
  Copy copyAt(int x, int y) const;
  double seamCost(const Copy& here, const Copy& there, int step_x, int step_y) const;
  // The features of a source texel as block `index` shows them.
  void shownBy(int index, int source_x, int source_y, float* out) const;
  // Features by which edges in a direction (0: to the right, 1: down) are judged.
  ImageView<const float> across(std::size_t direction) const {
    return across_[direction].empty() ? features_ : across_[direction].view();
  }
  void shownAcross(std::size_t direction, int index, int source_x, int source_y, float* out) const;
  // Squared difference across edges of a direction of what is there and the source block, within a
  // part of the block; -1 where nothing is there.
  Image<double> differenceFrom(std::size_t direction, RectPx part, int source_x,
                               int source_y) const;
  // The gradients that this block would show, to the weights of its place.
  void addGradients(int source_x, int source_y);
  double weightAt(std::size_t direction, int x, int y) const {
    return weights_.at(direction, wrapped(x, size_.width), wrapped(y, size_.height));
  }
  // What a boundary between what is there and the source block costs, edge by edge.
  Image<double> edgeCosts(std::size_t direction, int source_x, int source_y) const;

  ImageView<const float> features_;
  SizePx size_, block_;
  bool wraps_;
  const TimeWarps* warps_;
  const SeamMetric* metric_;
  int across_channels_;                 // with a metric filled up with zeros to eights
  std::array<Image<float>, 2> across_;  // empty without a metric
  SeamWeights weights_;
  Image<std::int32_t> source_, index_;  // -1: nothing there yet
  Image<std::uint8_t> kept_;            // empty: nothing
  Image<std::int32_t> changed_;         // by cells: in which step last, by an expansion
  int step_ = 0;

  int x_ = 0, y_ = 0, looking_ = 0;  // last looked at, and for which block
  Image<float> target_;              // as it is shown
  std::array<Image<float>, 2> target_across_;
  Image<float> at_true_time_;
  Image<std::uint8_t> known_;
  std::int64_t known_texels_ = 0;
};

}  // namespace patina::quilting
