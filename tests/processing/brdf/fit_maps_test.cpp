// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/brdf/fit_maps.h"

#include <gtest/gtest.h>

namespace patina::brdf {
namespace {

constexpr SizePx kSize{24, 24};

FitState plainState() {
  FitState state(kSize, 1);
  for (float& v : state.look.texels()) v = 0.4f;
  for (float& v : state.misfit.texels()) v = 1;
  return state;
}

TEST(FitMaps, AnotherTimeStepIsAWitnessOfTheStrength) {
  const FitState state = plainState();
  const Image<float> specular(24, 24, 1, 0.2f), roughness(24, 24, 1, 0.3f), sure(24, 24, 1, 1.0f);
  PriorMaps prior(kSize, 1);
  Progress progress;
  const std::vector<FitBefore> before{{specular.view(), roughness.view(), sure.view()}};
  poolSpecular(state, before, MultiLightOptions{}, prior, progress);
  EXPECT_NEAR(prior.specular.at(3, 3), 0.2f, 1e-5f);
}

TEST(FitMaps, SpecularMeansCountByInformation) {
  FitState state = plainState();
  for (int y = 0; y < kSize.height; ++y)
    for (int x = 0; x < kSize.width; ++x) {
      const bool known = (x + y) % 4 == 0;
      state.own_specular.at(x, y) = known ? 0.1f : 0.5f;
      state.specular_weight.at(x, y) = known ? 1e5f : 1;
    }
  PriorMaps prior(kSize, 1);
  Progress progress;
  poolSpecular(state, {}, MultiLightOptions{}, prior, progress);
  EXPECT_NEAR(prior.specular.at(12, 12), 0.1f, 0.01f);
}

}  // namespace
}  // namespace patina::brdf
