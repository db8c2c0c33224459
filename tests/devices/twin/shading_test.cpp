// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/shading.h"

#include <gtest/gtest.h>

#include <cmath>

#include "processing/brdf/ggx.h"

namespace patina::devices::twin {
namespace {

TEST(Shading, OfADiffuseCardIsItsAlbedo) {
  const CameraView view(SampleGrid::regular({9, 9}, 9));
  LampPlace lamp;
  lamp.position_mm = {0, 0, 1e6};
  const LampField f(view, lamp, true);
  SurfaceRow row(9);
  for (int x = 0; x < 9; ++x) {
    for (const auto c : {SurfaceRow::kDiffuseR, SurfaceRow::kDiffuseG, SurfaceRow::kDiffuseB})
      row[c][x] = 0.4f;
    row[SurfaceRow::kNormalZ][x] = 1;
    row[SurfaceRow::kRoughness][x] = 1;
  }
  std::vector<float> light(9), scratch;
  shadeMosaicRow({row, f.row(4, scratch), {}}, 4, light.data());
  // No specular colour is left but Schlick's edge, zero for light from straight above.
  for (const float v : light) EXPECT_NEAR(v, 0.4f, 1e-4);
}

// A tilted texel whose channels differ, for every pixel of a row.
SurfaceRow tiltedRow(int width, const float (&specular)[3], const brdf::Vec3& n) {
  SurfaceRow row(width);
  for (int x = 0; x < width; ++x) {
    row[SurfaceRow::kSpecularR][x] = specular[0];
    row[SurfaceRow::kSpecularG][x] = specular[1];
    row[SurfaceRow::kSpecularB][x] = specular[2];
    row[SurfaceRow::kRoughness][x] = 0.4f;
    row[SurfaceRow::kNormalX][x] = n.x;
    row[SurfaceRow::kNormalY][x] = n.y;
    row[SurfaceRow::kNormalZ][x] = n.z;
    row[SurfaceRow::kDegree][x] = 0.3f;
  }
  return row;
}

class EveryView : public ::testing::TestWithParam<bool> {
 protected:
  CameraView view() const {
    if (GetParam()) return CameraView(SampleGrid::regular({4, 4}, 4));
    CameraPose pose;
    pose.distant = false;
    pose.position_mm = {-40, 60, 100};
    return CameraView({4, 4}, {}, pose, 4);
  }
  brdf::Vec3 toCamera(const CameraView& view, int x, int y) const {
    const ViewRow row = view.viewRow(y);
    return row.x ? brdf::Vec3{row.x[x], row.y[x], row.z[x]} : brdf::Vec3{0, 0, 1};
  }
};
INSTANTIATE_TEST_SUITE_P(Shading, EveryView, ::testing::Bool());

constexpr int kMosaic[2][2] = {{0, 1}, {1, 2}};

TEST_P(EveryView, AgreesWithTheReflectanceModelAndPicksTheChannelOfTheMosaic) {
  const CameraView view = this->view();
  LampPlace lamp;
  lamp.position_mm = {200, 100, 300};
  const LampField field(view, lamp, true);
  const float specular[3] = {0.9f, 0.5f, 0.2f};
  const brdf::Vec3 n = brdf::normalized({0.1f, -0.05f, 1});
  const SurfaceRow row = tiltedRow(4, specular, n);
  std::vector<float> light(4), scratch;
  for (int y = 0; y < 4; ++y) {
    const LampRow f = field.row(y, scratch);
    shadeMosaicRow({row, f, view.viewRow(y)}, y, light.data());
    for (int x = 0; x < 4; ++x) {
      const brdf::Vec3 l{f.light_x[x], f.light_y[x], f.light_z[x]};
      const float expected =
          brdf::kPi * brdf::ggx(n, l, toCamera(view, x, y), specular[kMosaic[y % 2][x % 2]], 0.4f) *
          brdf::dot(n, l) * f.irradiance[x];
      EXPECT_NEAR(light[x], expected, 1e-4f * expected);
    }
  }
}

TEST_P(EveryView, BlendsMeasuredMaterialsByTheDegree) {
  const CameraView view = this->view();
  LampPlace lamp;
  lamp.position_mm = {200, 100, 300};
  const LampField field(view, lamp, true);
  const float specular[3] = {0.9f, 0.5f, 0.2f};
  const brdf::Vec3 n = brdf::normalized({0.1f, -0.05f, 1});
  const SurfaceRow row = tiltedRow(4, specular, n);
  const MeasuredReflectance measured{{{40, 30, 20}, 900, 0.9f, 1.6f}, {{4, 5, 6}, 90, 1.1f, 1.4f}};
  std::vector<float> light(4), scratch;
  for (int y = 0; y < 4; ++y) {
    const LampRow f = field.row(y, scratch);
    shadeMosaicRow({row, f, view.viewRow(y), &measured}, y, light.data());
    for (int x = 0; x < 4; ++x) {
      const int c = kMosaic[y % 2][x % 2];
      const brdf::Vec3 l{f.light_x[x], f.light_y[x], f.light_z[x]}, v = toCamera(view, x, y);
      const float lobe = 0.7f * brdf::abc(measured.fresh, c, n, l, v) +
                         0.3f * brdf::abc(measured.aged, c, n, l, v);
      const float expected = brdf::kPi * lobe * brdf::dot(n, l) * f.irradiance[x];
      EXPECT_NEAR(light[x], expected, 1e-4f * expected);
    }
  }
}

TEST(Shading, OfTheSkyIsWhatTheTiltLeavesOfIt) {
  const float specular[3] = {0.3f, 0.2f, 0.1f};
  const SurfaceRow flat = tiltedRow(4, specular, {0, 0, 1}),
                   steep = tiltedRow(4, specular, {1, 0, 0});
  std::vector<float> open(4), half(4);
  addSkyMosaicRow(flat, 0, 2, open.data());
  addSkyMosaicRow(steep, 0, 2, half.data());
  EXPECT_NEAR(open[0], 0.6f, 1e-6);
  EXPECT_NEAR(open[1], 0.4f, 1e-6);
  EXPECT_NEAR(half[0], 0.3f, 1e-6);
}

}  // namespace
}  // namespace patina::devices::twin
