// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/mosaic_blur.h"

#include <array>
#include <cmath>

#include "devices/twin/row_loop.h"

namespace patina::devices::twin {

namespace {

constexpr double kNoBlurPx = 0.05;  // less changes no number of a picture
constexpr double kFogBlur = 1.0 / 64;

// One side of the kernel, its middle first, over steps of two pixels.
std::vector<float> kernelOf(double sigma_px) {
  const int reach = static_cast<int>(std::ceil(3.5 * sigma_px / 2));
  std::vector<double> weights;
  double sum = 0;
  for (int k = 0; k <= reach; ++k) {
    weights.push_back(std::exp(-2.0 * k * k / (sigma_px * sigma_px)));
    sum += k == 0 ? weights[0] : 2 * weights.back();
  }
  std::vector<float> kernel;
  for (const double weight : weights) kernel.push_back(static_cast<float>(weight / sum));
  return kernel;
}

void blurRow(float* row, int width, const std::vector<float>& kernel, std::vector<float>& padded) {
  const int reach = 2 * (static_cast<int>(kernel.size()) - 1);
  const int whole = width + 2 * reach, last = reach + width;
  padded.resize(static_cast<std::size_t>(whole));
  for (int x = 0; x < reach; ++x) {
    padded[static_cast<std::size_t>(x)] = row[x & 1];
    padded[static_cast<std::size_t>(last) + x] = row[width - 2 + (x & 1)];
  }
  std::copy_n(row, width, padded.begin() + reach);
  const float* middle = padded.data() + reach;
  for (int x = 0; x < width; ++x) row[x] = kernel[0] * middle[x];
  for (std::size_t k = 1; k < kernel.size(); ++k) {
    const float *left = middle - 2 * k, *right = middle + 2 * k, weight = kernel[k];
    for (int x = 0; x < width; ++x) row[x] += weight * (left[x] + right[x]);
  }
}

}  // namespace

void blurMosaic(std::vector<float>& light, SizePx size, double sigma_px) {
  if (!(sigma_px > kNoBlurPx)) return;
  const std::vector<float> kernel = kernelOf(sigma_px);
  const int width = size.width, height = size.height;
  const auto rowOf = [&](std::vector<float>& of, int y) {
    return &of[static_cast<std::size_t>(y) * static_cast<std::size_t>(width)];
  };
  forRowBlocks(size, [&](int y0, int y1) {
    std::vector<float> padded;
    for (int y = y0; y < y1; ++y) blurRow(rowOf(light, y), width, kernel, padded);
  });
  std::vector<float> out(light.size());
  const auto inside = [&](int y) {
    return y < 0 ? y & 1 : y < height ? y : height - 2 + ((y - height) & 1);
  };
  forRowBlocks(size, [&](int y0, int y1) {
    for (int y = y0; y < y1; ++y) {
      float* to = rowOf(out, y);
      const float* from = rowOf(light, y);
      for (int x = 0; x < width; ++x) to[x] = kernel[0] * from[x];
      for (std::size_t k = 1; k < kernel.size(); ++k) {
        const int step = 2 * static_cast<int>(k);
        const float *above = rowOf(light, inside(y - step)),
                    *below = rowOf(light, inside(y + step));
        const float weight = kernel[k];
        for (int x = 0; x < width; ++x) to[x] += weight * (above[x] + below[x]);
      }
    }
  });
  light.swap(out);
}

void fogMosaic(std::vector<float>& light, SizePx size, double share) {
  if (!(share > 0)) return;
  const auto width = static_cast<std::size_t>(size.width);
  std::array<double, 4> sum{};  // one after the other: the same for any number of threads
  for (std::size_t k = 0; k < light.size(); ++k)
    sum[2 * (k / width % 2) + k % width % 2] += light[k];
  std::array<float, 4> mean;
  for (std::size_t c = 0; c < 4; ++c)
    mean[c] = static_cast<float>(sum[c] / (static_cast<double>(light.size()) / 4));
  blurMosaic(light, size, share * kFogBlur * size.width);
  const auto s = static_cast<float>(share);
  for (std::size_t k = 0; k < light.size(); ++k)
    light[k] += s * (mean[2 * (k / width % 2) + k % width % 2] - light[k]);
}

}  // namespace patina::devices::twin
