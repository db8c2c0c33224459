// SPDX-License-Identifier: GPL-3.0-or-later
// What a pixel of the twin sees, worked out once more from the truth: textbook formulas in double
// precision, one pixel at a time, with nothing of the twin's own geometry, shading or shadows.
#pragma once

#include <array>
#include <vector>

#include "devices/twin/specimen.h"

namespace patina::devices::twin {

using Vector = std::array<double, 3>;

struct ExactLamp {
  Vector at{}, aim{};
  double beam_deg = 0, radius_mm = 10, level = 1;
};

struct ExactCamera {
  SizePx size;
  double k1 = 0, k2 = 0, focal_widths = 1.2;
  bool distant = true;
  Vector at{}, aim{};  // else; no roll
};

// Heights on a square grid, for shadows; `width` 0: none.
struct ExactRelief {
  int width = 0, height = 0;
  double x0_mm = 0, y0_mm = 0, texel_mm = 1;  // centre of the first texel; rows run down
  std::vector<float> heights;
};

class ExactLight {
 public:
  // `places` are those the camera under test says its pixels see, as the truth takes them: a sharp
  // rim feels the last digit of a float.
  ExactLight(const Specimen& specimen, double time, const SampleGrid& places, ExactCamera camera,
             ExactRelief relief, std::vector<ExactLamp> lamps);
  // How far these lie at most from where the pixels see by this evaluation.
  double farthestMm() const { return farthest_mm_; }
  // Light of the pixel's mosaic channel, in units of a white diffuser at the origin.
  double at(int x, int y) const;

 private:
  struct Seen {
    Vector point, to_camera;
  };
  Seen look(int x, int y) const;
  double reflected(std::size_t texel, int channel, const Vector& l, const Vector& v) const;
  double visibility(const ExactLamp& lamp, double x_mm, double y_mm) const;
  double visibilityOfTexel(const ExactLamp& lamp, int x, int y) const;

  const Specimen& specimen_;
  ExactCamera camera_;
  ExactRelief relief_;
  std::vector<ExactLamp> lamps_;
  SurfaceMaps truth_;  // under every pixel
  double farthest_mm_ = 0;
};

}  // namespace patina::devices::twin
