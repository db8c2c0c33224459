// SPDX-License-Identifier: GPL-3.0-or-later
// Targets of known pose and reflectance in the scene: grey card, ColorChecker, chessboard, ChArUco
// board, mirror sphere. They do not age and cast no shadow on the specimen.
//
// Flat targets face up (+z) before they are turned about x, then y, then z; their own x runs along
// width_mm, their y up the other side. Cards are Lambertian:
//   grey card      square, one reflectance
//   ColorChecker   6 x 4 fields of 2/3 of their cell, on black; sRGB values of the chart's maker
//   chessboard     columns x rows squares, black (0.04) in the corner (-x, +y), white 0.85
//   ChArUco        the same board with markers of ArUco's dictionary 4x4_50 in its white squares,
//                  3/4 of them wide, numbered row by row from that corner
//   mirror sphere  GGX of alpha kMirrorAlpha, coloured by nothing, without diffuse light
#pragma once

#include <vector>

#include "devices/rig.h"
#include "devices/twin/camera_view.h"
#include "devices/twin/lamp_field.h"

namespace patina::devices::twin {

constexpr double kMirrorAlpha = 0.03;

// Linear reflectance of a flat target at (u, v) of [0,1]^2, v from its upper edge down.
std::array<double, 3> targetReflectance(const TargetSpec& target, double u, double v);
// Height over width of a flat target.
double targetAspect(const TargetSpec& target);
// A point of a flat target in the rig's frame.
Point targetPoint(const TargetSpec& target, double u, double v);
// Light that comes back along a ray from the target it meets first, for each channel, at level 1
// of the lamp, in units of a white diffuser at the origin; nothing when it meets none above z = 0.
struct TargetHit {
  const TargetSpec* target = nullptr;
  Point at, normal;
  std::array<double, 3> reflectance{};  // of a sphere: at normal incidence
  double away_mm = 0;
};
TargetHit firstHit(const std::vector<TargetSpec>& targets, const Ray& ray);
double targetLight(const TargetHit& hit, int channel, const Ray& ray, const LampPlace& lamp);

// What targets change of one camera's mosaic pictures. Immutable; O(pixels they cover) a lamp.
class TargetPixels {
 public:
  TargetPixels(const std::vector<TargetSpec>& targets, const CameraView& view);
  bool none() const { return pixels_.empty(); }
  // Adds to a picture of the specimen alone, [h][w], in place: what is covered is replaced.
  void draw(const LampPlace& lamp, std::vector<float>& light) const;
  void drawSky(float level, std::vector<float>& light) const;

 private:
  struct Sample {
    Ray ray;
    TargetHit hit;
  };
  struct Pixel {
    std::size_t index;
    int channel;
    float covered;  // share of the pixel
    std::size_t first, count;
  };
  template <class Light>
  void replace(std::vector<float>& light, const Light& of_sample) const;

  std::vector<TargetSpec> targets_;
  std::vector<Pixel> pixels_;
  std::vector<Sample> samples_;
};

}  // namespace patina::devices::twin
