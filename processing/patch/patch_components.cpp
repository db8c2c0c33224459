// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/patch/patch_components.h"

#include <immintrin.h>

#include <algorithm>

namespace patina::patch {

PatchComponents::PatchComponents(ImageView<const std::int16_t> source, SizePx target, int patch,
                                 ImageView<const std::int16_t> guide)
    : source_(source),
      target_size_(target),
      reach_(patch / 2),
      corner_(reach_ * (source.width + 1)),
      voted_(source.channels - (guide.empty() ? 0 : guide.channels)),
      target_(target.width + 2 * reach_, target.height + 2 * reach_, source.channels),
      target_stride_(target_.view().row_stride),
      distance_(patchDistance(patch, source.channels, simdPath())) {
  PATINA_CHECK(source.row_stride == std::ptrdiff_t{source.width} * source.channels && voted_ >= 0 &&
               voted_ % 4 == 0);
  if (guide.empty()) return;
  PATINA_CHECK(guide.size() == target);
  for (int y = 0; y < target.height; ++y)
    for (int x = 0; x < target.width; ++x)
      std::copy_n(&guide.at(x, y), guide.channels, &target_.at(x + reach_, y + reach_, voted_));
}

void PatchComponents::vote(const Votes& votes, int x, int y) {
  int first = 0;
  for (; first + 8 <= voted_; first += 8) {
    __m128i low = _mm_setzero_si128(), high = low;
    const int count = forEachVote(votes, x, y, [&](std::int32_t texel, int, int) {
      const __m128i v = _mm_loadu_si128(reinterpret_cast<const __m128i*>(
          source_.data + static_cast<std::ptrdiff_t>(texel) * source_.channels + first));
      low = _mm_add_epi32(low, _mm_cvtepi16_epi32(v));
      high = _mm_add_epi32(high, _mm_cvtepi16_epi32(_mm_unpackhi_epi64(v, v)));
    });
    const __m128 share = _mm_set1_ps(1.0f / static_cast<float>(count));
    low = _mm_cvtps_epi32(_mm_mul_ps(_mm_cvtepi32_ps(low), share));
    high = _mm_cvtps_epi32(_mm_mul_ps(_mm_cvtepi32_ps(high), share));
    _mm_storeu_si128(reinterpret_cast<__m128i*>(&target_.at(x + reach_, y + reach_, first)),
                     _mm_packs_epi32(low, high));
  }
  if (first < voted_) voteFour(votes, x, y, first);
}

void PatchComponents::voteFour(const Votes& votes, int x, int y, int first) {
  __m128i sum = _mm_setzero_si128();
  const int count = forEachVote(votes, x, y, [&](std::int32_t texel, int, int) {
    sum = _mm_add_epi32(
        sum, _mm_cvtepi16_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(
                 source_.data + static_cast<std::ptrdiff_t>(texel) * source_.channels + first))));
  });
  const __m128 share = _mm_set1_ps(1.0f / static_cast<float>(count));
  sum = _mm_cvtps_epi32(_mm_mul_ps(_mm_cvtepi32_ps(sum), share));
  _mm_storel_epi64(reinterpret_cast<__m128i*>(&target_.at(x + reach_, y + reach_, first)),
                   _mm_packs_epi32(sum, sum));
}

void PatchComponents::pad(bool wraps) {
  const int width = target_size_.width, height = target_size_.height, channels = target_.channels();
  const ImageView<std::int16_t> view = target_.view();
  const auto from = [&](int i, int length) {
    const int inside = wraps ? (i % length + length) % length : std::clamp(i, 0, length - 1);
    return inside + reach_;
  };
  for (int y = reach_; y < height + reach_; ++y)
    for (int i = -reach_; i < 0; ++i) {
      std::copy_n(&view.at(from(i, width), y), channels, &view.at(i + reach_, y));
      const int right = width - 1 - i;
      std::copy_n(&view.at(from(right, width), y), channels, &view.at(right + reach_, y));
    }
  for (int i = -reach_; i < 0; ++i) {
    std::copy_n(view.row(from(i, height)), view.row_stride, view.row(i + reach_));
    const int below = height - 1 - i;
    std::copy_n(view.row(from(below, height)), view.row_stride, view.row(below + reach_));
  }
}

}  // namespace patina::patch
