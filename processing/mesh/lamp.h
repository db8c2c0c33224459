// SPDX-License-Identifier: GPL-3.0-or-later
// A light as surfaces see it: a direction or a place, and how wide it is.
#pragma once

#include <array>
#include <vector>

namespace patina::mesh {

struct Lamp {
  bool directional = true;
  std::array<double, 3> at{0, 0, 1};  // direction to the light, or its place in mm
};

struct ShadowOptions {
  double radius = 0;  // mm; degrees of a directional lamp
  int rays = 1;       // 1 to 4096
};

// Unit direction. Throws ProcessingError(kUsage) for one without length.
std::array<double, 3> unitOf(const std::array<double, 3>& direction);

// `options.rays` lamps spread evenly over the disc of the lamp, seen from the middle of the frame
// (Vogel's spiral): always the same ones. Throws ProcessingError(kUsage) for options out of range.
std::vector<Lamp> spreadOf(const Lamp& lamp, const ShadowOptions& options);

// The i-th of n points spread evenly over the unit disc.
std::array<double, 2> onDisc(int i, int n);

}  // namespace patina::mesh
