// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/reflectance_fit.h"

#include <gmock/gmock.h>

#include <cmath>

#include "capture/workflow/failure.h"
#include "processing/image/encoding.h"
#include "processing/image/picture_file.h"
#include "tests/processing/brdf/lit_maps.h"
#include "tests/support/temp_folder.h"

namespace patina::workflow {
namespace {

namespace fs = std::filesystem;
using patina::testing::TempFolder;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr int kLights = 16;

// A small surface under a dome of lights as 8-bit PNG and dirs.lp.
class ReflectanceFit : public ::testing::Test {
 protected:
  ReflectanceFit() {
    const brdf::BrdfMaps maps = brdf::rollingMaps(24, 20, {0.1f, 0.3f});
    for (const brdf::SurfaceLight& light : brdf::dome(kLights)) {
      Image<float> picture = brdf::relight(maps, {}, light);
      for (float& v : picture.texels()) v *= 0.8f;
      const std::string name = "p" + std::to_string(lights_.size() + 1) + ".png";
      writePng(folder_ / name, encodeSrgb8(picture.view()).view());
      lights_.push_back({name, {light.direction.x, light.direction.y, light.direction.z}});
    }
    request_.folder = folder_.path();
    request_.lights = folder_ / "dirs.lp";
    request_.fit.noise = {0.003f, 0, 0.02f};
    writeLights(request_.lights, lights_);
  }
  ReflectanceOutcome fit() {
    Progress progress;
    return fitReflectance(request_, progress);
  }
  std::string refusal(Exit exit) {
    try {
      fit();
    } catch (const Failure& e) {
      EXPECT_EQ(e.exit(), exit) << e.what();
      return e.what();
    }
    return "(accepted)";
  }

  TempFolder folder_ = TempFolder::inMemory();
  std::vector<LightDirection> lights_;
  ReflectanceRequest request_;
};

TEST_F(ReflectanceFit, PredictsPicturesLeftOutBetterThanLambertAndPolynomials) {
  request_.leave_out = {4, 8};
  const ReflectanceOutcome outcome = fit();
  ASSERT_TRUE(outcome.left_out);
  const LeftOutScores& scores = *outcome.left_out;
  EXPECT_EQ(scores.pictures, 2);
  EXPECT_TRUE(scores.stored);
  EXPECT_EQ(outcome.pictures.size(), kLights - 2u);
  EXPECT_GT(scores.model.psnr_db, scores.lambert.psnr_db + 1.5);
  EXPECT_GT(scores.model.psnr_db, scores.polynomial.psnr_db);
  EXPECT_GT(scores.model.psnr_db, 38);
}

TEST_F(ReflectanceFit, TheResidualHelpsWhereTheModelFails) {
  for (const LightDirection& light : lights_) {  // lamps of unequal strength, smoothly so
    Picture picture = readPicture(folder_ / light.file);
    const auto gain = static_cast<float>(0.7 + 0.3 * std::sin(3 * light.direction[0]));
    for (float& v : picture.linear.texels()) v *= gain;
    writePng(folder_ / light.file, encodeSrgb8(picture.linear.view()).view());
  }
  request_.leave_out = {4, 8};
  const ReflectanceOutcome outcome = fit();
  ASSERT_TRUE(outcome.left_out->with_residual);
  EXPECT_GT(outcome.left_out->with_residual->psnr_db, outcome.left_out->model.psnr_db);
}

TEST_F(ReflectanceFit, ASetShowsThePicturesItWasFittedTo) {
  const ReflectanceOutcome outcome = fit();
  writeReflectance(folder_ / "set", request_, outcome);
  const auto& d = lights_[5].direction;
  const SetPicture seen =
      pictureOfSet(folder_ / "set", 0,
                   brdf::normalized({static_cast<float>(d[0]), static_cast<float>(d[1]),
                                     static_cast<float>(d[2])}));
  EXPECT_TRUE(seen.stored);
  const Picture truth = readPicture(folder_ / lights_[5].file);
  for (int x = 0; x < 24; ++x)
    EXPECT_NEAR(seen.picture.at(x, 9, 1), srgbFromLinear(truth.linear.at(x, 9, 1)), 0.02f);
  EXPECT_TRUE(brdf::readBrdfMaps(folder_ / "set", brdf::readBrdfSetInfo(folder_ / "set"))
                  .extra.count("Confidence"));
}

TEST_F(ReflectanceFit, LightsNotOfLengthOneAreMadeSoWithAWarning) {
  lights_[2].direction = {0, 0, 3};
  lights_[3].direction[0] *= 2;
  lights_[3].direction[1] *= 2;
  lights_[3].direction[2] *= 2;
  writeLights(request_.lights, lights_);
  EXPECT_THAT(fit().warnings, ElementsAre(HasSubstr("2 of 16 lights")));
}

TEST_F(ReflectanceFit, ALightFileThatNamesAMissingPictureIsRefused) {
  fs::remove(folder_ / "p7.png");
  EXPECT_THAT(refusal(Exit::kBadData), HasSubstr("names p7.png, which is not in"));
}

TEST_F(ReflectanceFit, AnotherCountThanItListsIsRefused) {
  patina::testing::writeFile(request_.lights, "3\np1.png 0 0 1\n");
  EXPECT_THAT(refusal(Exit::kBadData), HasSubstr("says 3 lights but lists 1"));
}

TEST_F(ReflectanceFit, OneLightAPlaneOfLightsAndLightsBehindAreRefused) {
  writeLights(request_.lights, {lights_[0]});
  EXPECT_THAT(refusal(Exit::kBadData), HasSubstr("1 light does not tell"));
  auto flat = lights_;
  for (LightDirection& light : flat) light.direction[1] = 0;
  writeLights(request_.lights, flat);
  EXPECT_THAT(refusal(Exit::kBadData), HasSubstr("one plane"));
  auto behind = lights_;
  for (LightDirection& light : behind) light.direction[2] *= -1;
  writeLights(request_.lights, behind);
  EXPECT_THAT(refusal(Exit::kBadData), HasSubstr("all lights lie behind"));
}

TEST_F(ReflectanceFit, NumbersLeftOutThatTheFileHasNotAreRefused) {
  request_.leave_out = {17};
  EXPECT_THAT(refusal(Exit::kUsage), HasSubstr("names light 17; the light file has 1 to 16"));
}

TEST_F(ReflectanceFit, PicturesThatDifferInSizeAreRefused) {
  writePng(folder_ / "p3.png", Image<std::uint8_t>(8, 8, 3).view());
  EXPECT_THAT(refusal(Exit::kBadData), HasSubstr("p3.png is 8x8"));
}

}  // namespace
}  // namespace patina::workflow
