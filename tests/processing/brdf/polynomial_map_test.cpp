// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/brdf/polynomial_map.h"

#include <gtest/gtest.h>

#include "tests/processing/brdf/lit_maps.h"

namespace patina::brdf {
namespace {

TEST(PolynomialMap, GivesBackAPolynomialOfItsDegree) {
  std::vector<Image<float>> pictures;
  std::vector<Vec3> lights;
  const auto value = [](const Vec3& l, int x) {
    return 0.3f + 0.2f * l.x - 0.1f * l.y + 0.05f * static_cast<float>(x) * l.x * l.y - l.y * l.y;
  };
  for (const SurfaceLight& light : dome(12)) {
    Image<float> picture(4, 2, 1);
    for (int y = 0; y < 2; ++y)
      for (int x = 0; x < 4; ++x) picture.at(x, y) = value(light.direction, x);
    pictures.push_back(std::move(picture));
    lights.push_back(light.direction);
  }
  std::vector<ImageView<const float>> views;
  for (const Image<float>& picture : pictures)
    views.push_back(ImageView<const float>(picture.view()));
  const PolynomialMap map = fitPolynomialMap(views, lights);
  const Vec3 l = normalized({0.3f, -0.2f, 0.9f});
  for (int x = 0; x < 4; ++x) EXPECT_NEAR(polynomialUnder(map, l).at(x, 1), value(l, x), 1e-4f);
}

TEST(PolynomialMap, RefusesLightsThatDoNotTellItsTerms) {
  const Image<float> picture(2, 2, 1);
  const std::vector<ImageView<const float>> views(8, picture.view());
  EXPECT_THROW(fitPolynomialMap(views, std::vector<Vec3>(8, Vec3{0, 0, 1})), ProcessingError);
  EXPECT_THROW(fitPolynomialMap({views[0]}, {Vec3{0, 0, 1}}), ProcessingError);
}

}  // namespace
}  // namespace patina::brdf
