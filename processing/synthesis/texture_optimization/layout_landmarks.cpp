// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/synthesis/texture_optimization/layout_landmarks.h"

#include <immintrin.h>

#include <algorithm>
#include <array>

namespace patina::texture_optimization {
namespace {

// Costs as in layout.cpp. Of two copies of a landmark, kLandmark sqrt(1 - apart / kApart): next to
// nothing else counts until they are so far apart. Of copies that are cut, the root of the product
// of what shows.
constexpr float kLandmark = 64, kApart = 1.01f, kLeastShare = 0.02f;
// Of a landmark, kOwed times the share of its copies that is missing: without it landmarks are left
// out for the trouble they make, a third of them where the target is 16 times the sample.
constexpr float kOwed = 16;
// Mismatch weighs so much where a landmark is cut.
constexpr float kCut = 4;

}  // namespace

void LayoutLandmarks::Parts::add(const Part& part) {
  place.push_back(part.place);
  share.push_back(part.share);
  x.push_back(part.x);
  y.push_back(part.y);
}

LayoutLandmarks::LayoutLandmarks(const Landmarks& landmarks, SizePx source, int block,
                                 std::span<const std::int32_t> places, float even_copies)
    : source_(source), block_(block), even_(even_copies) {
  const auto texels =
      static_cast<std::size_t>(source.width) * static_cast<std::size_t>(source.height);
  std::vector<std::vector<float>> share(static_cast<std::size_t>(landmarks.count),
                                        std::vector<float>(texels));
  std::vector<float> whole(share.size());
  weights_.assign(texels, 1.0f);
  for (int y = 0; y < landmarks.size.height; ++y)
    for (int x = 0; x < landmarks.size.width; ++x) {
      const std::int32_t of = landmarks.at(x, y, landmarks.size);
      if (of < 0) continue;
      const auto at = static_cast<std::size_t>(y * source.height / landmarks.size.height *
                                                   std::ptrdiff_t{source.width} +
                                               x * source.width / landmarks.size.width);
      ++share[static_cast<std::size_t>(of)][at];
      ++whole[static_cast<std::size_t>(of)];
      weights_[at] = kCut;
    }
  parts_at_.resize(texels);
  copies_.resize(share.size());
  landmarks_.resize(share.size());
  for (std::size_t k = 0; k < share.size(); ++k) {
    for (const std::int32_t place : places) {
      const Part part = partOf(share[k], place);
      if (part.share <= kLeastShare * whole[k]) continue;
      const Part shown{k, place, part.share / whole[k], part.x, part.y};
      landmarks_[k].add(shown);
      parts_at_[static_cast<std::size_t>(place)].push_back(shown);
    }
    while (landmarks_[k].place.size() % 4 != 0) landmarks_[k].add({k, 0, 0, 0, 0});
  }
}

LayoutLandmarks::Part LayoutLandmarks::partOf(const std::vector<float>& share,
                                              std::int32_t place) const {
  Part out{0, place, 0, 0, 0};
  for (int j = 0; j < block_; ++j)
    for (int i = 0; i < block_; ++i) {
      const float v =
          share[static_cast<std::size_t>(place + std::ptrdiff_t{j} * source_.width + i)];
      out.share += v;
      out.x += v * static_cast<float>(i);
      out.y += v * static_cast<float>(j);
    }
  if (out.share > 0) {
    out.x /= out.share;
    out.y /= out.share;
  }
  return out;
}

void LayoutLandmarks::count(std::int32_t place, float sign) {
  if (parts_at_.empty()) return;
  for (const Part& part : parts_at_[static_cast<std::size_t>(place)])
    copies_[part.landmark] += sign * part.share;
}

void LayoutLandmarks::addNear(std::int32_t place, int right, int below,
                              std::span<float> costs) const {
  if (parts_at_.empty()) return;
  const float reach = kApart * static_cast<float>(std::min(source_.width, source_.height));
  const __m128 one = _mm_set1_ps(1), far = _mm_set1_ps(reach);
  alignas(16) std::array<float, 4> cost;
  for (const Part& there : parts_at_[static_cast<std::size_t>(place)]) {
    const Parts& parts = landmarks_[there.landmark];
    const __m128 x = _mm_set1_ps(static_cast<float>(right) + there.x),
                 y = _mm_set1_ps(static_cast<float>(below) + there.y),
                 share = _mm_set1_ps(there.share);
    for (std::size_t i = 0; i < parts.place.size(); i += cost.size()) {
      const __m128 across = x - _mm_loadu_ps(&parts.x[i]), down = y - _mm_loadu_ps(&parts.y[i]),
                   near = one - _mm_sqrt_ps(across * across + down * down) / far;
      _mm_store_ps(cost.data(), _mm_sqrt_ps(_mm_max_ps(near, _mm_setzero_ps()) * share *
                                            _mm_loadu_ps(&parts.share[i])));
      for (std::size_t k = 0; k < cost.size(); ++k)
        if (parts.place[i + k] + below * source_.width + right != place)
          costs[static_cast<std::size_t>(parts.place[i + k])] += kLandmark * cost[k];
    }
  }
}

void LayoutLandmarks::takeOwed(std::span<float> costs) const {
  for (std::size_t k = 0; k < landmarks_.size(); ++k) {
    const float owed = kOwed * std::max(0.0f, 1 - copies_[k] / even_);
    const Parts& parts = landmarks_[k];
    for (std::size_t i = 0; i < parts.place.size(); ++i)
      costs[static_cast<std::size_t>(parts.place[i])] -= owed * parts.share[i];
  }
}

}  // namespace patina::texture_optimization
