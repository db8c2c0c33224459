// SPDX-License-Identifier: GPL-3.0-or-later
// How near light that came back is to the light there was.
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "processing/image/image.h"

namespace patina::calibration {

struct LightVerdict {
  double error_ratio = 0;       // RMS error over predicted RMS
  double worst_tile_bias = 0;   // of 32x32 pixels, share
  double worst_level_bias = 0;  // of 1,000 pixels of one level
  double worst_level = 0;
  int pixels = 0;
};

// [h][w][1] each.
inline LightVerdict judge(const Image<float>& light, const Image<float>& truth,
                          const Image<float>& variance, const std::vector<bool>& left_out) {
  LightVerdict verdict;
  constexpr double kLeast = 0.05;  // of full well
  double ratio = 0;
  std::vector<std::pair<float, float>> by_level;  // truth, error
  for (int y0 = 0; y0 + 32 <= light.height(); y0 += 16)
    for (int x0 = 0; x0 + 32 <= light.width(); x0 += 16) {
      double error = 0, sum = 0;
      int count = 0;
      for (int y = y0; y < y0 + 32; ++y)
        for (int x = x0; x < x0 + 32; ++x) {
          if (truth.at(x, y) < kLeast || left_out[static_cast<std::size_t>(y) * light.width() + x])
            continue;
          error += light.at(x, y) - truth.at(x, y);
          sum += truth.at(x, y);
          ++count;
        }
      if (count >= 990)
        verdict.worst_tile_bias = std::max(verdict.worst_tile_bias, std::abs(error / sum));
    }
  for (std::size_t k = 0; k < left_out.size(); ++k) {
    if (left_out[k]) continue;
    const float t = truth.texels()[k], error = light.texels()[k] - t;
    ratio += static_cast<double>(error) * error / variance.texels()[k];
    ++verdict.pixels;
    if (t >= kLeast) by_level.emplace_back(t, error);
  }
  verdict.error_ratio = std::sqrt(ratio / verdict.pixels);
  std::ranges::sort(by_level);
  for (std::size_t k = 0; k + 1000 <= by_level.size(); k += 1000) {
    double error = 0, sum = 0;
    for (std::size_t i = k; i < k + 1000; ++i) {
      error += by_level[i].second;
      sum += by_level[i].first;
    }
    if (std::abs(error / sum) > verdict.worst_level_bias) {
      verdict.worst_level_bias = std::abs(error / sum);
      verdict.worst_level = sum / 1000;
    }
  }
  return verdict;
}

}  // namespace patina::calibration
