// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/image/warp.h"

#include <cmath>

#include "processing/image/encoding.h"
#include "processing/image/parallel_rows.h"

namespace patina {
namespace {

// The texels of one axis that an output texel mixes: `first` and the weights after it.
struct Mix {
  int first = 0;
  std::vector<float> weights;
};

std::vector<Mix> mixesOf(int from, int to) {
  std::vector<Mix> out(static_cast<std::size_t>(to));
  const double scale = static_cast<double>(from) / to;
  for (int i = 0; i < to; ++i) {
    Mix& mix = out[i];
    if (scale >= 1) {
      const double begin = i * scale, end = std::min<double>((i + 1) * scale, from);
      mix.first = static_cast<int>(begin);
      for (int s = mix.first; s < from && s < end - 1e-9; ++s)
        mix.weights.push_back(static_cast<float>(
            (std::min<double>(s + 1, end) - std::max<double>(s, begin)) / (end - begin)));
    } else {
      const double at = std::clamp((i + 0.5) * scale - 0.5, 0.0, from - 1.0);
      mix.first = std::min(static_cast<int>(at), std::max(from - 2, 0));
      const auto part = static_cast<float>(at - mix.first);
      mix.weights = {1 - part};
      if (from > 1) mix.weights.push_back(part);
    }
  }
  return out;
}

}  // namespace

Image<float> resizeArea(ImageView<const float> in, SizePx size) {
  PATINA_CHECK(!in.empty() && size.width > 0 && size.height > 0);
  if (in.size() == size) return copyOf(in);
  const auto across = mixesOf(in.width, size.width), down = mixesOf(in.height, size.height);
  const int channels = in.channels;
  Image<float> narrow(size.width, in.height, channels), out(size.width, size.height, channels);
  const ImageView<float> middle = narrow.view(), to = out.view();
  forEachRow(in.height, std::int64_t{2} * in.width * channels, [&](int y) {
    float* row = middle.row(y);
    for (const Mix& mix : across)
      for (int c = 0; c < channels; ++c) {
        const float* from = in.row(y) + static_cast<std::ptrdiff_t>(mix.first) * channels + c;
        float sum = 0;
        for (std::size_t i = 0; i < mix.weights.size(); ++i)
          sum += mix.weights[i] * from[static_cast<std::ptrdiff_t>(i) * channels];
        *row++ = sum;
      }
  });
  const int row_samples = size.width * channels;
  forEachRow(size.height, std::int64_t{2} * row_samples, [&](int y) {
    const Mix& mix = down[y];
    float* row = to.row(y);
    for (std::size_t i = 0; i < mix.weights.size(); ++i) {
      const float* from = middle.row(mix.first + static_cast<int>(i));
      for (int x = 0; x < row_samples; ++x) row[x] += mix.weights[i] * from[x];
    }
  });
  return out;
}

Image<std::uint8_t> resizeSrgb(ImageView<const std::uint8_t> srgb, SizePx size) {
  if (srgb.size() == size) return copyOf(srgb);
  return encodeSrgb8(resizeArea(decodeSrgb(srgb).view(), size).view());
}

SizePx fitInside(SizePx picture, SizePx box) {
  PATINA_CHECK(picture.width > 0 && picture.height > 0);
  const double scale = std::min(static_cast<double>(box.width) / picture.width,
                                static_cast<double>(box.height) / picture.height);
  return {std::max(1, static_cast<int>(std::lround(picture.width * scale))),
          std::max(1, static_cast<int>(std::lround(picture.height * scale)))};
}

Image<float> warpBilinear(ImageView<const float> in,
                          const std::array<double, 9>& source_from_target, SizePx size,
                          float outside) {
  const auto& m = source_from_target;
  Image<float> out(size.width, size.height, in.channels, outside);
  const ImageView<float> to = out.view();
  forEachRow(size.height, std::int64_t{12} * size.width * in.channels, [&](int y) {
    for (int x = 0; x < size.width; ++x) {
      const double w = m[6] * x + m[7] * y + m[8];
      const double sx = (m[0] * x + m[1] * y + m[2]) / w, sy = (m[3] * x + m[4] * y + m[5]) / w;
      if (!(sx >= 0 && sy >= 0 && sx <= in.width - 1 && sy <= in.height - 1)) continue;
      const int x0 = std::min(static_cast<int>(sx), std::max(in.width - 2, 0));
      const int y0 = std::min(static_cast<int>(sy), std::max(in.height - 2, 0));
      const int x1 = std::min(x0 + 1, in.width - 1), y1 = std::min(y0 + 1, in.height - 1);
      const auto fx = static_cast<float>(sx - x0), fy = static_cast<float>(sy - y0);
      for (int c = 0; c < in.channels; ++c)
        to.at(x, y, c) = (1 - fy) * ((1 - fx) * in.at(x0, y0, c) + fx * in.at(x1, y0, c)) +
                         fy * ((1 - fx) * in.at(x0, y1, c) + fx * in.at(x1, y1, c));
    }
  });
  return out;
}

}  // namespace patina
