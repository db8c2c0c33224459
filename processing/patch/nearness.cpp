// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/patch/nearness.h"

#include <immintrin.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "processing/image/failure.h"

namespace patina::patch {
namespace {

constexpr int kCells = 16;  // along the source's smaller side
constexpr int kReach = 12, kSide = 2 * kReach + 1, kPaddedSide = kSide + 3, kMargin = 2 * kReach;
constexpr double kSameCopy = 1.5;  // cells: closer is the same copy, going on
constexpr std::int32_t kOne = 16;  // weight of what is as near as can be

// Of a row of weights, by its distance from the middle: how many are 0 on either side.
constexpr std::array<int, kReach + 1> kBlank = [] {
  std::array<int, kReach + 1> blank{};
  for (int y = 0; y <= kReach; ++y) {
    int x = kReach;
    while (x > 0 && x * x + y * y >= kReach * kReach) --x;
    blank[static_cast<std::size_t>(y)] = kReach - x;
  }
  return blank;
}();

int ceilOf(int length, int cell) { return (length + cell - 1) / cell; }
int cellOfSource(SizePx source) {
  return std::max(1, std::min(source.width, source.height) / kCells);
}

}  // namespace

Nearness::Nearness(SizePx source, SizePx target, bool wraps, int first, int last)
    : wraps_(wraps),
      source_width_(source.width),
      cell_px_(cellOfSource(source)),
      source_columns_(ceilOf(source.width, cell_px_)),
      target_columns_(ceilOf(target.width, cell_px_)),
      rows_(ceilOf(target.height, cell_px_)),
      first_(first / cell_px_),
      columns_(ceilOf(last, cell_px_) - first_),
      stride_(static_cast<std::size_t>(kMargin + columns_ + kMargin + 4)),
      plane_(stride_ * static_cast<std::size_t>(rows_)) {
  PATINA_CHECK(first >= 0 && first < last && last <= target.width);
  for (int y = -kReach; y <= kReach; ++y)
    for (int x = -kReach; x < kPaddedSide - kReach; ++x) {
      const double apart = std::hypot(x, y), weight = std::max(0.0, 1 - apart / kReach);
      kernel_.push_back(apart < kSameCopy ? 0
                                          : static_cast<std::int32_t>(std::lround(kOne * weight)));
    }
  counts_.assign(plane_ * static_cast<std::size_t>(source_columns_) *
                     static_cast<std::size_t>(ceilOf(source.height, cell_px_)),
                 0);
}

std::int32_t Nearness::unit() const { return kOne * cell_px_ * cell_px_; }

std::int64_t Nearness::bytes(SizePx source, SizePx target) {
  constexpr std::int64_t kBytesPlace = 4, kLanes = 4;
  const int cell = cellOfSource(source);
  return kBytesPlace * ceilOf(source.width, cell) * ceilOf(source.height, cell) *
         (ceilOf(target.width, cell) + kLanes * (2 * kMargin + 4)) * ceilOf(target.height, cell);
}

std::size_t Nearness::cellOf(int column, int row) const {
  return static_cast<std::size_t>(row) * stride_ +
         static_cast<std::size_t>(column - first_ + kMargin);
}

void Nearness::addAround(std::int32_t* plane, int column, int row, int sign) {
  const __m128i signs = _mm_set1_epi32(sign);
  const int first = std::max(row - kReach, 0), last = std::min(row + kReach, rows_ - 1);
  for (int y = first; y <= last; ++y) {
    std::int32_t* counts = plane + cellOf(column - kReach, y);
    const int weights_at = (y - row + kReach) * kPaddedSide;
    const std::int32_t* weights = &kernel_[static_cast<std::size_t>(weights_at)];
    // Beyond a circle the weights are zeros.
    const int blank = kBlank[static_cast<std::size_t>(std::abs(y - row))];
    for (int x = blank; x < kSide - blank; x += 4) {
      auto* at = reinterpret_cast<__m128i*>(counts + x);
      const __m128i more = _mm_loadu_si128(reinterpret_cast<const __m128i*>(weights + x));
      _mm_storeu_si128(at, _mm_add_epi32(_mm_loadu_si128(at), _mm_sign_epi32(more, signs)));
    }
  }
}

void Nearness::change(int x, int y, std::int32_t centre, int sign) {
  std::int32_t* plane = &counts_[planeOf(centre)];
  // Where the target wraps, its images beside it count as well.
  const int around = wraps_ ? 1 : 0;
  for (int j = -around; j <= around; ++j)
    for (int i = -around; i <= around; ++i) {
      const int column = x / cell_px_ + i * target_columns_, row = y / cell_px_ + j * rows_;
      if (column >= first_ - kReach && column < first_ + columns_ + kReach)
        addAround(plane, column, row, sign);
    }
}

}  // namespace patina::patch
