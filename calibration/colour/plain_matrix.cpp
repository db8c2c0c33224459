// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/colour/plain_matrix.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>

namespace patina::calibration {

PlainMatrix plainMatrix(const SeenColours& seen, const ChartColours& expected) {
  cv::Matx33d normal, mixed;
  std::array<cv::Matx13d, kChartFields> from, to;
  for (int i = 0; i < kChartFields; ++i) {
    const Xyz xyz = xyzOf(expected[i]);
    const double weight = 1 / (xyz.y + 0.05);
    from[i] = weight * cv::Matx13d(seen[i].data());
    to[i] = weight * cv::Matx13d(xyz.x, xyz.y, xyz.z);
    normal += from[i].t() * from[i];
    mixed += from[i].t() * to[i];
  }
  PlainMatrix out;
  out.misfit = HUGE_VAL;
  cv::Matx33d matrix;
  if (!cv::solve(normal, mixed, matrix, cv::DECOMP_LU)) return out;
  double squares = 0;
  for (int i = 0; i < kChartFields; ++i) {
    const cv::Matx13d left = from[i] * matrix - to[i];
    squares += left.ddot(left);
  }
  if (!std::isfinite(squares)) return out;
  out.misfit = std::sqrt(squares / kChartFields);
  const cv::Matx33d rows = matrix.t();
  std::copy_n(rows.val, out.xyz_from_camera.size(), out.xyz_from_camera.begin());
  return out;
}

}  // namespace patina::calibration
