// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/synthesis/quilting/canvas.h"

#include <algorithm>
#include <utility>

#include "processing/patch/strip_cut.h"

namespace patina::quilting {
namespace {

float squaredDistance(const float* a, const float* b, int channels) {
  float sum = 0;
  for (int c = 0; c < channels; ++c) sum += (a[c] - b[c]) * (a[c] - b[c]);
  return sum;
}

}  // namespace

Canvas::Canvas(ImageView<const float> features, SizePx size, SizePx block, bool wraps)
    : features_(features),
      size_(size),
      block_(block),
      wraps_(wraps),
      source_(size.width, size.height, 2, -1),
      index_(size.width, size.height, 1, -1),
      target_(block.width, block.height, features.channels),
      known_(block.width, block.height, 1) {}

patch::Overlap Canvas::look(int x, int y) {
  x_ = x;
  y_ = y;
  known_texels_ = 0;
  for (int j = 0; j < block_.height; ++j)
    for (int i = 0; i < block_.width; ++i) {
      const auto source = sourceAt(x + i, y + j);
      known_.at(i, j) = source[0] >= 0;
      if (source[0] < 0) continue;
      ++known_texels_;
      const auto from = features_.texel(source[0], source[1]);
      std::copy(from.begin(), from.end(), target_.view().texel(i, j).begin());
    }
  return {std::as_const(target_).view(), std::as_const(known_).view()};
}

Image<double> Canvas::differenceFrom(int source_x, int source_y) const {
  Image<double> difference(block_.width, block_.height, 1, -1.0);
  for (int j = 0; j < block_.height; ++j)
    for (int i = 0; i < block_.width; ++i)
      if (known_.at(i, j))
        difference.at(i, j) = squaredDistance(
            &target_.at(i, j), &features_.at(source_x + i, source_y + j), features_.channels);
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

patch::GridCut Canvas::paste(int source_x, int source_y, int block_index) {
  const Image<double> difference = differenceFrom(source_x, source_y);
  Image<patch::Side> side(block_.width, block_.height, 1, patch::Side::kNew);
  for (int j = 0; j < block_.height; ++j)
    for (int i = 0; i < block_.width; ++i)
      if (known_.at(i, j))
        side.at(i, j) = bordersOld(i, j) ? patch::Side::kOld : patch::Side::kFree;
  patch::GridCut cut = patch::minimumCut(difference.view(), std::as_const(side).view());
  for (int j = 0; j < block_.height; ++j)
    for (int i = 0; i < block_.width; ++i) {
      if (!cut.take_new.at(i, j)) continue;
      const auto to = sourceAt(x_ + i, y_ + j);
      to[0] = source_x + i;
      to[1] = source_y + j;
      index_.at(wrapped(x_ + i, size_.width), wrapped(y_ + j, size_.height)) = block_index;
    }
  return cut;
}

Quilt Canvas::cropped(SizePx size) const {
  const RectPx rect{0, 0, size.width, size.height};
  return {copyOf(source_.view().crop(rect)), copyOf(index_.view().crop(rect))};
}

}  // namespace patina::quilting
