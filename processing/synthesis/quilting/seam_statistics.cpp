// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/synthesis/quilting/seam_statistics.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <utility>
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

double distance(std::span<const float> a, std::span<const float> b) {
  float squares = 0;
  for (std::size_t c = 0; c < a.size(); ++c) squares += (a[c] - b[c]) * (a[c] - b[c]);
  return std::sqrt(squares);
}

void addPair(ImageView<const float> result, const Quilt& quilt, int x, int y, int step_x,
             int step_y, Sums& sums) {
  const bool inside = quilt.isWhole(x, y, x + step_x, y + step_y, step_x, step_y);
  (inside ? sums.inside : sums.seam) +=
      distance(result.texel(x, y), result.texel(x + step_x, y + step_y));
  ++(inside ? sums.inside_pairs : sums.seam_pairs);
}

void addInPlace(ImageView<const float> result, const Quilt& quilt,
                std::span<const ImageView<const float>> sources, PointPx at, PointPx step,
                Sums& sums) {
  const PointPx to{at.x + step.x, at.y + step.y};
  if (quilt.isWhole(at.x, at.y, to.x, to.y, step.x, step.y)) return;
  double gradient = 0;
  int sides = 0;
  const auto addSide = [&](PointPx texel, int sign) {
    const auto block = static_cast<std::size_t>(quilt.block.at(texel.x, texel.y));
    const ImageView<const float>& source = sources[sources.size() == 1 ? 0 : block];
    const auto from = quilt.source_xy.view().texel(texel.x, texel.y);
    const int u = from[0] + sign * step.x, v = from[1] + sign * step.y;
    if (u < 0 || v < 0 || u >= source.width || v >= source.height) return;
    gradient += distance(source.texel(from[0], from[1]), source.texel(u, v));
    ++sides;
  };
  addSide(at, 1);
  addSide(to, -1);
  if (sides == 0) return;
  sums.seam += distance(result.texel(at.x, at.y), result.texel(to.x, to.y));
  sums.inside += gradient / sides;
  ++sums.seam_pairs;
  ++sums.inside_pairs;
}

Sums inPlace(ImageView<const float> result, const Quilt& quilt,
             std::span<const ImageView<const float>> sources) {
  const int width = quilt.source_xy.width(), height = quilt.source_xy.height();
  std::vector<Sums> rows(height);
  tbb::parallel_for(0, height, [&](int y) {
    for (int x = 0; x < width; ++x) {
      if (x + 1 < width) addInPlace(result, quilt, sources, {x, y}, {1, 0}, rows[y]);
      if (y + 1 < height) addInPlace(result, quilt, sources, {x, y}, {0, 1}, rows[y]);
    }
  });
  Sums sum;
  for (const Sums& r : rows) sum.add(r);
  return sum;
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
  Image<float> rows(image.width, image.height, channels), out(rows);  // zeros
  tbb::parallel_for(0, image.height, [&](int y) {
    std::vector<double> sum(static_cast<std::size_t>(image.width) + 1);
    for (int c = 0; c < channels; ++c) {
      for (int x = 0; x < image.width; ++x) sum[x + 1] = sum[x] + image.at(x, y, c);
      for (int x = 0; x < image.width; ++x) {
        const int first = std::max(0, x - radius), end = std::min(image.width, x + radius + 1);
        rows.at(x, y, c) = static_cast<float>((sum[end] - sum[first]) / (end - first));
      }
    }
  });
  tbb::parallel_for(0, image.height, [&](int y) {  // by whole rows, as they lie in memory
    const int first = std::max(0, y - radius), end = std::min(image.height, y + radius + 1);
    float* sum = out.view().row(y);
    const int samples = image.width * channels;
    for (int v = first; v < end; ++v) {
      const float* row = std::as_const(rows).view().row(v);
      for (int i = 0; i < samples; ++i) sum[i] += row[i];
    }
    const float share = 1 / static_cast<float>(end - first);
    for (int i = 0; i < samples; ++i) sum[i] *= share;
  });
  return out;
}

}  // namespace

double seamRatio(ImageView<const float> result, const Quilt& quilt) {
  const Directions found = gradients(result, quilt);
  Sums all = found.across;
  all.add(found.down);
  return all.ratio();
}

double seamRatioInPlace(ImageView<const float> result, const Quilt& quilt,
                        std::span<const ImageView<const float>> sources) {
  return inPlace(result, quilt, sources).ratio();
}

double seamSelection(ImageView<const float> source, const Quilt& quilt) {
  const Image<float> result = applyQuilt(source, quilt);
  const Directions everywhere = gradients(result.view(), quilt);
  Sums all = everywhere.across;
  all.add(everywhere.down);
  const Sums there = inPlace(result.view(), quilt, {&source, 1});
  const Sums selection{there.inside, all.inside, there.inside_pairs, all.inside_pairs};
  return selection.ratio();
}

double seamRatioOfAreas(ImageView<const float> result, const Quilt& quilt, int radius_px) {
  const Directions found = gradients(areaMeans(result, radius_px).view(), quilt);
  double largest = 0;
  for (const Sums& s : {found.across, found.down})
    if (s.seam_pairs >= kPairsLeast) largest = std::max(largest, s.ratio());
  return largest;
}

}  // namespace patina::quilting
