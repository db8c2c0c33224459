// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/synthesis/quilting/canvas.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "processing/patch/squared_difference.h"
#include "processing/patch/strip_cut.h"
#include "processing/synthesis/quilting/block_groups.h"

namespace patina::quilting {
namespace {

double gradient(ImageView<const float> f, int x, int y, int step_x, int step_y) {
  return std::sqrt(patch::squaredDifference(f.texel(x, y).data(),
                                            f.texel(x + step_x, y + step_y).data(), f.channels));
}

double typicalGradient(ImageView<const float> to_right, ImageView<const float> down) {
  double sum = 0;
  for (int y = 0; y + 1 < down.height; ++y)
    for (int x = 0; x + 1 < down.width; ++x)
      sum += gradient(to_right, x, y, 1, 0) + gradient(down, x, y, 0, 1);
  return sum / (2.0 * std::max(1, down.height - 1) * std::max(1, down.width - 1));
}

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

Canvas::Canvas(ImageView<const float> features, SizePx size, SizePx block, bool wraps,
               const TimeWarps* warps, const SeamMetric* metric)
    : features_(features),
      size_(size),
      block_(block),
      wraps_(wraps),
      warps_(warps),
      metric_(metric),
      across_channels_(metric ? (features.channels + 7) / 8 * 8 : features.channels),
      weights_(size, 0, {}),
      source_(size.width, size.height, 2, -1),
      index_(size.width, size.height, 1, -1),
      changed_(size.width / kCellPx + 1, size.height / kCellPx + 1, 1),
      target_(block.width, block.height, features.channels),
      at_true_time_(warps ? block.width : 0, warps ? block.height : 0, features.channels),
      known_(block.width, block.height, 1) {
  for (std::size_t d = 0; d < 2; ++d) {
    target_across_[d] = Image<float>(block.width, block.height, across_channels_);
    if (!metric_) continue;
    across_[d] = Image<float>(features.width, features.height, across_channels_);
    tbb::parallel_for(0, features.height, [&](int y) {
      for (int x = 0; x < features.width; ++x)
        metric_->apply(static_cast<int>(d), features.texel(x, y).data(), &across_[d].at(x, y));
    });
  }
  weights_ = SeamWeights(size, typicalGradient(across(0), across(1)),
                         metric_ ? metric_->ragged : std::array<double, 2>{});
}

void Canvas::addGradients(int source_x, int source_y) {
  for (std::size_t d = 0; d < 2; ++d) {
    const int right = d == 0 ? 1 : 0, down = 1 - right;
    const ImageView<const float> f = across(d);
    for (int j = 0; j < block_.height; ++j)
      for (int i = 0; i < block_.width; ++i) {
        const int u = source_x + i, v = source_y + j;
        if (!isOn(x_ + i, y_ + j) || u + right >= f.width || v + down >= f.height) continue;
        weights_.add(d, wrapped(x_ + i, size_.width), wrapped(y_ + j, size_.height),
                     gradient(f, u, v, right, down));
      }
  }
}

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
      for (std::size_t d = 0; d < 2; ++d)
        shownAcross(d, by, source[0], source[1], &target_across_[d].at(i, j));
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

void Canvas::shownAcross(std::size_t direction, int index, int source_x, int source_y,
                         float* out) const {
  if (!warps_) {
    const auto from = across(direction).texel(source_x, source_y);
    std::copy(from.begin(), from.end(), out);
    return;
  }
  thread_local std::vector<float> plain;
  plain.resize(static_cast<std::size_t>(features_.channels));
  float* shown = metric_ ? plain.data() : out;
  warps_->warp(index, features_.texel(source_x, source_y).data(), shown);
  if (metric_) metric_->apply(static_cast<int>(direction), shown, out);
}

Image<double> Canvas::differenceFrom(std::size_t direction, RectPx part, int source_x,
                                     int source_y) const {
  Image<double> difference(part.width, part.height, 1, -1.0);
  std::vector<float> warped(warps_ ? across_channels_ : 0);
  for (int j = 0; j < part.height; ++j)
    for (int i = 0; i < part.width; ++i) {
      const int u = part.x + i, v = part.y + j;
      if (!known_.at(u, v)) continue;
      const float* shown = across(direction).texel(source_x + u, source_y + v).data();
      if (warps_) {
        shownAcross(direction, looking_, source_x + u, source_y + v, warped.data());
        shown = warped.data();
      }
      difference.at(i, j) =
          patch::squaredDifference(&target_across_[direction].at(u, v), shown, across_channels_);
    }
  return difference;
}

double Canvas::seamEstimate(int source_x, int source_y, SizePx overlap, double limit) const {
  const int width = block_.width, height = block_.height, middle_x = width / 2,
            middle_y = height / 2;
  const auto along = [&](std::size_t direction, RectPx strip) {
    const Image<double> d = differenceFrom(direction, strip, source_x, source_y);
    const RectPx all{0, 0, strip.width, strip.height};
    return direction == 0 ? patch::cutAlongRows(d.view(), all)
                          : patch::cutAlongColumns(d.view(), all);
  };
  double sum = 0;
  if (known_.at(0, middle_y)) sum += along(0, {0, 0, overlap.width, height});
  if (sum <= limit && known_.at(middle_x, 0)) sum += along(1, {0, 0, width, overlap.height});
  if (sum <= limit && known_.at(width - 1, middle_y))
    sum += along(0, {width - overlap.width, 0, overlap.width, height});
  if (sum <= limit && known_.at(middle_x, height - 1))
    sum += along(1, {0, height - overlap.height, width, overlap.height});
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

Image<double> Canvas::edgeCosts(std::size_t direction, int source_x, int source_y) const {
  const RectPx all{0, 0, block_.width, block_.height};
  Image<double> costs =
      patch::edgeCosts(differenceFrom(direction, all, source_x, source_y).view(), direction);
  for (int j = 0; j < block_.height; ++j)
    for (int i = 0; i < block_.width; ++i) {
      if (costs.at(i, j) == 0) continue;
      const double weight = weightAt(direction, x_ + i, y_ + j);
      costs.at(i, j) *= weight * weight;  // differences are squares
    }
  return costs;
}

patch::GridCut Canvas::paste(int source_x, int source_y) {
  addGradients(source_x, source_y);
  const patch::EdgeCosts costs{edgeCosts(0, source_x, source_y), edgeCosts(1, source_x, source_y)};
  Image<patch::Side> side(block_.width, block_.height, 1, patch::Side::kNew);
  for (int j = 0; j < block_.height; ++j)
    for (int i = 0; i < block_.width; ++i)
      if (known_.at(i, j))
        side.at(i, j) =
            bordersOld(i, j) || isKept(x_ + i, y_ + j) ? patch::Side::kOld : patch::Side::kFree;
  patch::GridCut cut = patch::minimumCut(costs, std::as_const(side).view());
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

Image<std::uint16_t> applyQuilt(ImageView<const std::uint16_t> frame, const Quilt& quilt) {
  return copyByMap(frame, quilt);
}
Image<float> applyQuilt(ImageView<const float> frame, const Quilt& quilt) {
  return copyByMap(frame, quilt);
}

}  // namespace patina::quilting
