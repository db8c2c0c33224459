// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/optics.h"

#include <gtest/gtest.h>

#include <cmath>

#include "processing/brdf/ggx.h"

namespace patina::devices::twin {
namespace {

const LensProfile& lens() { return referenceProfile().lens; }

TEST(Lens, CornersSeeTheCornersAndBarrelMagnifiesTheMiddle) {
  const SizePx size{512, 512};
  const SampleGrid grid = lensGrid(size, lens(), 60);
  // The outermost centre lies half a pixel inside the corner.
  EXPECT_NEAR(grid.x_mm[0], -30, 0.1);
  EXPECT_NEAR(grid.y_mm[0], 30, 0.1);
  const float middle_texel = grid.x_mm[grid.index(257, 256)] - grid.x_mm[grid.index(256, 256)];
  const float edge_texel = grid.x_mm[grid.index(511, 256)] - grid.x_mm[grid.index(510, 256)];
  EXPECT_LT(middle_texel, 60.0f / 512);
  EXPECT_GT(edge_texel, middle_texel * 1.05f);
}

TEST(Lens, FollowsItsDistortionFormula) {
  const SizePx size{512, 512};
  const SampleGrid grid = lensGrid(size, lens(), 60);
  const double focal_px = lens().focal_length * 512;
  const double mm = grid.texel_mm;  // of the undistorted picture
  for (const int x : {300, 400, 511}) {
    const double r_u = grid.x_mm[grid.index(x, 255)] / mm / focal_px;
    const double y_u = grid.y_mm[grid.index(x, 255)] / mm / focal_px;
    const double r2 = r_u * r_u + y_u * y_u;
    const double r_d = r_u * (1 + lens().k1 * r2 + lens().k2 * r2 * r2);
    EXPECT_NEAR(r_d * focal_px, x + 0.5 - 256, 0.01);
  }
}

TEST(Lens, LosesThirtyPercentInTheCorners) {
  const std::vector<float> falloff = lensFalloff({512, 384}, lens());
  EXPECT_NEAR(falloff[0], 0.70, 0.005);
  EXPECT_NEAR(falloff[192 * 512 + 256], 1.0, 1e-4);
}

TEST(LampField, FallsWithTheInverseSquareAndTheCosine) {
  const SampleGrid grid = SampleGrid::regular({101, 101}, 202);  // 2 mm texels, middle at 0
  const std::array<double, 3> lamp{100, 0, 300};
  const LampField f = lampField(grid, lamp);
  std::vector<float> card(101);
  const auto flat = [&](int x, int y) {
    shadeCardRow(f, y, 101, card.data());
    return card[x];
  };
  EXPECT_NEAR(flat(50, 50), 1, 1e-5) << "the middle is level 1 for every lamp";
  const double d2_middle = 100 * 100 + 300 * 300, d2_below = 300 * 300;
  const double expected = std::pow(d2_middle / d2_below, 1.5);
  EXPECT_NEAR(flat(100, 50), expected, 1e-4) << "x = 100 mm lies straight below the lamp";
}

TEST(Shading, OfADiffuseCardIsItsAlbedo) {
  const SampleGrid grid = SampleGrid::regular({9, 9}, 9);
  const LampField f = lampField(grid, {0, 0, 1e6});
  SurfaceRow row(9);
  for (int x = 0; x < 9; ++x) {
    for (const auto c : {SurfaceRow::kDiffuseR, SurfaceRow::kDiffuseG, SurfaceRow::kDiffuseB})
      row[c][x] = 0.4f;
    row[SurfaceRow::kNormalZ][x] = 1;
    row[SurfaceRow::kRoughness][x] = 1;
  }
  std::vector<float> light(9);
  shadeMosaicRow(row, f, 4, light.data());
  // No specular colour is left but Schlick's edge, zero for light from straight above.
  for (const float v : light) EXPECT_NEAR(v, 0.4f, 1e-4);
}

TEST(Shading, AgreesWithTheReflectanceModelAndPicksTheChannelOfTheMosaic) {
  const SampleGrid grid = SampleGrid::regular({4, 4}, 4);
  const std::array<double, 3> lamp{200, 100, 300};
  const LampField f = lampField(grid, lamp);
  SurfaceRow row(4);
  const float specular[3] = {0.9f, 0.5f, 0.2f};
  const brdf::Vec3 n = brdf::normalized({0.1f, -0.05f, 1});
  for (int x = 0; x < 4; ++x) {
    row[SurfaceRow::kSpecularR][x] = specular[0];
    row[SurfaceRow::kSpecularG][x] = specular[1];
    row[SurfaceRow::kSpecularB][x] = specular[2];
    row[SurfaceRow::kRoughness][x] = 0.4f;
    row[SurfaceRow::kNormalX][x] = n.x;
    row[SurfaceRow::kNormalY][x] = n.y;
    row[SurfaceRow::kNormalZ][x] = n.z;
  }
  const int channel[2][2] = {{0, 1}, {1, 2}};
  std::vector<float> light(4);
  for (int y = 0; y < 4; ++y) {
    shadeMosaicRow(row, f, y, light.data());
    for (int x = 0; x < 4; ++x) {
      const std::size_t k = grid.index(x, y);
      const brdf::Vec3 l{f.light_x[k], f.light_y[k], f.light_z[k]};
      const float expected = brdf::kPi *
                             brdf::ggx(n, l, {0, 0, 1}, specular[channel[y % 2][x % 2]], 0.4f) *
                             brdf::dot(n, l) * f.irradiance[k];
      EXPECT_NEAR(light[x], expected, 1e-4f * expected);
    }
  }
}

}  // namespace
}  // namespace patina::devices::twin
