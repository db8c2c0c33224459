// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/synthesis/quilting/low_frequency.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "processing/image/warp.h"

namespace patina::quilting {
namespace {

constexpr double kCellsASigma = 4;
constexpr float kGainMax = 8;

// Where sample i of `length` lies among `cells` cell centres, and how far to the next.
struct Between {
  int cell = 0, next = 0;
  float share = 0;  // of the next
};
Between between(int i, int length, int cells) {
  const double at = std::clamp((i + 0.5) * cells / length - 0.5, 0.0, cells - 1.0);
  const int cell = static_cast<int>(at);
  return {cell, std::min(cell + 1, cells - 1), static_cast<float>(at - cell)};
}

// rows * grid * columns^t, channel by channel.
Image<float> smoothed(const Image<float>& grid, const std::vector<double>& rows,
                      const std::vector<double>& columns) {
  const int w = grid.width(), h = grid.height(), channels = grid.channels();
  Image<float> across(w, h, channels), out(w, h, channels);
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x)
      for (int c = 0; c < channels; ++c) {
        double sum = 0;
        for (int i = 0; i < w; ++i) sum += columns[x * w + i] * grid.at(i, y, c);
        across.at(x, y, c) = static_cast<float>(sum);
      }
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x)
      for (int c = 0; c < channels; ++c) {
        double sum = 0;
        for (int i = 0; i < h; ++i) sum += rows[y * h + i] * across.at(x, i, c);
        out.at(x, y, c) = static_cast<float>(sum);
      }
  return out;
}

// To mean / value, in place.
void invertAgainstMean(Image<float>& low) {
  const int channels = low.channels();
  for (int c = 0; c < channels; ++c) {
    double sum = 0;
    for (std::size_t i = c; i < low.texels().size(); i += channels) sum += low.texels()[i];
    const float mean = static_cast<float>(sum * channels / low.texels().size());
    for (std::size_t i = c; i < low.texels().size(); i += channels) {
      float& v = low.texels()[i];
      v = mean > 0 ? mean / std::clamp(v, mean / kGainMax, mean * kGainMax) : 1;
    }
  }
}

void scale(std::uint16_t& sample, float gain) {
  sample = static_cast<std::uint16_t>(std::min(65535.0f, sample * gain + 0.5f));
}
void scale(float& sample, float gain) { sample *= gain; }

}  // namespace

std::vector<double> localLinearSmoother(int n, double sigma) {
  std::vector<double> smoother(static_cast<std::size_t>(n) * n);
  for (int i = 0; i < n; ++i) {
    double s0 = 0, s1 = 0, s2 = 0;
    for (int j = 0; j < n; ++j) {
      const double d = j - i, weight = std::exp(-0.5 * d * d / (sigma * sigma));
      s0 += weight;
      s1 += weight * d;
      s2 += weight * d * d;
    }
    const double determinant = s0 * s2 - s1 * s1;
    for (int j = 0; j < n; ++j) {
      const double d = j - i, weight = std::exp(-0.5 * d * d / (sigma * sigma));
      smoother[static_cast<std::size_t>(i) * n + j] =
          determinant > 0 ? weight * (s2 - s1 * d) / determinant : weight / s0;
    }
  }
  return smoother;
}

LowFrequency::LowFrequency(const ttf::TtfReader& input, double sigma_px, Progress& progress)
    : size_{input.info().width, input.info().height} {
  PATINA_CHECK(sigma_px >= 2);
  const auto cellsAlong = [&](int length) {
    return std::clamp(static_cast<int>(std::ceil(length * kCellsASigma / sigma_px)), 1, length);
  };
  const SizePx cells{cellsAlong(size_.width), cellsAlong(size_.height)};
  const auto rows = localLinearSmoother(cells.height, sigma_px * cells.height / size_.height);
  const auto columns = localLinearSmoother(cells.width, sigma_px * cells.width / size_.width);
  progress.begin("low frequency", input.info().frames);
  for (int t = 0; t < input.info().frames; ++t) {
    const Image<float> frame = input.linearFrame(t);
    gains_.push_back(smoothed(resizeArea(frame.view(), cells), rows, columns));
    invertAgainstMean(gains_.back());
    progress.step();
  }
}

template <class T>
void LowFrequency::multiply(int t, RectPx region, SizePx whole, bool inverse, T* samples,
                            std::ptrdiff_t row_stride) const {
  const Image<float>& grid = gains_[t];
  const int channels = grid.channels();
  std::vector<Between> columns;
  for (int x = 0; x < region.width; ++x)
    columns.push_back(between(region.x + x, whole.width, grid.width()));
  tbb::parallel_for(0, region.height, [&](int y) {
    const Between row = between(region.y + y, whole.height, grid.height());
    std::vector<float> line(static_cast<std::size_t>(grid.width()) * channels);
    const float *above = grid.view().row(row.cell), *below = grid.view().row(row.next);
    for (std::size_t i = 0; i < line.size(); ++i)
      line[i] = above[i] + row.share * (below[i] - above[i]);
    T* sample = samples + y * row_stride;
    for (const Between& column : columns)
      for (int c = 0; c < channels; ++c, ++sample) {
        const float left = line[column.cell * channels + c];
        const float gain = left + column.share * (line[column.next * channels + c] - left);
        scale(*sample, inverse ? 1 / gain : gain);
      }
  });
}

void LowFrequency::takeOut(int t, RectPx region, std::uint16_t* samples) const {
  multiply(t, region, size_, false, samples, region.width * gains_[t].channels());
}
void LowFrequency::takeOut(int t, RectPx region, float* samples) const {
  multiply(t, region, size_, false, samples, region.width * gains_[t].channels());
}
void LowFrequency::putBack(int t, ImageView<std::uint16_t> frame) const {
  multiply(t, {0, 0, frame.width, frame.height}, frame.size(), true, frame.data, frame.row_stride);
}
void LowFrequency::putBack(int t, ImageView<float> frame) const {
  multiply(t, {0, 0, frame.width, frame.height}, frame.size(), true, frame.data, frame.row_stride);
}

}  // namespace patina::quilting
