// SPDX-License-Identifier: GPL-3.0-or-later
// What a twin's camera sees of boards whose pose is known: distorted, darker in the corners, with
// the noise of the sensor.
#pragma once

#include <vector>

#include "calibration/lens/lens.h"
#include "calibration/lens/view.h"
#include "devices/twin/picture_maker.h"

namespace patina::testing {

namespace twin = devices::twin;
using devices::TargetSpec;

inline TargetSpec chessboard(int columns, int rows, double square_mm) {  // squares
  TargetSpec target;
  target.kind = TargetSpec::kChessboard;
  target.columns = columns;
  target.rows = rows;
  target.width_mm = columns * square_mm;
  return target;
}
inline TargetSpec charuco(int columns, int rows, double square_mm) {
  TargetSpec target = chessboard(columns, rows, square_mm);
  target.kind = TargetSpec::kCharuco;
  return target;
}
inline TargetSpec placed(TargetSpec target, std::array<double, 3> position_mm,
                         std::array<double, 3> rotation_deg = {}) {
  target.position_mm = position_mm;
  target.rotation_deg = rotation_deg;
  return target;
}
inline twin::CameraPose overhead(double height_mm, double focal_widths) {
  twin::CameraPose pose;
  pose.distant = false;
  pose.position_mm = {0, 0, height_mm};
  pose.focal_widths = focal_widths;
  return pose;
}

// One exposure under a lamp far away, [h][w][1], linear, 1 = full scale. The mosaic as it
// is: boards and cards are grey.
inline Image<float> shootTwin(SizePx size, const twin::CameraPose& pose,
                              const std::vector<TargetSpec>& targets,
                              const std::string& specimen = "grey_card") {
  devices::RigSpec spec = devices::parseRig(
      "[[camera]]\nid = 'cam0'\nbackend = 'twin'\n"
      "[[light]]\nid = 'key'\nbackend = 'twin'\nposition_mm = [1000, 2000, 20000]\n"
      "settings = { kind = 'led' }\n"
      "[twin]\nspecimen = '" +
          specimen + "'\nsize = '" + std::to_string(size.width) + "x" +
          std::to_string(size.height) + "'\n",
      "rig.toml");
  spec.twin->targets = targets;
  devices::VirtualClock clock(UtcTime{});
  const twin::World world(spec, {}, clock);
  twin::PictureMaker maker(world, spec.cameras[0], pose, 1);
  twin::ShotLight shot;
  shot.begin = std::chrono::hours(1);
  shot.exposure = twin::defaultExposure();
  shot.levels = {1};
  shot.temperature = {20};
  shot.noise_key = 1;
  const RawMosaic raw = maker.expose(shot);
  Image<float> linear(size.width, size.height, 1);
  for (std::size_t i = 0; i < linear.texels().size(); ++i)
    linear.texels()[i] = (static_cast<float>(raw.samples.texels()[i]) - 64) / (4095 - 64);
  return linear;
}

// The reference profile's lens on a camera of `pose`, in our numbers.
inline calibration::Lens trueLens(SizePx size, const twin::CameraPose& pose) {
  const twin::LensProfile& lens = twin::referenceProfile().lens;
  const double focal = pose.focal_widths * size.width;
  return {size, focal, focal, (size.width - 1) / 2.0, (size.height - 1) / 2.0, lens.k1, lens.k2,
          0,    0,     0};
}

// Farthest that two lenses put the same pixel when they straighten a picture, each by its own focal
// length and middle: what is left of a straight line's bend.
inline double straightenedApart(const calibration::Lens& found, const calibration::Lens& truth) {
  std::vector<calibration::PlacePx> seen;
  for (int y = 0; y < truth.size.height; y += 8)
    for (int x = 0; x < truth.size.width; x += 8)
      seen.push_back({static_cast<double>(x), static_cast<double>(y)});
  const auto a = undistorted(found, seen), b = undistorted(truth, seen);
  double worst = 0;
  for (std::size_t i = 0; i < seen.size(); ++i)
    worst = std::max(worst, std::hypot(a[i].x - b[i].x, a[i].y - b[i].y));
  return worst;
}

}  // namespace patina::testing
