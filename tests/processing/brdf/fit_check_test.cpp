// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/brdf/fit_check.h"

#include <gmock/gmock.h>

#include "tests/processing/brdf/lit_maps.h"

namespace patina::brdf {
namespace {

using ::testing::HasSubstr;

class FitCheck : public ::testing::Test {
 protected:
  FitCheck() : surface_(lit(rollingMaps(8, 6, {0.1f, 0.3f}), Model::kGgx, dome(8))) {}
  std::string refusal(const std::vector<FitSample>& samples) {
    try {
      checkSamples(samples, options_, {});
    } catch (const ProcessingError& e) {
      EXPECT_EQ(e.exit(), Exit::kBadData);
      return e.what();
    }
    return "(accepted)";
  }
  LitSurface surface_;
  MultiLightOptions options_;
};

TEST_F(FitCheck, AcceptsALitSurface) { EXPECT_EQ(refusal(surface_.samples), "(accepted)"); }

TEST_F(FitCheck, OneLightOrTooFewAreRefusedWithTheNumberNeeded) {
  auto samples = surface_.samples;
  samples.resize(5);
  EXPECT_THAT(refusal(samples), HasSubstr("5 lights do not tell reflectance: at least 6"));
  samples.resize(1);
  EXPECT_THAT(refusal(samples), HasSubstr("1 light does not"));
  options_.model = Model::kLambert;
  EXPECT_THAT(refusal(samples), HasSubstr("at least 3"));
}

TEST_F(FitCheck, LightsInOnePlaneAreRefused) {
  auto samples = surface_.samples;
  for (FitSample& sample : samples)
    sample.light.direction = normalized({sample.light.direction.x, 0, sample.light.direction.z});
  EXPECT_THAT(refusal(samples), HasSubstr("one plane"));
}

TEST_F(FitCheck, LightsBehindAreRefusedAllOrSome) {
  auto samples = surface_.samples;
  samples[2].light.direction.z *= -1;
  EXPECT_THAT(refusal(samples), HasSubstr("1 of 8 lights lie behind"));
  for (FitSample& sample : samples) sample.light.direction.z = -std::abs(sample.light.direction.z);
  EXPECT_THAT(refusal(samples), HasSubstr("all lights lie behind"));
}

TEST_F(FitCheck, ADirectionNotOfLengthOneIsRefused) {
  auto samples = surface_.samples;
  samples[4].light.direction = {0, 0, 2};
  EXPECT_THAT(refusal(samples), HasSubstr("light 5 has a direction of length 2"));
  samples[4].light.direction = {std::nanf(""), 0, 1};
  EXPECT_THAT(refusal(samples), HasSubstr("light 5 has no direction"));
}

TEST_F(FitCheck, PicturesThatDifferAreRefused) {
  auto samples = surface_.samples;
  const Image<float> small(4, 4, 3), grey(8, 6, 1);
  samples[1].picture = small.view();
  EXPECT_THAT(refusal(samples), HasSubstr("picture 2 is 4x4, the first 8x6"));
  samples[1].picture = grey.view();
  EXPECT_THAT(refusal(samples), HasSubstr("picture 2 has 1 channels"));
}

TEST_F(FitCheck, OptionsOutOfRangeAreUsageErrors) {
  const auto refused = [](auto spoil) {
    MultiLightOptions options;
    spoil(options);
    EXPECT_THROW(options.check(), ProcessingError);
  };
  refused([](MultiLightOptions& o) { o.noise.floor = 0; });
  refused([](MultiLightOptions& o) { o.rounds = 0; });
  refused([](MultiLightOptions& o) { o.steps = 51; });
  refused([](MultiLightOptions& o) { o.neighbour_px = 257; });
  refused([](MultiLightOptions& o) { o.mm_per_texel = 0; });
}

}  // namespace
}  // namespace patina::brdf
