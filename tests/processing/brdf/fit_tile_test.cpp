// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/brdf/fit_tile.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/processing/brdf/lit_maps.h"

namespace patina::brdf {
namespace {

TEST(FitTile, RepeatsTheLastTexelBeyondTheEdge) {
  const LitSurface surface = lit(rollingMaps(20, 2, {0.1f, 0.3f}), Model::kGgx, dome(6));
  const MultiLightOptions options = calmOptions();
  FitTile tile(surface.samples, options);
  tile.load(16, 1);
  const lanes::Samples& s = tile.lanes();
  const auto texel = surface.pictures[2].view().texel(19, 1);
  EXPECT_FLOAT_EQ(s.light[2].y[3], (texel[0] + texel[1] + texel[2]) / 3);
  EXPECT_EQ(s.light[2].y[15], s.light[2].y[3]);
}

TEST(FitTile, ClippedAndUnknownLevelsDoNotCount) {
  LitSurface surface = lit(rollingMaps(16, 1, {0.1f, 0.3f}), Model::kGgx, dome(6));
  surface.pictures[1].at(4, 0, 2) = std::numeric_limits<float>::quiet_NaN();
  surface.pictures[3].at(5, 0, 0) = 60;
  const MultiLightOptions options = calmOptions();  // saturated at 50
  FitTile tile(surface.samples, options);
  tile.load(0, 0);
  EXPECT_EQ(tile.lanes().light[1].noise[4], 0);
  EXPECT_EQ(tile.lanes().light[3].noise[5], 0);
  EXPECT_GT(tile.lanes().light[1].noise[5], 0);
}

}  // namespace
}  // namespace patina::brdf
