// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/patch/patch_distance.h"

#include <immintrin.h>

#include "processing/image/failure.h"

namespace patina::patch {
namespace {

[[gnu::target("avx2")]] inline std::int32_t sumOf(__m128i v) {
  v = _mm_add_epi32(v, _mm_shuffle_epi32(v, 0x4e));
  return _mm_cvtsi128_si32(_mm_add_epi32(v, _mm_shuffle_epi32(v, 0xb1)));
}
inline std::int32_t sumOfBaseline(__m128i v) {
  v = _mm_add_epi32(v, _mm_shuffle_epi32(v, 0x4e));
  return _mm_cvtsi128_si32(_mm_add_epi32(v, _mm_shuffle_epi32(v, 0xb1)));
}

// Four numbers, zeros behind.
inline __m128i squaresOfFour(const std::int16_t* a, const std::int16_t* b) {
  const __m128i d = _mm_sub_epi16(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(a)),
                                  _mm_loadl_epi64(reinterpret_cast<const __m128i*>(b)));
  return _mm_madd_epi16(d, d);
}

const __m128i* at128(const std::int16_t* p) { return reinterpret_cast<const __m128i*>(p); }
const __m256i* at256(const std::int16_t* p) { return reinterpret_cast<const __m256i*>(p); }

template <int kPatch, int kComponents>
std::int32_t distanceBaseline(const std::int16_t* a, const std::int16_t* b, std::ptrdiff_t a_stride,
                              std::ptrdiff_t b_stride, std::int32_t bound) {
  constexpr int kRow = kPatch * kComponents, kWhole = kRow / 8 * 8;
  __m128i sum = _mm_setzero_si128();
  for (int row = 0; row < kPatch; ++row, a += a_stride, b += b_stride) {
    for (int i = 0; i < kWhole; i += 8) {
      const __m128i d = _mm_sub_epi16(_mm_loadu_si128(at128(a + i)), _mm_loadu_si128(at128(b + i)));
      sum = _mm_add_epi32(sum, _mm_madd_epi16(d, d));
    }
    if constexpr (kWhole < kRow) sum = _mm_add_epi32(sum, squaresOfFour(a + kWhole, b + kWhole));
    if (row == 1) {
      const std::int32_t part = sumOfBaseline(sum);
      if (part >= bound) return part;
    }
  }
  return sumOfBaseline(sum);
}

template <int kPatch, int kComponents>
[[gnu::target("avx2")]] std::int32_t distanceAvx2(const std::int16_t* a, const std::int16_t* b,
                                                  std::ptrdiff_t a_stride, std::ptrdiff_t b_stride,
                                                  std::int32_t bound) {
  constexpr int kRow = kPatch * kComponents, kWhole = kRow / 16 * 16;
  __m256i sum = _mm256_setzero_si256();
  __m128i rest = _mm_setzero_si128();
  for (int row = 0; row < kPatch; ++row, a += a_stride, b += b_stride) {
    for (int i = 0; i < kWhole; i += 16) {
      const __m256i d =
          _mm256_sub_epi16(_mm256_loadu_si256(at256(a + i)), _mm256_loadu_si256(at256(b + i)));
      sum = _mm256_add_epi32(sum, _mm256_madd_epi16(d, d));
    }
    if constexpr (kRow - kWhole >= 8) {
      const __m128i d =
          _mm_sub_epi16(_mm_loadu_si128(at128(a + kWhole)), _mm_loadu_si128(at128(b + kWhole)));
      rest = _mm_add_epi32(rest, _mm_madd_epi16(d, d));
    }
    if constexpr (kRow % 8 != 0)
      rest = _mm_add_epi32(rest, squaresOfFour(a + kRow - 4, b + kRow - 4));
    if (row == 1) {
      const __m128i half =
          _mm_add_epi32(_mm256_castsi256_si128(sum), _mm256_extracti128_si256(sum, 1));
      const std::int32_t part = sumOf(_mm_add_epi32(half, rest));
      if (part >= bound) return part;
    }
  }
  const __m128i half = _mm_add_epi32(_mm256_castsi256_si128(sum), _mm256_extracti128_si256(sum, 1));
  return sumOf(_mm_add_epi32(half, rest));
}

// By way of memory: GCC 12 warns of what its own ways of halving a register leave undefined.
[[gnu::target("avx512f,avx512bw,avx512vl,avx512vnni")]] inline std::int32_t sumOf(__m512i v) {
  alignas(64) std::int32_t parts[16];
  _mm512_store_si512(parts, v);
  const auto* halves = reinterpret_cast<const __m256i*>(parts);
  const __m256i half = _mm256_add_epi32(_mm256_load_si256(halves), _mm256_load_si256(halves + 1));
  return sumOf(_mm_add_epi32(_mm256_castsi256_si128(half), _mm256_extracti128_si256(half, 1)));
}

template <int kPatch, int kComponents>
[[gnu::target("avx512f,avx512bw,avx512vl,avx512vnni")]] std::int32_t distanceAvx512(
    const std::int16_t* a, const std::int16_t* b, std::ptrdiff_t a_stride, std::ptrdiff_t b_stride,
    std::int32_t bound) {
  constexpr int kRow = kPatch * kComponents, kWhole = kRow / 32 * 32;
  constexpr __mmask32 kRest = static_cast<__mmask32>((1ull << (kRow - kWhole)) - 1);
  __m512i sum = _mm512_setzero_si512();
  for (int row = 0; row < kPatch; ++row, a += a_stride, b += b_stride) {
    for (int i = 0; i < kWhole; i += 32) {
      const __m512i d = _mm512_sub_epi16(_mm512_loadu_si512(a + i), _mm512_loadu_si512(b + i));
      sum = _mm512_dpwssd_epi32(sum, d, d);
    }
    if constexpr (kWhole < kRow) {
      const __m512i d = _mm512_sub_epi16(_mm512_maskz_loadu_epi16(kRest, a + kWhole),
                                         _mm512_maskz_loadu_epi16(kRest, b + kWhole));
      sum = _mm512_dpwssd_epi32(sum, d, d);
    }
    if (row == 1) {
      const std::int32_t part = sumOf(sum);
      if (part >= bound) return part;
    }
  }
  return sumOf(sum);
}

template <int kPatch, int kComponents>
PatchDistance on(SimdPath path) {
  if (path == SimdPath::kAvx512) return distanceAvx512<kPatch, kComponents>;
  if (path == SimdPath::kAvx2) return distanceAvx2<kPatch, kComponents>;
  return distanceBaseline<kPatch, kComponents>;
}

template <int kPatch>
PatchDistance of(int components, SimdPath path) {
  PATINA_CHECK(components == 4 || components == 8 || components == 16);
  return components == 4   ? on<kPatch, 4>(path)
         : components == 8 ? on<kPatch, 8>(path)
                           : on<kPatch, 16>(path);
}

}  // namespace

PatchDistance patchDistance(int patch, int components, SimdPath path) {
  PATINA_CHECK(patch == 3 || patch == 5 || patch == 7);
  return patch == 3   ? of<3>(components, path)
         : patch == 5 ? of<5>(components, path)
                      : of<7>(components, path);
}

}  // namespace patina::patch
