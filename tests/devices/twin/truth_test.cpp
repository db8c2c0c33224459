// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures agree with the truth: the noiseless camera against an independent evaluation.
#include <gtest/gtest.h>

#include <cmath>

#include "devices/twin/picture_maker.h"
#include "tests/devices/twin/exact_light.h"

namespace patina::devices::twin {
namespace {

constexpr double kAgreesTo = 1e-4;  // of white, or of what is brighter
constexpr SizePx kSize{96, 80};
constexpr double kTime = 0.4375;  // a whole number of the picture maker's steps

RigSpec labRig(const std::string& specimen, bool shadows, const std::string& camera) {
  return parseRig("[[camera]]\nid = 'cam0'\nbackend = 'twin'\nsettings = { " + camera +
                      " }\n"
                      "[[light]]\nid = 'key'\nbackend = 'twin'\nposition_mm = [-180, 150, 120]\n"
                      "settings = { radius_mm = 12.0 }\n"
                      "[[light]]\nid = 'spot'\nbackend = 'twin'\nposition_mm = [90, 160, 70]\n"
                      "settings = { beam_deg = 40.0, aim_mm = '5,-5,0', radius_mm = 20.0 }\n"
                      "[twin]\nspecimen = '" +
                      specimen + "'\nsize = '96x80'\nshadows = " + (shadows ? "true" : "false") +
                      "\n",
                  "rig.toml");
}

// The grid that shadows stand on: square texels of the picture's, a margin of 6 % around it.
ExactRelief reliefOf(const Specimen& specimen, const SampleGrid& seen) {
  const auto [x0, x1] = std::minmax_element(seen.x_mm.begin(), seen.x_mm.end());
  const auto [y0, y1] = std::minmax_element(seen.y_mm.begin(), seen.y_mm.end());
  const float margin = 0.06f * static_cast<float>(specimen.info().width_mm);
  const ReliefShadow square(*x0 - margin, *y0 - margin, *x1 + margin, *y1 + margin, seen.texel_mm);
  const SampleGrid& grid = square.grid();
  return {grid.size.width, grid.size.height,
          grid.x_mm[0],    grid.y_mm[0],
          grid.texel_mm,   mapsAt(*specimen.prepare(grid), kTime, grid.size).height.texels()};
}

class Truth : public ::testing::TestWithParam<std::tuple<std::string, bool, bool>> {};

std::vector<std::string> specimens() {
  std::vector<std::string> names;
  for (const SpecimenInfo& info : listSpecimens()) names.push_back(info.name);
  return names;
}
INSTANTIATE_TEST_SUITE_P(OfEverySpecimen, Truth,
                         ::testing::Combine(::testing::ValuesIn(specimens()), ::testing::Bool(),
                                            ::testing::Bool()),
                         [](const auto& p) {
                           return std::get<0>(p.param) + (std::get<1>(p.param) ? "_shadows" : "") +
                                  (std::get<2>(p.param) ? "_oblique" : "");
                         });

TEST_P(Truth, IsWhatTheNoiselessCameraSees) {
  const auto& [name, shadows, oblique] = GetParam();
  const RigSpec spec = labRig(name, shadows, "");
  VirtualClock clock(UtcTime{});
  const World world(spec, {}, clock);
  ExactCamera camera{kSize, -0.12, 0.03, 1.2};
  CameraPose pose;
  if (oblique) {
    pose.distant = camera.distant = false;
    pose.position_mm = {-40, -90, 140};
    pose.look_at_mm = {3, 2, 0};
    pose.focal_widths = camera.focal_widths = 2.5;
    camera.at = {-40, -90, 140};
    camera.aim = {3, 2, 0};
  }
  PictureMaker maker(world, spec.cameras[0], pose, 1);
  ShotLight shot;
  shot.begin = fromSeconds(kTime * toSeconds(world.specimen().info().duration));
  shot.exposure = defaultExposure();
  shot.levels = {0.8, 0.5};
  const std::vector<float> seen = maker.light(shot);
  const ExactLight exact(
      world.specimen(), kTime, maker.grid(), camera,
      shadows ? reliefOf(world.specimen(), maker.grid()) : ExactRelief{},
      {{{-180, 150, 120}, {}, 0, 12, 0.8}, {{90, 160, 70}, {5, -5, 0}, 40, 20, 0.5}});
  const RectPx patch = maker.layout().patch_px;
  int compared = 0, shaded = 0;
  double worst = 0;
  for (int y = 0; y < patch.y - 4; ++y)
    for (int x = 0; x < kSize.width; ++x) {
      const double truth = exact.at(x, y), found = seen[maker.grid().index(x, y)];
      worst = std::max(worst, std::abs(found - truth) / std::max(truth, 1.0));
      ++compared;
      shaded += truth < 0.005;
    }
  EXPECT_LE(exact.farthestMm(), 1e-4);
  EXPECT_LE(worst, kAgreesTo) << compared << " pixels, " << shaded << " in shadow";
  EXPECT_GT(compared, 4000);
}

}  // namespace
}  // namespace patina::devices::twin
