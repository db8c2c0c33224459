// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/colour/colour_model.h"

#include <gtest/gtest.h>

#include <cmath>

#include "calibration/failure.h"
#include "processing/image/random.h"

namespace patina::calibration {
namespace {

ColourModel planted(FitKind kind) {
  ColourModel model{kind, {}};
  for (int i = 0; i < 3 * termCount(kind); ++i)
    model.xyz_from_terms.push_back(uniform(hashSeed(3, static_cast<std::uint64_t>(i))) - 0.2);
  return model;
}

TEST(ColourModel, NamesItsKindsBothWays) {
  for (const FitKind kind : kFitKinds) EXPECT_EQ(fitNamed(nameOf(kind)), kind);
  EXPECT_FALSE(fitNamed("5x3"));
}

TEST(ColourModel, HasThePapersTermsOfRootPolynomials) {
  std::array<double, kTermsMax> terms{};
  fillTerms(FitKind::kRoot3, {1, 8, 27}, terms);
  const std::array<double, kTermsMax> wanted{
      1, 8, 27, std::sqrt(8), std::sqrt(216), std::sqrt(27), 4, 18, 9, 2, 12, 3, 6};
  for (int t = 0; t < kTermsMax; ++t) EXPECT_NEAR(terms[t], wanted[t], 1e-12) << t;
}

TEST(ColourModel, ScalesWithTheExposureUnlessItHasAnOffset) {
  const Rgb rgb{0.3, 0.5, 0.1}, twice{0.6, 1.0, 0.2};
  for (const FitKind kind : kFitKinds) {
    const double ratio = colourOf(planted(kind), twice).y / colourOf(planted(kind), rgb).y;
    if (kind == FitKind::k4x3)
      EXPECT_GT(std::abs(ratio - 2), 0.05);
    else
      EXPECT_NEAR(ratio, 2, 1e-12) << nameOf(kind);
  }
}

TEST(ApplyColour, IsTheModelOfEveryTexelInTheSpaceAskedFor) {
  Image<float> picture(70, 40, 3);
  for (std::size_t i = 0; i < picture.texels().size(); ++i)
    picture.texels()[i] = static_cast<float>(uniform(hashSeed(5, i)));
  for (const FitKind kind : kFitKinds) {
    const ColourModel model = planted(kind);
    Image<float> xyz = picture, srgb = picture;
    applyColour(xyz.view(), model, ColourSpace::kXyz);
    applyColour(srgb.view(), model, ColourSpace::kLinearSrgb, 2);
    for (const int x : {0, 13, 69}) {
      const auto rgb = picture.view().texel(x, 21);
      const Xyz wanted = colourOf(model, {rgb[0], rgb[1], rgb[2]});
      const auto linear = mapped(linearSrgbFromXyz(), {wanted.x, wanted.y, wanted.z});
      EXPECT_NEAR(xyz.at(x, 21, 0), wanted.x, 1e-5);
      EXPECT_NEAR(xyz.at(x, 21, 2), wanted.z, 1e-5);
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(srgb.at(x, 21, c), 2 * linear[c], 1e-5);
    }
  }
}

TEST(ApplyColour, TakesNumbersBelowZeroWithoutARoot) {
  Image<float> picture(1, 1, 3, -0.01F);
  applyColour(picture.view(), planted(FitKind::kRoot3), ColourSpace::kXyz);
  for (const float v : picture.texels()) EXPECT_TRUE(std::isfinite(v));
}

TEST(ApplyColour, RefusesPicturesWithoutColours) {
  Image<float> grey(4, 4, 1);
  EXPECT_THROW(applyColour(grey.view(), planted(FitKind::k3x3), ColourSpace::kXyz),
               CalibrationError);
}

}  // namespace
}  // namespace patina::calibration
