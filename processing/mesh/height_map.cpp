// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/mesh/height_map.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

namespace patina::mesh {
namespace {

// Heights beyond the edge are those of the edge.
class Surface {
 public:
  explicit Surface(const HeightMap& map) : map_(map.height_mm), step_(map.mm_per_texel) {}

  int width() const { return map_.width; }
  int height() const { return map_.height; }
  double at(int x, int y) const {
    return map_.at(std::clamp(x, 0, map_.width - 1), std::clamp(y, 0, map_.height - 1));
  }
  double along(double x, double y) const {  // bilinear
    const int left = static_cast<int>(std::floor(x)), top = static_cast<int>(std::floor(y));
    const double u = x - left, v = y - top;
    return (1 - v) * ((1 - u) * at(left, top) + u * at(left + 1, top)) +
           v * ((1 - u) * at(left, top + 1) + u * at(left + 1, top + 1));
  }
  struct Slopes {
    double x, y;  // of the height; y up
  };
  Slopes slopes(int x, int y) const {
    return {(at(x + 1, y) - at(x - 1, y)) / (spanX(x) * step_),
            (at(x, y - 1) - at(x, y + 1)) / (spanY(y) * step_)};
  }
  struct Bends {
    double xx, yy, xy;
  };
  Bends bends(int x, int y) const {
    const double here = at(x, y), square = step_ * step_;
    return {
        (at(x + 1, y) - 2 * here + at(x - 1, y)) / square,
        (at(x, y + 1) - 2 * here + at(x, y - 1)) / square,
        (at(x + 1, y - 1) - at(x - 1, y - 1) - at(x + 1, y + 1) + at(x - 1, y + 1)) / (4 * square)};
  }
  // Of a texel's centre, from the middle of the map.
  std::array<double, 3> place(int x, int y) const {
    return {(x + 0.5 - width() / 2.0) * step_, (height() / 2.0 - y - 0.5) * step_, at(x, y)};
  }
  double step() const { return step_; }
  double highest() const {
    double top = at(0, 0);
    for (int y = 0; y < height(); ++y)
      for (int x = 0; x < width(); ++x) top = std::max(top, at(x, y));
    return top;
  }

 private:
  double spanX(int x) const { return x > 0 && x + 1 < width() ? 2 : 1; }
  double spanY(int y) const { return y > 0 && y + 1 < height() ? 2 : 1; }

  ImageView<const float> map_;
  double step_;
};

template <class OfTexel>
Image<float> everywhere(const HeightMap& map, int channels, const OfTexel& of_texel) {
  map.check();
  const Surface surface(map);
  Image<float> out(surface.width(), surface.height(), channels);
  tbb::parallel_for(0, surface.height(), [&](int y) {
    for (int x = 0; x < surface.width(); ++x) of_texel(surface, x, y, &out.at(x, y));
  });
  return out;
}

std::array<double, 3> normalAt(const Surface& surface, int x, int y) {
  const auto [sx, sy] = surface.slopes(x, y);
  return unitOf({-sx, -sy, 1});
}

struct Towards {
  std::array<double, 3> direction;
  double distance_mm;
};
Towards towards(const Surface& surface, const Lamp& lamp, int x, int y) {
  if (lamp.directional) return {unitOf(lamp.at), 1e300};
  const std::array<double, 3> from = surface.place(x, y);
  const std::array<double, 3> way{lamp.at[0] - from[0], lamp.at[1] - from[1], lamp.at[2] - from[2]};
  return {unitOf(way), std::hypot(way[0], way[1], way[2])};
}

// Walks a texel at a time over the grid until it is above everything.
bool isHidden(const Surface& surface, int x, int y, const Towards& light, double highest) {
  const auto [dx, dy, dz] = light.direction;
  if (dz <= 0) return true;
  const double across = std::hypot(dx, dy);
  if (across < 1e-12) return false;
  const double rise = dz / across * surface.step(), u = dx / across, v = -dy / across;
  const double start = surface.at(x, y);
  const double steps =
      std::min({(highest - start) / rise, light.distance_mm * across / surface.step(),
                double(surface.width()) + surface.height()});
  for (int i = 1; i <= steps; ++i) {
    const double px = x + u * i, py = y + v * i;
    if (px < 0 || py < 0 || px > surface.width() - 1 || py > surface.height() - 1) return false;
    if (surface.along(px, py) > start + rise * i + 1e-6 * surface.step()) return true;
  }
  return false;
}

}  // namespace

void HeightMap::check() const {
  if (height_mm.channels != 1 || height_mm.empty())
    throw ProcessingError(
        Exit::kUsage, "a height map has one channel, not " + std::to_string(height_mm.channels));
  if (!(mm_per_texel > 0) || !std::isfinite(mm_per_texel))
    throw ProcessingError(Exit::kUsage, "a height map's texels are " +
                                            std::to_string(mm_per_texel) +
                                            " mm apart; allowed: above 0");
  for (int y = 0; y < height_mm.height; ++y)
    for (int x = 0; x < height_mm.width; ++x)
      if (!std::isfinite(height_mm.at(x, y)))
        throw ProcessingError(Exit::kUsage, "the height map has no number at " + std::to_string(x) +
                                                "," + std::to_string(y));
}

Image<float> normalsOf(const HeightMap& map) {
  return everywhere(map, 3, [](const Surface& surface, int x, int y, float* out) {
    const std::array<double, 3> n = normalAt(surface, x, y);
    for (std::size_t c = 0; c < 3; ++c) out[c] = static_cast<float>(n[c]);
  });
}

Image<float> slopeOf(const HeightMap& map) {
  return everywhere(map, 1, [](const Surface& surface, int x, int y, float* out) {
    const auto [sx, sy] = surface.slopes(x, y);
    *out = static_cast<float>(std::atan(std::hypot(sx, sy)) * 180 / std::numbers::pi);
  });
}

Image<float> meanCurvatureOf(const HeightMap& map) {
  return everywhere(map, 1, [](const Surface& surface, int x, int y, float* out) {
    const auto [p, q] = surface.slopes(x, y);
    const auto [xx, yy, xy] = surface.bends(x, y);
    const double sum = (1 + q * q) * xx - 2 * p * q * xy + (1 + p * p) * yy;
    *out = static_cast<float>(-sum / (2 * std::pow(1 + p * p + q * q, 1.5)));
  });
}

Image<float> lightRateOf(const HeightMap& map, const Lamp& lamp) {
  return everywhere(map, 1, [&](const Surface& surface, int x, int y, float* out) {
    const std::array<double, 3> n = normalAt(surface, x, y);
    const auto [to, distance] = towards(surface, lamp, x, y);
    const double cosine = std::max(0.0, n[0] * to[0] + n[1] * to[1] + n[2] * to[2]);
    const double r = lamp.directional ? 1 : distance, light = cosine / (r * r);
    *out = static_cast<float>(light * light);
  });
}

Image<float> shadowOf(const HeightMap& map, const Lamp& lamp, const ShadowOptions& options) {
  map.check();
  const double highest = Surface(map).highest();
  const std::vector<Lamp> lamps = spreadOf(lamp, options);
  return everywhere(map, 1, [&](const Surface& surface, int x, int y, float* out) {
    int seen = 0;
    for (const Lamp& one : lamps)
      seen += !isHidden(surface, x, y, towards(surface, one, x, y), highest);
    *out = static_cast<float>(seen) / static_cast<float>(options.rays);
  });
}

Image<float> skyShareOf(const HeightMap& map, double reach_mm, int directions) {
  if (!(reach_mm > 0) || directions < 4 || directions > 1024)
    throw ProcessingError(Exit::kUsage,
                          "occlusion looks further than 0 mm, in 4 to 1024 directions");
  return everywhere(map, 1, [&](const Surface& surface, int x, int y, float* out) {
    const double here = surface.at(x, y);
    const int steps = std::max(1, static_cast<int>(reach_mm / surface.step()));
    double open = 0;
    for (int d = 0; d < directions; ++d) {
      const double angle = 2 * std::numbers::pi * (d + 0.5) / directions;
      const double u = std::cos(angle), v = std::sin(angle);
      double steepest = 0;
      for (int i = 1; i <= steps; ++i) {
        const double px = x + u * i, py = y + v * i;
        if (px < 0 || py < 0 || px > surface.width() - 1 || py > surface.height() - 1) break;
        steepest = std::max(steepest, (surface.along(px, py) - here) / (i * surface.step()));
      }
      open += 1 / (1 + steepest * steepest);  // cos^2 of the horizon's height
    }
    *out = static_cast<float>(open / directions);
  });
}

}  // namespace patina::mesh
