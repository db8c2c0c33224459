// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/image/pixel_map.h"

#include <cmath>
#include <limits>

#include "processing/image/parallel_rows.h"

namespace patina {
namespace {

constexpr float kUnseen = std::numeric_limits<float>::quiet_NaN();
constexpr double kWidestPx = 64;  // a texel that covers more is sampled as if it covered this much

struct Place {
  double x = 0, y = 0;
};

// Within the area of the pixels: half a pixel around the outer centres. False for NaN.
bool within(SizePx size, Place p) {
  return p.x >= -0.5 && p.y >= -0.5 && p.x <= size.width - 0.5 && p.y <= size.height - 0.5;
}

template <class Step>
PixelMap moved(const PixelMap& map, const Step& step) {
  PixelMap out{Image<float>(map.size().width, map.size().height, 2, kUnseen)};
  const ImageView<const float> from = map.source_px.view();
  const ImageView<float> to = out.source_px.view();
  forEachRow(from.height, std::int64_t{20} * from.width, [&](int y) {
    for (int x = 0; x < from.width; ++x) {
      const Place next = step(Place{from.at(x, y, 0), from.at(x, y, 1)});
      to.at(x, y, 0) = static_cast<float>(next.x);
      to.at(x, y, 1) = static_cast<float>(next.y);
    }
  });
  return out;
}

double keys(double t) {
  t = std::abs(t);
  if (t < 1) return (1.5 * t - 2.5) * t * t + 1;
  if (t < 2) return ((-0.5 * t + 2.5) * t - 4) * t + 2;
  return 0;
}

// The pixels of one axis that a texel mixes.
struct Taps {
  int first = 0;
  std::vector<float> weights;

  void place(double at, double width) {
    first = static_cast<int>(std::ceil(at - 2 * width));
    weights.resize(static_cast<std::size_t>(std::floor(at + 2 * width)) - first + 1);
    double sum = 0;
    for (std::size_t i = 0; i < weights.size(); ++i) {
      const double weight = keys((first + static_cast<double>(i) - at) / width);
      weights[i] = static_cast<float>(weight);
      sum += weight;
    }
    for (float& weight : weights) weight = static_cast<float>(weight / sum);
  }
};

// From the neighbours that are seen: what a texel covers along each axis of the source, in pixels.
Place footprint(ImageView<const float> map, int x, int y) {
  double squares[2] = {0, 0};
  const auto add = [&](int dx, int dy) {
    double step[2] = {0, 0};
    int seen = 0;
    for (const int side : {-1, 1}) {
      const int nx = x + side * dx, ny = y + side * dy;
      if (nx < 0 || ny < 0 || nx >= map.width || ny >= map.height) continue;
      if (std::isnan(map.at(nx, ny, 0))) continue;
      for (int i = 0; i < 2; ++i) step[i] += side * (map.at(nx, ny, i) - map.at(x, y, i));
      ++seen;
    }
    for (int i = 0; i < 2 && seen > 0; ++i) squares[i] += step[i] * step[i] / (seen * seen);
  };
  add(1, 0);
  add(0, 1);
  return {std::clamp(std::sqrt(squares[0]), 1.0, kWidestPx),
          std::clamp(std::sqrt(squares[1]), 1.0, kWidestPx)};
}

void mix(ImageView<const float> in, const Taps& across, const Taps& down, std::span<float> out) {
  std::fill(out.begin(), out.end(), 0.0f);
  for (std::size_t j = 0; j < down.weights.size(); ++j) {
    const float* row = in.row(std::clamp(down.first + static_cast<int>(j), 0, in.height - 1));
    for (std::size_t i = 0; i < across.weights.size(); ++i) {
      const int x = std::clamp(across.first + static_cast<int>(i), 0, in.width - 1);
      const float weight = down.weights[j] * across.weights[i];
      const float* from = row + static_cast<std::ptrdiff_t>(x) * in.channels;
      for (std::size_t c = 0; c < out.size(); ++c) out[c] += weight * from[c];
    }
  }
}

}  // namespace

PixelMap identityMap(RectPx region) {
  PixelMap map{Image<float>(region.width, region.height, 2)};
  for (int y = 0; y < region.height; ++y)
    for (int x = 0; x < region.width; ++x) {
      map.source_px.at(x, y, 0) = static_cast<float>(region.x + x);
      map.source_px.at(x, y, 1) = static_cast<float>(region.y + y);
    }
  return map;
}

PixelMap composed(const PixelMap& map, const std::array<double, 9>& next_from_source) {
  const auto& m = next_from_source;
  return moved(map, [&m](Place p) {
    const double w = m[6] * p.x + m[7] * p.y + m[8];
    if (!(w > 0)) return Place{kUnseen, kUnseen};
    return Place{(m[0] * p.x + m[1] * p.y + m[2]) / w, (m[3] * p.x + m[4] * p.y + m[5]) / w};
  });
}

PixelMap composed(const PixelMap& map, const PixelMap& next_from_source) {
  const ImageView<const float> next = next_from_source.source_px.view();
  PATINA_CHECK(next.width >= 2 && next.height >= 2);
  return moved(map, [&next](Place p) {
    if (!within(next.size(), p)) return Place{kUnseen, kUnseen};
    // In the outer half pixel the innermost step goes on.
    const int x = std::clamp(static_cast<int>(p.x), 0, next.width - 2);
    const int y = std::clamp(static_cast<int>(p.y), 0, next.height - 2);
    const double fx = p.x - x, fy = p.y - y;
    const auto value = [&](int i) {
      return (1 - fy) * ((1 - fx) * next.at(x, y, i) + fx * next.at(x + 1, y, i)) +
             fy * ((1 - fx) * next.at(x, y + 1, i) + fx * next.at(x + 1, y + 1, i));
    };
    return Place{value(0), value(1)};
  });
}

double meanStep(const PixelMap& map) {
  const ImageView<const float> from = map.source_px.view();
  double sum = 0;
  std::int64_t count = 0;
  for (int y = 0; y < from.height; ++y)
    for (int x = 0; x + 1 < from.width; ++x) {
      const double step = std::hypot(from.at(x + 1, y, 0) - from.at(x, y, 0),
                                     from.at(x + 1, y, 1) - from.at(x, y, 1));
      if (std::isnan(step)) continue;
      sum += step;
      ++count;
    }
  return count > 0 ? sum / static_cast<double>(count) : static_cast<double>(kUnseen);
}

Image<float> resample(ImageView<const float> in, const PixelMap& map, float outside) {
  PATINA_CHECK(!in.empty());
  const ImageView<const float> places = map.source_px.view();
  Image<float> out(places.width, places.height, in.channels, outside);
  const ImageView<float> to = out.view();
  forEachRow(places.height, std::int64_t{60} * places.width * in.channels, [&](int y) {
    Taps across, down;
    for (int x = 0; x < places.width; ++x) {
      const Place at{places.at(x, y, 0), places.at(x, y, 1)};
      if (!within(in.size(), at)) continue;
      const Place covered = footprint(places, x, y);
      across.place(at.x, covered.x);
      down.place(at.y, covered.y);
      mix(in, across, down, to.texel(x, y));
    }
  });
  return out;
}

}  // namespace patina
