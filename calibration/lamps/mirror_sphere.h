// SPDX-License-Identifier: GPL-3.0-or-later
// Light directions from the highlights of a mirror sphere.
//
// A highlight lies where the sphere reflects the lamp to the camera: l = 2 (n.v) n - v. Texels of a
// distant camera's mirror sphere cover equal solid angles of what they reflect, so the mean of l
// over the highlight, weighted by its light, is the lamp's middle also where the sphere is not
// polished to the last and the highlight is wide, slanted or clipped to a plateau.
//
// Frame: the camera's: x right, y up, z to the camera. A direction points to the lamp from where
// its highlight lies, which near lamps make another one than from the sphere's middle.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "calibration/lamps/sphere_rim.h"
#include "processing/image/progress.h"

namespace patina::calibration {

struct SphereOptions {
  SphereCamera camera;
  std::optional<Disc> given;  // where the sphere is, instead of looking for it
  double saturated = 0.98;    // linear level from which a texel may be clipped, (0, 1]
  double second = 0.25;  // of the first highlight's light: as much more is a second one, (0, 1)
  double least = 0.02;   // level above the sphere's own that is a highlight, (0, 1)
  void check() const;    // throws CalibrationError(kUsage)
};

// Pictures of the sphere, one lamp each; asked for twice, in order.
struct SphereShots {
  int count = 0;
  std::function<Image<float>(int)> picture;   // [h][w][c] linear, all of one size
  std::function<std::string(int)> name = {};  // for messages
};

struct SphereLight {
  std::array<double, 3> direction{};  // unit, to the lamp
  std::array<double, 3> normal{};     // of the sphere where the highlight lies
  double x_px = 0, y_px = 0;          // of the highlight, at halves
  int texels = 0;                     // that it was taken from
  double clipped_share = 0;           // of them
  double sigma_deg = 0;               // of the direction: noise of rim and highlight
};
struct SphereLights {
  MirrorSphere sphere;
  std::vector<SphereLight> lights;  // of each shot
};

// Throws CalibrationError(kBadData) naming the shot: no highlight, several, the sphere saturated
// all over or cut off by the frame, a picture of another size. O(pixels) a shot; keeps a grey copy
// of at most a megapixel of every shot while it looks for the sphere.
SphereLights lightsFromSphere(const SphereShots& shots, const SphereOptions& options,
                              Progress& progress);
// One shot of a sphere whose place is known.
SphereLight lightFromHighlight(ImageView<const float> picture, const MirrorSphere& sphere,
                               const SphereOptions& options);

}  // namespace patina::calibration
