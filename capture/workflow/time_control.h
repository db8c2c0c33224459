// SPDX-License-Identifier: GPL-3.0-or-later
// How fast each texel of a texture ages, from what a person gives: formulas over its place and
// time, a picture, a surface and a light (Enrique et al. 2005, section 6).
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>

#include "capture/workflow/control_surface.h"
#include "processing/image/progress.h"
#include "processing/ttf/retime.h"

namespace patina::workflow {

// A lamp whose place or direction may be formulas of t, 0 at the start of the result and 1 at its
// end: a sun that rises and sets.
struct MovingLamp {
  bool directional = true;
  std::array<std::string, 3> at;
  double radius = 0;  // mm, degrees of a direction: how soft its shadow is

  // "X,Y,Z", each a number or a formula. Throws WorkflowError(kUsage).
  static MovingLamp parse(const std::string& text, bool directional);
  mesh::Lamp lampAt(double t) const;
  bool moves() const;
};

// Variables of the formulas:
//   x y        from the texture's middle, x right, y up; 1 is half of the smaller side
//   t          0 at the start of the result, 1 at its end (of rates only)
//   map        the picture, as displayed: 0 black, 1 white; EXR: its numbers
//   height     mm;  slope  degrees;  curvature  mean, 1/mm
//   light      equation 9, the brightest texel at the brightest time 1
//   shadow     0 in it, 1 outside;  sky  0 to 1
struct TimeControl {
  std::string rate;   // "0.2 + 0.8*light"; empty: "map" where there is a picture
  std::string start;  // share of the texture's time that a texel waits; empty: 0
  std::filesystem::path map, height;
  double height_mm = 1;             // that a picture's white stands for, or an EXR's 1
  double mm_per_texel = 0;          // 0: as the texture says
  SharedMesh mesh;                  // what the texture is wrapped about, in place of a height map
  std::vector<SharedMesh> casters;  // what else throws shadows
  std::optional<MovingLamp> lamp;
};

// Fills `rates` and `start_s` of `options`, whose other fields it reads, and `duration_s` of a rate
// that changes, if it is not given. Pictures of another size
// are resized. Throws WorkflowError (kUsage): a variable without what it comes from, no formula, a
// rate that is negative or no number somewhere.
void controlTime(const TimeControl& control, const ttf::TtfInfo& input, ttf::RetimeOptions& options,
                 Progress& progress);

}  // namespace patina::workflow
