// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/synthesis/quilting/seam_statistics.h"

#include <tbb/parallel_for.h>

#include <cmath>
#include <vector>

namespace patina::quilting {
namespace {

struct RowSums {
  double seam = 0, inside = 0;
  std::int64_t seam_pairs = 0, inside_pairs = 0;
};

void addPair(ImageView<const float> result, const Quilt& quilt, int x, int y, int step_x,
             int step_y, RowSums& sums) {
  const auto a = result.texel(x, y), b = result.texel(x + step_x, y + step_y);
  double squares = 0;
  for (std::size_t c = 0; c < a.size(); ++c) squares += (a[c] - b[c]) * (a[c] - b[c]);
  const bool inside = quilt.isWhole(x, y, x + step_x, y + step_y, step_x, step_y);
  (inside ? sums.inside : sums.seam) += std::sqrt(squares);
  ++(inside ? sums.inside_pairs : sums.seam_pairs);
}

}  // namespace

double seamRatio(ImageView<const float> result, const Quilt& quilt) {
  PATINA_CHECK(result.size() == quilt.source_xy.size());
  const int width = quilt.source_xy.width(), height = quilt.source_xy.height();
  std::vector<RowSums> rows(height);  // summed in order below, whatever the threads do
  tbb::parallel_for(0, height, [&](int y) {
    for (int x = 0; x < width; ++x) {
      if (x + 1 < width) addPair(result, quilt, x, y, 1, 0, rows[y]);
      if (y + 1 < height) addPair(result, quilt, x, y, 0, 1, rows[y]);
    }
  });
  RowSums sum;
  for (const RowSums& r : rows) {
    sum.seam += r.seam;
    sum.inside += r.inside;
    sum.seam_pairs += r.seam_pairs;
    sum.inside_pairs += r.inside_pairs;
  }
  if (sum.seam_pairs == 0 || sum.inside_pairs == 0 || sum.inside == 0) return 0;
  return (sum.seam / sum.seam_pairs) / (sum.inside / sum.inside_pairs);
}

}  // namespace patina::quilting
