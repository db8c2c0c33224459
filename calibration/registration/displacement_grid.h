// SPDX-License-Identifier: GPL-3.0-or-later
// Displacements of points a spacing apart, found from what pixels between them say.
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "processing/image/image.h"

namespace patina::calibration {

// Of a displacement d: d^T H d / 2 - r^T d; H is xx, xy, yy, r is x, y; in 1/px^2 and 1/px. C is H
// by what both pictures show, so that noise adds nothing on average: H itself, where there is none.
struct PixelSays {
  double xx = 0, xy = 0, yy = 0, x = 0, y = 0;
  double shared_xx = 0, shared_xy = 0, shared_yy = 0;
};

// Bilinear between its points, of which (i, j) lies at (i, j) * spacing_px; two each way at least.
class DisplacementGrid {
 public:
  DisplacementGrid(SizePx points, int spacing_px);
  // Each pixel of a picture but those along its edges. Noise has slopes, too: over a cell of the
  // grid r has the mean C d and the covariance H, which tells C H^-1 C of d: along a grain far less
  // than H. O(pixels), multi-threaded.
  void add(SizePx picture, const std::function<PixelSays(int x, int y)>& says);
  // Moves `field`, [rows][columns][2], at which the pixels spoke, to the minimum of what they say
  // and of kBending |second differences of field - start|^2 / 2. Conjugate gradients.
  void solve(const Image<float>& start, Image<float>& field) const;

 private:
  // Of the four corners of a cell, x and y each: a symmetric matrix and the right side.
  struct Cell {
    std::array<double, 64> h{};
    std::array<double, 8> r{};
    PixelSays sum;
  };
  static void addPixel(const PixelSays& says, double fx, double fy, Cell& cell);
  static void weigh(Cell& cell);
  std::array<std::size_t, 8> unknownsOf(int i, int j) const;
  std::vector<double> times(const std::vector<double>& d) const;
  void addBending(const std::vector<double>& d, std::vector<double>& out) const;

  SizePx points_;
  int spacing_px_;
  std::vector<Cell> cells_;
};

}  // namespace patina::calibration
