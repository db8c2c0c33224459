// SPDX-License-Identifier: GPL-3.0-or-later
// A chart drawn into a picture through a camera that is known: what tests hold estimates against.
#pragma once

#include <array>
#include <functional>

#include "calibration/colour/chart.h"
#include "calibration/colour/plain_matrix.h"
#include "processing/image/random.h"

namespace patina::calibration {

// A camera that mixes the colours of sRGB; full scale at 1.
inline Rgb plainCamera(const Xyz& colour) {
  const Matrix3 mixing{0.50, 0.22, 0.04, 0.12, 0.62, 0.14, 0.02, 0.20, 0.44};
  return mapped(mixing, mapped(linearSrgbFromXyz(), {colour.x, colour.y, colour.z}));
}

struct Drawn {
  ChartColours colours = chartColours(ChartEdition::kSince2014);
  SizePx size{640, 480};
  ChartCorners corners{{{120, 120}, {520, 120}, {520, 360}, {120, 360}}};  // pitch 80
  double field_share = 0.7;                                                // of the pitch
  std::function<Rgb(const Xyz&)> camera = plainCamera;
  // Light at a place of the grid, dark skin at (0, 0), black at (5, 3).
  std::function<double(double, double)> light = [](double, double) { return 1.0; };
  double noise = 0.001;  // sigma, share of full scale
};

inline SeenColours seenBy(const Drawn& drawn) {
  SeenColours out;
  for (int i = 0; i < kChartFields; ++i) out[i] = drawn.camera(xyzOf(drawn.colours[i]));
  return out;
}

// The corners must make a parallelogram: the drawing is affine.
inline Image<float> drawChart(const Drawn& drawn) {
  const Rgb ground = drawn.camera(xyzOf({45, 0, 0})), gap = drawn.camera(xyzOf({15, 0, 0}));
  const SeenColours fields = seenBy(drawn);
  const PlacePx o = drawn.corners[0];
  const double ax = (drawn.corners[1].x - o.x) / 5, ay = (drawn.corners[1].y - o.y) / 5,
               bx = (drawn.corners[3].x - o.x) / 3, by = (drawn.corners[3].y - o.y) / 3,
               area = ax * by - ay * bx;
  Image<float> out(drawn.size.width, drawn.size.height, 3);
  for (int y = 0; y < out.height(); ++y)
    for (int x = 0; x < out.width(); ++x) {
      const double u = ((x - o.x) * by - (y - o.y) * bx) / area,
                   v = ((y - o.y) * ax - (x - o.x) * ay) / area;
      const Rgb* colour = &ground;
      if (u > -0.6 && u < 5.6 && v > -0.6 && v < 3.6) {
        const int column = static_cast<int>(std::lround(u)), row = static_cast<int>(std::lround(v));
        const bool inside =
            column >= 0 && column < kChartColumns && row >= 0 && row < kChartRows &&
            std::max(std::abs(u - column), std::abs(v - row)) < drawn.field_share / 2;
        colour = inside ? &fields[row * kChartColumns + column] : &gap;
      }
      for (int c = 0; c < 3; ++c)
        out.at(x, y, c) = static_cast<float>(std::min(
            1.0, (*colour)[c] * drawn.light(u, v) + drawn.noise * gaussian(hashSeed(1, c, x, y))));
    }
  return out;
}

inline double farthest(const ChartCorners& a, const ChartCorners& b) {
  double most = 0;
  for (int i = 0; i < 4; ++i) most = std::max(most, std::hypot(a[i].x - b[i].x, a[i].y - b[i].y));
  return most;
}

}  // namespace patina::calibration
