// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/synthesis/quilting/canvas.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "processing/patch/strip_cut.h"

namespace patina::quilting {
namespace {

float squaredDistance(const float* a, const float* b, int channels) {
  float sum = 0;
  for (int c = 0; c < channels; ++c) sum += (a[c] - b[c]) * (a[c] - b[c]);
  return sum;
}

}  // namespace

Canvas::Canvas(ImageView<const float> features, SizePx size, SizePx block, bool wraps,
               const TimeWarps* warps)
    : features_(features),
      size_(size),
      block_(block),
      wraps_(wraps),
      warps_(warps),
      source_(size.width, size.height, 2, -1),
      index_(size.width, size.height, 1, -1),
      target_(block.width, block.height, features.channels),
      at_true_time_(warps ? block.width : 0, warps ? block.height : 0, features.channels),
      known_(block.width, block.height, 1) {}

void Canvas::keep(ImageView<const std::uint8_t> mask, int from_x, int from_y, int index) {
  kept_ = Image<std::uint8_t>(size_.width, size_.height, 1);
  for (int y = 0; y < mask.height; ++y)
    for (int x = 0; x < mask.width; ++x) {
      if (mask.at(x, y) == 0) continue;
      kept_.at(x, y) = 1;
      source_.at(x, y, 0) = from_x + x;
      source_.at(x, y, 1) = from_y + y;
      index_.at(x, y) = index;
    }
}

patch::Overlap Canvas::look(int x, int y, int index) {
  x_ = x;
  y_ = y;
  looking_ = index;
  known_texels_ = 0;
  for (int j = 0; j < block_.height; ++j)
    for (int i = 0; i < block_.width; ++i) {
      const auto source = sourceAt(x + i, y + j);
      known_.at(i, j) = source[0] >= 0;
      if (source[0] < 0) continue;
      ++known_texels_;
      const int by = index_.at(wrapped(x + i, size_.width), wrapped(y + j, size_.height));
      shownBy(by, source[0], source[1], &target_.at(i, j));
      if (warps_) warps_->unwarp(index, &target_.at(i, j), &at_true_time_.at(i, j));
    }
  return {std::as_const(warps_ ? at_true_time_ : target_).view(), std::as_const(known_).view()};
}

void Canvas::shownBy(int index, int source_x, int source_y, float* out) const {
  const auto from = features_.texel(source_x, source_y);
  if (warps_)
    warps_->warp(index, from.data(), out);
  else
    std::copy(from.begin(), from.end(), out);
}

Image<double> Canvas::differenceFrom(int source_x, int source_y) const {
  Image<double> difference(block_.width, block_.height, 1, -1.0);
  std::vector<float> warped(warps_ ? features_.channels : 0);
  for (int j = 0; j < block_.height; ++j)
    for (int i = 0; i < block_.width; ++i) {
      if (!known_.at(i, j)) continue;
      const float* shown = &features_.at(source_x + i, source_y + j);
      if (warps_) {
        warps_->warp(looking_, shown, warped.data());
        shown = warped.data();
      }
      difference.at(i, j) = squaredDistance(&target_.at(i, j), shown, features_.channels);
    }
  return difference;
}

double Canvas::seamEstimate(int source_x, int source_y, int overlap) const {
  const Image<double> difference = differenceFrom(source_x, source_y);
  const int width = block_.width, height = block_.height, middle_x = width / 2,
            middle_y = height / 2;
  const ImageView<const double> d = difference.view();
  double sum = 0;
  if (known_.at(0, middle_y)) sum += patch::cutAlongRows(d, {0, 0, overlap, height});
  if (known_.at(middle_x, 0)) sum += patch::cutAlongColumns(d, {0, 0, width, overlap});
  if (known_.at(width - 1, middle_y))
    sum += patch::cutAlongRows(d, {width - overlap, 0, overlap, height});
  if (known_.at(middle_x, height - 1))
    sum += patch::cutAlongColumns(d, {0, height - overlap, width, overlap});
  return std::max(sum, 0.0);
}

// A texel beside old ones outside of the block: they stay, so it must go with them.
bool Canvas::bordersOld(int i, int j) const {
  const auto oldOutside = [&](int di, int dj) {
    const int u = i + di, v = j + dj;
    const bool within = u >= 0 && u < block_.width && v >= 0 && v < block_.height;
    return !within && isCovered(x_ + u, y_ + v);
  };
  return oldOutside(-1, 0) || oldOutside(1, 0) || oldOutside(0, -1) || oldOutside(0, 1);
}

patch::GridCut Canvas::paste(int source_x, int source_y) {
  const Image<double> difference = differenceFrom(source_x, source_y);
  Image<patch::Side> side(block_.width, block_.height, 1, patch::Side::kNew);
  for (int j = 0; j < block_.height; ++j)
    for (int i = 0; i < block_.width; ++i)
      if (known_.at(i, j))
        side.at(i, j) =
            bordersOld(i, j) || isKept(x_ + i, y_ + j) ? patch::Side::kOld : patch::Side::kFree;
  patch::GridCut cut = patch::minimumCut(difference.view(), std::as_const(side).view());
  for (int j = 0; j < block_.height; ++j)
    for (int i = 0; i < block_.width; ++i) {
      if (!cut.take_new.at(i, j)) continue;
      const auto to = sourceAt(x_ + i, y_ + j);
      to[0] = source_x + i;
      to[1] = source_y + j;
      index_.at(wrapped(x_ + i, size_.width), wrapped(y_ + j, size_.height)) = looking_;
    }
  return cut;
}

Quilt Canvas::cropped(SizePx size) const {
  const RectPx rect{0, 0, size.width, size.height};
  return {copyOf(source_.view().crop(rect)), copyOf(index_.view().crop(rect)),
          warps_ ? warps_->times() : std::vector<std::vector<int>>{}};
}

Image<float> Canvas::shown(SizePx size) const {
  Image<float> out(size.width, size.height, features_.channels);
  tbb::parallel_for(0, size.height, [&](int y) {
    for (int x = 0; x < size.width; ++x)
      shownBy(index_.at(x, y), source_.at(x, y, 0), source_.at(x, y, 1), &out.at(x, y));
  });
  return out;
}

}  // namespace patina::quilting
