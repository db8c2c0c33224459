// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/brdf/alike.h"

#include <algorithm>
#include <cmath>

namespace patina::brdf {

using lanes::kLanes;
using lanes::Lane;

namespace {
constexpr int kRingsOfNeighbours = 6;

// In steps of `unit`, the farther the wider apart.
std::vector<int> offsetsTo(int reach, int unit) {
  const int most = reach / unit;
  std::vector<int> offsets{0};
  int last = 0;
  for (int ring = 0; last < most; ++ring) {
    const double even = std::pow(most, ring / (kRingsOfNeighbours - 1.0));
    last = std::min(most, std::max(last + 1, static_cast<int>(std::lround(even))));
    offsets.push_back(last * unit);
    offsets.insert(offsets.begin(), -last * unit);
  }
  return offsets;
}

}  // namespace

AlikeTexels::AlikeTexels(const Image<float>& look, const MultiLightOptions& options)
    : size_(look.size()),
      channels_(look.channels()),
      reach_(options.neighbours ? options.neighbour_px : 0),
      like_colour_(options.like_colour),
      offsets_(offsetsTo(reach_, options.filters ? 2 : 1)) {
  farthest_ = offsets_.back();
  stride_ = size_.width + 2 * farthest_ + kLanes;
  planes_.assign(static_cast<std::size_t>(size_.height) * static_cast<std::size_t>(channels_) *
                     static_cast<std::size_t>(stride_),
                 NAN);
  auto row = planes_.begin() + farthest_;
  for (int y = 0; y < size_.height; ++y)
    for (int c = 0; c < channels_; ++c, row += stride_)
      for (int x = 0; x < size_.width; ++x) row[x] = look.at(x, y, c);
}

// Like a Gaussian, without its cost: 0 from three units on, and of NaN.
bool AlikeTexels::weigh(int x0, int y, int dx, int dy, Lane& weights) const {
  weights = {};
  if (dx == 0 && dy == 0) {
    for (int k = 0; k < kLanes && x0 + k < size_.width; ++k) weights[k] = 1;
    return true;
  }
  if (y + dy < 0 || y + dy >= size_.height) return false;
  Lane off2, level;
  for (int c = 0; c < channels_; ++c) {
    const auto row = [&](int at) {
      return &planes_[(static_cast<std::size_t>(at) * static_cast<std::size_t>(channels_) +
                       static_cast<std::size_t>(c)) *
                          static_cast<std::size_t>(stride_) +
                      static_cast<std::size_t>(farthest_ + x0)];
    };
    const float *a = row(y), *b = row(y + dy) + dx;
    for (int k = 0; k < kLanes; ++k) {
      off2.v[k] += (a[k] - b[k]) * (a[k] - b[k]);
      level.v[k] += a[k] + b[k];
    }
  }
  const float mean = 0.5f / static_cast<float>(channels_);
  float any = 0;
  for (int k = 0; k < kLanes; ++k) {
    const float unit = like_colour_ * (0.1f + level.v[k] * mean);
    const float left = 1 - off2.v[k] / (9 * unit * unit), left2 = left * left;
    weights.v[k] = left > 0 ? left2 * left2 : 0.0f;
  }
  for (int k = 0; k < kLanes; ++k) any += weights.v[k];
  return any > 0;
}

}  // namespace patina::brdf
