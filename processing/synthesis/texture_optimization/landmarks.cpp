// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/synthesis/texture_optimization/landmarks.h"

#include <immintrin.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <limits>
#include <utility>

namespace patina::texture_optimization {
namespace {

constexpr int kReachOfSide = 24, kElsewhereOfSide = 12, kSlackOfSide = 24;
constexpr std::int64_t kPairsMost = std::int64_t{1} << 22;
// A landmark's patches over the median: the farthest of them, and what hangs together with it
// (hysteresis). Lower, and there are landmarks everywhere: they keep out of one another's way at
// the cost of all else. One threshold misses small ones: few of their patches are that far.
constexpr float kSalient = 2.5, kBeside = 2.15;
constexpr int kLeastOfPatch = 8;  // a landmark's patches: that share of a patch's texels
constexpr float kUnknown = std::numeric_limits<float>::max();
constexpr std::size_t kSlices = 8;  // of the shifts, for threads

std::size_t texelsOf(SizePx size) {
  return static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height);
}

std::size_t indexOf(SizePx size, int x, int y) {
  return static_cast<std::size_t>(y) * static_cast<std::size_t>(size.width) +
         static_cast<std::size_t>(x);
}

// Distances of patches to what lies `shift` away, the least of each so far.
class NearestElsewhere {
 public:
  NearestElsewhere(ImageView<const std::int16_t> source, int reach)
      : source_(source),
        reach_(reach),
        width_(static_cast<std::size_t>(source.width)),
        columns_(width_),
        rows_(width_ * static_cast<std::size_t>(2 * reach + 1)),
        sums_(width_),
        least_(width_ * static_cast<std::size_t>(source.height), kUnknown) {}

  void compare(int dx, int dy) {
    const int side = 2 * reach_ + 1, first = std::max(0, -dx),
              last = std::min(source_.width, source_.width - dx);
    std::fill(columns_.begin(), columns_.end(), 0);
    for (int y = 0; y + dy < source_.height; ++y) {
      std::int32_t* row = &rows_[width_ * static_cast<std::size_t>(y % side)];
      if (y >= side)
        for (int x = first; x < last; ++x) columns_[static_cast<std::size_t>(x)] -= row[x];
      differences(y, dx, dy, first, last, row);
      for (int x = first; x < last; ++x) columns_[static_cast<std::size_t>(x)] += row[x];
      if (y + 1 >= side) settle(y - reach_, dx, dy, first, last);
    }
  }
  const std::vector<float>& least() const { return least_; }

 private:
  void differences(int y, int dx, int dy, int first, int last, std::int32_t* row) const {
    const std::int16_t* a = source_.data + y * source_.row_stride;
    const std::int16_t* b = source_.data + (y + dy) * source_.row_stride;
    const int n = source_.channels;
    int x = first;
    const auto squares = [&](int at) {  // of 8 components, in four sums
      const __m128i off =
          _mm_sub_epi16(_mm_loadu_si128(reinterpret_cast<const __m128i*>(a + at * 8)),
                        _mm_loadu_si128(reinterpret_cast<const __m128i*>(b + (at + dx) * 8)));
      return _mm_madd_epi16(off, off);
    };
    for (; n == 8 && x + 4 <= last; x += 4)
      _mm_storeu_si128(reinterpret_cast<__m128i*>(row + x),
                       _mm_hadd_epi32(_mm_hadd_epi32(squares(x), squares(x + 1)),
                                      _mm_hadd_epi32(squares(x + 2), squares(x + 3))));
    for (; x < last; ++x) {
      __m128i sum = _mm_setzero_si128();
      for (int c = 0; c < n; c += 4) {
        const __m128i off =
            _mm_sub_epi16(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(a + x * n + c)),
                          _mm_loadl_epi64(reinterpret_cast<const __m128i*>(b + (x + dx) * n + c)));
        sum = _mm_add_epi32(sum, _mm_madd_epi16(off, off));
      }
      row[x] = _mm_cvtsi128_si32(sum) + _mm_extract_epi32(sum, 1);
    }
  }

  void settle(int y, int dx, int dy, int first, int last) {
    float* here = &least_[width_ * static_cast<std::size_t>(y)];
    float* there = &least_[width_ * static_cast<std::size_t>(y + dy)] + dx;
    const int from = first + reach_, to = last - reach_;
    std::fill(sums_.begin(), sums_.end(), 0.0f);
    for (int i = -reach_; i <= reach_; ++i) {
      const std::int32_t* from_column = columns_.data() + i;
      for (int x = from; x < to; ++x)
        sums_[static_cast<std::size_t>(x)] += static_cast<float>(from_column[x]);
    }
    for (int x = from; x < to; ++x) here[x] = std::min(here[x], sums_[static_cast<std::size_t>(x)]);
    for (int x = from; x < to; ++x)
      there[x] = std::min(there[x], sums_[static_cast<std::size_t>(x)]);
  }

  ImageView<const std::int16_t> source_;
  int reach_;
  std::size_t width_;
  std::vector<std::int32_t> columns_, rows_;  // differences, summed over a patch's rows; its rows'
  std::vector<float> sums_, least_;           // of a row's patches; of all
};

// Of each patch to the nearest elsewhere; of the texels at the edge, where none is centred, what
// the patch beside them has.
std::vector<float> nearestElsewhere(ImageView<const std::int16_t> source, int reach, int away) {
  const std::int64_t texels = std::int64_t{source.width} * source.height;
  const std::int64_t step = 1 + texels * texels / 2 / kPairsMost;
  std::vector<NearestElsewhere> slices(kSlices, {source, reach});
  tbb::parallel_for(std::size_t{0}, kSlices, [&](std::size_t slice) {
    for (int dy = static_cast<int>(slice); dy < source.height; dy += kSlices)
      for (int dx = 1 - source.width; dx < source.width; ++dx)
        if (std::max(std::abs(dx), dy) > away && (dy > 0 || dx > 0) &&
            (dx + (step + 1) / 2 * dy + step * source.width) % step == 0)
          slices[slice].compare(dx, dy);
  });
  std::vector<float> least = slices[0].least();
  for (const NearestElsewhere& slice : slices)
    for (std::size_t i = 0; i < least.size(); ++i) least[i] = std::min(least[i], slice.least()[i]);
  std::vector<float> out;
  out.reserve(least.size());
  for (int y = 0; y < source.height; ++y)
    for (int x = 0; x < source.width; ++x)
      out.push_back(least[indexOf(source.size(), std::clamp(x, reach, source.width - 1 - reach),
                                  std::clamp(y, reach, source.height - 1 - reach))]);
  return out;
}

// Of what was compared with anything.
float medianOf(const std::vector<float>& distances) {
  std::vector<float> known;
  std::copy_if(distances.begin(), distances.end(), std::back_inserter(known),
               [](float v) { return v < kUnknown; });
  if (known.empty()) return kUnknown;
  const auto middle = known.begin() + static_cast<std::ptrdiff_t>(known.size() / 2);
  std::nth_element(known.begin(), middle, known.end());
  return *middle;
}

// All texels that hang together with the first one and hold.
template <class Holds>
std::vector<std::int32_t> connected(std::int32_t first, SizePx size, const Holds& holds) {
  std::vector<std::int32_t> out;
  const auto take = [&](std::int32_t at) {
    if (holds(at)) out.push_back(at);
  };
  take(first);
  for (std::size_t i = 0; i < out.size(); ++i) {
    const int x = out[i] % size.width, y = out[i] / size.width;
    for (int v = std::max(0, y - 1); v <= std::min(size.height - 1, y + 1); ++v)
      for (int u = std::max(0, x - 1); u <= std::min(size.width - 1, x + 1); ++u)
        take(v * size.width + u);
  }
  return out;
}

}  // namespace

std::int32_t Landmarks::at(int x, int y, SizePx sample) const {
  if (count == 0) return -1;
  const std::int64_t mine_x = std::int64_t{x} * size.width / sample.width,
                     mine_y = std::int64_t{y} * size.height / sample.height;
  return of[static_cast<std::size_t>(mine_y * size.width + mine_x)];
}

Landmarks landmarksOf(ImageView<const std::int16_t> source) {
  const int side = std::min(source.width, source.height), reach = std::max(1, side / kReachOfSide),
            away = std::max(2 * reach, side / kElsewhereOfSide),
            least = (2 * reach + 1) * (2 * reach + 1) / kLeastOfPatch;
  Landmarks out{.size = source.size()};
  if (side < 2 * reach + 1) return out;
  const std::vector<float> distances = nearestElsewhere(source, reach, away);
  const float median = std::max(1.0f, medianOf(distances));
  const auto isSalient = [&](std::int32_t at) {
    return distances[static_cast<std::size_t>(at)] >= kSalient * median;
  };
  std::vector<std::uint8_t> pending;
  for (const float v : distances) pending.push_back(v >= kBeside * median && v < kUnknown);
  out.of.assign(pending.size(), -1);
  for (std::int32_t first = 0; first < static_cast<std::int32_t>(pending.size()); ++first) {
    const std::vector<std::int32_t> members = connected(first, source.size(), [&](std::int32_t at) {
      return std::exchange(pending[static_cast<std::size_t>(at)], std::uint8_t{0}) != 0;
    });
    if (static_cast<int>(members.size()) < least ||
        std::none_of(members.begin(), members.end(), isSalient))
      continue;
    for (const std::int32_t member : members) out.of[static_cast<std::size_t>(member)] = out.count;
    ++out.count;
  }
  return out;
}

std::vector<patch::Labels::Copy> landmarksIn(const std::vector<std::int32_t>& shown, SizePx target,
                                             SizePx sample, const Landmarks& landmarks) {
  std::vector<std::int32_t> in_sample(texelsOf(sample), -1);
  const SizePx size = landmarks.size;
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
      if (const std::int32_t label = landmarks.at(x, y, size); label >= 0)
        in_sample[indexOf(sample, x * sample.width / size.width, y * sample.height / size.height)] =
            label;
  std::vector<patch::Labels::Copy> of(shown.size());
  for (int y = 0; y < target.height; ++y)
    for (int x = 0; x < target.width; ++x) {
      const std::size_t at = indexOf(target, x, y);
      of[at] = {in_sample[static_cast<std::size_t>(shown[at])], x - shown[at] % sample.width,
                y - shown[at] / sample.width};
    }
  std::vector<patch::Labels::Copy> out = of;
  for (int y = 0; y < target.height; ++y)
    for (int x = 0; x < target.width; ++x) {
      patch::Labels::Copy& copy = out[indexOf(target, x, y)];
      for (int v = std::max(0, y - 1); v <= std::min(target.height - 1, y + 1); ++v)
        for (int u = std::max(0, x - 1); u <= std::min(target.width - 1, x + 1); ++u)
          if (copy.label < 0) copy = of[indexOf(target, u, v)];
    }
  return out;
}

patch::Labels labelsOf(const Landmarks& landmarks, const std::vector<patch::Labels::Copy>& copies,
                       SizePx laid, int times, SizePx source, SizePx target, bool wraps) {
  patch::Labels out{.source = source,
                    .target = target,
                    .wraps = wraps,
                    .slack = std::min(source.width, source.height) / kSlackOfSide};
  for (int y = 0; y < source.height; ++y)
    for (int x = 0; x < source.width; ++x) out.of_source.push_back(landmarks.at(x, y, source));
  for (int y = 0; y < target.height; ++y)
    for (int x = 0; x < target.width; ++x) {
      patch::Labels::Copy copy = copies[indexOf(laid, std::min(x / times, laid.width - 1),
                                                std::min(y / times, laid.height - 1))];
      copy.x *= times;
      copy.y *= times;
      out.of_target.push_back(copy);
    }
  return out;
}

}  // namespace patina::texture_optimization
