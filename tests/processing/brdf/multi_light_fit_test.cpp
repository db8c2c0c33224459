// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/brdf/multi_light_fit.h"

#include <gmock/gmock.h>
#include <tbb/global_control.h>

#include "tests/processing/brdf/lit_maps.h"
#include "tests/support/matchers.h"

namespace patina::brdf {
namespace {

using patina::testing::ImageNear;

MultiLightFit fitOf(const std::vector<FitSample>& samples, const MultiLightOptions& options) {
  Progress progress;
  return fitManyLights(samples, options, {}, progress);
}

TEST(MultiLightFit, FindsNormalColourAndGlossOfEveryModel) {
  for (const Model model : {Model::kGgx, Model::kWard, Model::kTorranceSparrow}) {
    const BrdfMaps truth = rollingMaps(32, 20, {0.15f, 0.3f});
    const LitSurface surface = lit(truth, model, dome(24));
    const MultiLightFit fit = fitOf(surface.samples, calmOptions(model));
    EXPECT_LT(rms(fit.maps.diffuse, truth.diffuse), 0.01) << nameOf(model);
    EXPECT_LT(rms(fit.maps.specular, truth.specular), 0.02) << nameOf(model);
    EXPECT_LT(rms(fit.maps.roughness, truth.roughness), 0.03) << nameOf(model);
    EXPECT_LT(medianAngleDeg(fit.maps.normal, truth.normal), 0.3) << nameOf(model);
    EXPECT_LT(fit.report.residual_rms, 0.006);
  }
}

TEST(MultiLightFit, LambertsNormalsAndAlbedoOfAMattSurface) {
  const BrdfMaps truth = rollingMaps(20, 16, {0, 0.5f});
  const LitSurface surface = lit(truth, Model::kLambert, dome(12));
  const MultiLightFit fit = fitOf(surface.samples, calmOptions(Model::kLambert));
  EXPECT_LT(rms(fit.maps.diffuse, truth.diffuse), 0.005);
  EXPECT_LT(medianAngleDeg(fit.maps.normal, truth.normal), 0.5);
  EXPECT_TRUE(fit.maps.specular.empty());
}

TEST(MultiLightFit, AMattModelIsFittedNoGlossWhateverIsThoughtOfShadows) {
  const LitSurface surface = lit(rollingMaps(20, 16, {0.1f, 0.3f}), Model::kGgx, dome(12));
  MultiLightOptions options = calmOptions(Model::kLambert);
  const MultiLightFit plain = fitOf(surface.samples, options);
  options.deep_shadows = true;
  const MultiLightFit deep = fitOf(surface.samples, options);
  EXPECT_EQ(deep.maps.diffuse.texels(), plain.maps.diffuse.texels());
  EXPECT_EQ(deep.maps.normal.texels(), plain.maps.normal.texels());
}

TEST(MultiLightFit, IsTheSameToTheBitForAnyNumberOfThreads) {
  const LitSurface surface = lit(rollingMaps(40, 40, {0.1f, 0.2f}), Model::kGgx, dome(16));
  const auto with = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return fitOf(surface.samples, calmOptions());
  };
  const MultiLightFit one = with(1), two = with(2);
  EXPECT_THAT(one.maps.diffuse, ImageNear(two.maps.diffuse, 0));
  EXPECT_THAT(one.maps.roughness, ImageNear(two.maps.roughness, 0));
  EXPECT_THAT(one.maps.normal, ImageNear(two.maps.normal, 0));
  EXPECT_EQ(one.report.residual_rms, two.report.residual_rms);
}

TEST(MultiLightFit, LeavesShadowsAndClippedLevelsOut) {
  const BrdfMaps truth = rollingMaps(32, 20, {0.1f, 0.25f});
  LitSurface surface = lit(truth, Model::kGgx, dome(24));
  for (std::size_t i = 0; i < 24; i += 6)  // a bar's shadow in every sixth picture
    for (int y = 5; y < 12; ++y)
      for (int x = 0; x < 32; ++x)
        for (int c = 0; c < 3; ++c) surface.pictures[i].at(x, y, c) *= 0.03f;
  MultiLightOptions options = calmOptions();
  options.saturated = 0.6f;
  for (auto& picture : surface.pictures)
    for (float& v : picture.texels()) v = std::min(v, 0.6f);
  const MultiLightFit fit = fitOf(surface.samples, options);
  EXPECT_LT(rms(fit.maps.diffuse, truth.diffuse), 0.012);
  EXPECT_LT(medianAngleDeg(fit.maps.normal, truth.normal), 0.4);
  EXPECT_GT(fit.report.left_out, 4.0 / 24 * 7 / 20);
}

// The floor of a crack: it is matt, not a mirror that the lamps which reach it happen to meet.
TEST(MultiLightFit, ACrackThatHalfOfTheLampsReachKeepsItsColour) {
  const BrdfMaps truth = rollingMaps(32, 20, {0.03f, 0.6f});
  LitSurface surface = lit(truth, Model::kGgx, dome(24), 0.001);
  for (std::size_t i = 12; i < 24; ++i)  // the low ones
    for (int y = 8; y < 11; ++y)
      for (int x = 0; x < 32; ++x)
        for (int c = 0; c < 3; ++c) surface.pictures[i].at(x, y, c) = 0;
  MultiLightOptions options = calmOptions();
  options.deep_shadows = true;
  const MultiLightFit fit = fitOf(surface.samples, options);
  EXPECT_LT(rms(fit.maps.diffuse, truth.diffuse), 0.01);
  EXPECT_LT(rms(fit.maps.specular, truth.specular), 0.02);
}

// A cliff's edge: half of the pixel is in shadow of all lamps but four here and there.
TEST(MultiLightFit, APixelThatAShadowDividesAlikeUnderMostLampsIsNotTold) {
  LitSurface surface = lit(rollingMaps(32, 20, {0.03f, 0.6f}), Model::kGgx, dome(24), 0.001);
  for (std::size_t i = 0; i < 24; ++i)
    for (int y = 0; y < 20 && i % 6 != 5; ++y)
      for (int c = 0; c < 3; ++c) surface.pictures[i].at(10, y, c) *= 0.5f;
  MultiLightOptions options = calmOptions();
  options.deep_shadows = true;
  const MultiLightFit fit = fitOf(surface.samples, options);
  for (int y = 0; y < 20; ++y) {
    EXPECT_EQ(fit.told.at(10, y), 0) << y;
    for (const int x : {0, 9, 11, 31}) EXPECT_EQ(fit.told.at(x, y), 1) << x << "," << y;
  }
}

TEST(MultiLightFit, KnowsNearLampsByTheirPlaceAndFallOff) {
  const BrdfMaps truth = rollingMaps(32, 20, {0.15f, 0.3f});
  std::vector<SurfaceLight> lamps = dome(24);
  BrdfSetInfo info;
  LitSurface surface;
  for (SurfaceLight& lamp : lamps) {
    lamp.near = true;
    lamp.position_mm = {120 * lamp.direction.x, 120 * lamp.direction.y, 120 * lamp.direction.z};
    lamp.beam_exponent = 2;
    lamp.strength = 120 * 120;
    surface.pictures.push_back(relight(truth, info, lamp, {0, 0, 1}, 2));
  }
  for (std::size_t i = 0; i < lamps.size(); ++i)
    surface.samples.push_back({surface.pictures[i].view(), lamps[i], {0, 0, 1}});
  MultiLightOptions options = calmOptions();
  options.mm_per_texel = 2;
  const MultiLightFit fit = fitOf(surface.samples, options);
  EXPECT_LT(rms(fit.maps.diffuse, truth.diffuse), 0.01);
  EXPECT_LT(medianAngleDeg(fit.maps.normal, truth.normal), 0.1);
}

TEST(MultiLightFit, HighlightsNarrowerThanTheLampsSpacingAreSharedAmongNeighbours) {
  const BrdfMaps truth = rollingMaps(48, 32, {0.3f, 0.06f});
  const LitSurface surface = lit(truth, Model::kGgx, dome(24));
  MultiLightOptions alone = calmOptions();
  alone.neighbours = false;
  const double by_itself = rms(fitOf(surface.samples, alone).maps.roughness, truth.roughness);
  const double shared = rms(fitOf(surface.samples, calmOptions()).maps.roughness, truth.roughness);
  EXPECT_LT(shared, 0.55 * by_itself);
  EXPECT_LT(shared, 0.03);
}

// Slate: all texels together tell its roughness well, and no noise of theirs may move it one way.
TEST(MultiLightFit, NoiseDoesNotShiftTheRoughnessOfAWideFaintLobe) {
  BrdfMaps truth = rollingMaps(128, 96, {0.035f, 0.5f});
  for (float& v : truth.diffuse.texels()) v = 0.1f;
  for (std::size_t i = 0; i < truth.normal.texels().size(); ++i)
    truth.normal.texels()[i] = i % 3 == 2 ? 1.0f : 0.0f;
  MultiLightOptions options = calmOptions();
  options.noise = {1e-4f, 4.9e-5f, 3e-4f};
  const LitSurface surface = lit(truth, Model::kGgx, dome(24), 0.007 * std::sqrt(3.0));
  const MultiLightFit fit = fitOf(surface.samples, options);
  float off = 0, off_specular = 0;
  for (const float v : fit.maps.roughness.texels()) off += (v - 0.5f) / (128 * 96);
  for (const float v : fit.maps.specular.texels()) off_specular += (v - 0.035f) / (128 * 96 * 3);
  EXPECT_NEAR(off, 0, 0.008f);
  EXPECT_NEAR(off_specular, 0, 0.003f);
}

TEST(MultiLightFit, HoldsAGlossThatItCannotTellToThatOfAnotherTimeStep) {
  const BrdfMaps truth = rollingMaps(24, 16, {0.06f, 0.25f});
  const LitSurface surface = lit(truth, Model::kGgx, dome(7, 40), 0.02);
  MultiLightOptions alone = calmOptions();
  alone.neighbours = false;
  alone.noise.shot = 4e-4f;
  const Image<float> sure(24, 16, 1, 1.0f);
  Progress progress;
  const FitBefore before{truth.specular.view(), truth.roughness.view(), sure.view()};
  const MultiLightFit held = fitManyLights(surface.samples, alone, {before}, progress);
  const MultiLightFit free = fitOf(surface.samples, alone);
  EXPECT_LT(rms(held.maps.roughness, truth.roughness),
            0.5 * rms(free.maps.roughness, truth.roughness));
}

// Lamps that are off by 0.4 % are enough for a wide lobe to pass for the diffuse part, or the other
// way round, in all texels alike.
TEST(MultiLightFit, TakesAWideLobeThatLampsDoNotTellForADielectrics) {
  constexpr float kOff = 0.004f;
  const BrdfMaps truth = rollingMaps(32, 20, {0.03f, 0.65f});
  MultiLightOptions options = calmOptions(), open = options;
  options.noise.gain = open.noise.gain = kOff;
  open.specular_spread = 1;
  double held = 0, free = 0;
  for (const int seed : {5, 6, 7, 8}) {
    LitSurface surface = lit(truth, Model::kGgx, dome(24), 0.001);
    for (std::size_t i = 0; i < surface.pictures.size(); ++i)
      for (float& v : surface.pictures[i].texels())
        v *= 1 + kOff * static_cast<float>(gaussian(hashSeed(seed, i)));
    const BrdfMaps maps = fitOf(surface.samples, options).maps;
    EXPECT_LT(rms(maps.specular, truth.specular), 0.02);
    EXPECT_LT(rms(maps.diffuse, truth.diffuse), 0.01);
    held += rms(maps.specular, truth.specular);
    free += rms(fitOf(surface.samples, open).maps.specular, truth.specular);
  }
  EXPECT_GT(free, 1.3 * held);
}

TEST(MultiLightFit, ConfidenceSeparatesWhatLightsTellFromWhatTheyDoNot) {
  BrdfMaps truth = rollingMaps(32, 16, {0.2f, 0.25f});
  for (int y = 0; y < 16; ++y)
    for (int x = 16; x < 32; ++x)
      for (int c = 0; c < 3; ++c) truth.specular.at(x, y, c) = 0;
  const LitSurface surface = lit(truth, Model::kWard, dome(24));
  const MultiLightFit fit = fitOf(surface.samples, calmOptions(Model::kWard));
  const Image<float>& confidence = fit.maps.extra.at("Confidence");
  double glossy = 0, matt = 0;
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 16; ++x) {
      glossy += confidence.at(x, y) / 256;
      matt += confidence.at(x + 16, y) / 256;
    }
  EXPECT_GT(glossy, 0.5);
  EXPECT_LT(matt, 0.2);
}

TEST(MultiLightFit, BlackAndUnknownTexelsHaveAStatedFallback) {
  LitSurface surface = lit(rollingMaps(20, 10, {0.1f, 0.3f}), Model::kGgx, dome(12));
  for (auto& picture : surface.pictures)
    for (int c = 0; c < 3; ++c) {
      picture.at(3, 4, c) = 0;
      picture.at(7, 2, c) = std::nanf("");
    }
  const MultiLightFit fit = fitOf(surface.samples, calmOptions());
  EXPECT_EQ(fit.report.black, 2);
  for (const auto& [x, y] : {std::pair{3, 4}, std::pair{7, 2}}) {
    EXPECT_EQ(fit.maps.diffuse.at(x, y), 0);
    EXPECT_EQ(fit.maps.normal.at(x, y, 2), 1);
    EXPECT_EQ(fit.maps.extra.at("Confidence").at(x, y), 0);
  }
  for (const float v : fit.maps.roughness.texels()) ASSERT_TRUE(v > 0 && v <= 1);
  for (const float v : fit.maps.specular.texels()) ASSERT_TRUE(std::isfinite(v));
}

TEST(MultiLightFit, StopsWhenAskedTo) {
  const LitSurface surface = lit(rollingMaps(20, 10, {0.1f, 0.3f}), Model::kGgx, dome(12));
  Progress progress;
  progress.askToStop();
  EXPECT_THROW(fitManyLights(surface.samples, calmOptions(), {}, progress), Stopped);
}

}  // namespace
}  // namespace patina::brdf
