// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/synthesis/quilting/seam_statistics.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace patina::quilting {
namespace {

constexpr std::int64_t kPairsLeast = 16;

struct Sums {
  double seam = 0, inside = 0;
  std::int64_t seam_pairs = 0, inside_pairs = 0;

  void add(const Sums& other) {
    seam += other.seam;
    inside += other.inside;
    seam_pairs += other.seam_pairs;
    inside_pairs += other.inside_pairs;
  }
  double ratio() const {
    if (seam_pairs == 0 || inside_pairs == 0 || inside == 0) return 0;
    return (seam / static_cast<double>(seam_pairs)) / (inside / static_cast<double>(inside_pairs));
  }
};
struct Directions {
  Sums across, down;
};

void addPair(ImageView<const float> result, const Quilt& quilt, int x, int y, int step_x,
             int step_y, Sums& sums) {
  const auto a = result.texel(x, y), b = result.texel(x + step_x, y + step_y);
  double squares = 0;
  for (std::size_t c = 0; c < a.size(); ++c) squares += (a[c] - b[c]) * (a[c] - b[c]);
  const bool inside = quilt.isWhole(x, y, x + step_x, y + step_y, step_x, step_y);
  (inside ? sums.inside : sums.seam) += std::sqrt(squares);
  ++(inside ? sums.inside_pairs : sums.seam_pairs);
}

Directions gradients(ImageView<const float> result, const Quilt& quilt) {
  PATINA_CHECK(result.size() == quilt.source_xy.size());
  const int width = quilt.source_xy.width(), height = quilt.source_xy.height();
  std::vector<Directions> rows(height);  // summed in order below, whatever the threads do
  tbb::parallel_for(0, height, [&](int y) {
    for (int x = 0; x < width; ++x) {
      if (x + 1 < width) addPair(result, quilt, x, y, 1, 0, rows[y].across);
      if (y + 1 < height) addPair(result, quilt, x, y, 0, 1, rows[y].down);
    }
  });
  Directions sum;
  for (const Directions& r : rows) {
    sum.across.add(r.across);
    sum.down.add(r.down);
  }
  return sum;
}

// Over what of each square lies within the image.
Image<float> areaMeans(ImageView<const float> image, int radius) {
  const int channels = image.channels;
  Image<float> rows(image.width, image.height, channels), out(rows);
  const auto average = [&](int count, int length, const auto& in, const auto& to) {
    tbb::parallel_for(0, count, [&](int line) {
      for (int c = 0; c < channels; ++c) {
        std::vector<double> sum(length + 1);
        for (int i = 0; i < length; ++i) sum[i + 1] = sum[i] + in(line, i, c);
        for (int i = 0; i < length; ++i) {
          const int first = std::max(0, i - radius), end = std::min(length, i + radius + 1);
          to(line, i, c) = static_cast<float>((sum[end] - sum[first]) / (end - first));
        }
      }
    });
  };
  average(
      image.height, image.width, [&](int y, int x, int c) { return image.at(x, y, c); },
      [&](int y, int x, int c) -> float& { return rows.at(x, y, c); });
  average(
      image.width, image.height, [&](int x, int y, int c) { return rows.at(x, y, c); },
      [&](int x, int y, int c) -> float& { return out.at(x, y, c); });
  return out;
}

}  // namespace

double seamRatio(ImageView<const float> result, const Quilt& quilt) {
  const Directions found = gradients(result, quilt);
  Sums all = found.across;
  all.add(found.down);
  return all.ratio();
}

double seamRatioOfAreas(ImageView<const float> result, const Quilt& quilt, int radius_px) {
  const Directions found = gradients(areaMeans(result, radius_px).view(), quilt);
  double largest = 0;
  for (const Sums& s : {found.across, found.down})
    if (s.seam_pairs >= kPairsLeast) largest = std::max(largest, s.ratio());
  return largest;
}

}  // namespace patina::quilting
