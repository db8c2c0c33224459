// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/patch/strip_cut.h"

#include <algorithm>
#include <vector>

namespace patina::patch {
namespace {

// `at(along, across)` over length x width.
template <class At>
double leastPath(int length, int width, const At& at) {
  if (length < 1 || width < 1) return 0;
  std::vector<double> sums(width), next(width);
  for (int along = 0; along < length; ++along) {
    for (int across = 0; across < width; ++across) {
      double least = sums[across];
      if (across > 0) least = std::min(least, sums[across - 1]);
      if (across + 1 < width) least = std::min(least, sums[across + 1]);
      next[across] = least + at(along, across);
    }
    sums.swap(next);
  }
  return *std::min_element(sums.begin(), sums.end());
}

}  // namespace

double cutAlongRows(ImageView<const double> difference, RectPx strip) {
  return leastPath(strip.height, strip.width, [&](int along, int across) {
    return difference.at(strip.x + across, strip.y + along);
  });
}

double cutAlongColumns(ImageView<const double> difference, RectPx strip) {
  return leastPath(strip.width, strip.height, [&](int along, int across) {
    return difference.at(strip.x + along, strip.y + across);
  });
}

}  // namespace patina::patch
