// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/run_reflectance.h"

#include <gmock/gmock.h>

#include "capture/workflow/failure.h"
#include "tests/capture/workflow/dome_run.h"

namespace patina::workflow {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::TempFolder;

// Stops when the second step begins to be fitted.
class StopsInTheSecondStep final : public Progress {
 public:
  void begin(std::string_view stage, std::int64_t) override {
    if (stage == "reflectance" && ++fits_ == 2) askToStop();
  }

 private:
  int fits_ = 0;
};

std::map<std::string, std::string> bytesBelow(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file())
      files[fs::relative(entry.path(), folder)] = sha256OfFile(entry.path()).hex();
  return files;
}

class RunReflectance : public ::testing::Test {
 protected:
  RunReflectanceOutcome fit(const RunReflectanceRequest& request) {
    Progress progress;
    return fitRun(folder_.path(), request, testing::now(), progress);
  }
  TempFolder folder_ = TempFolder::inMemory();
};

TEST_F(RunReflectance, GivesASetForEachStepWithItsTime) {
  const auto outcome = fit(testing::domeRequest(testing::makeDomeRun(folder_.path(), 3)));
  const brdf::BrdfSetInfo info = brdf::readBrdfSetInfo(outcome.set);
  EXPECT_THAT(info.times, ElementsAre(110, 710, 1310));
  for (int step = 0; step < 3; ++step) {
    const brdf::BrdfMaps maps = brdf::readBrdfMaps(outcome.set, info, step);
    const brdf::BrdfMaps truth = testing::domeTruth();
    const double bright = testing::domeBrightness(info.times[static_cast<std::size_t>(step)]);
    Image<float> diffuse = truth.diffuse;
    for (float& v : diffuse.texels()) v *= static_cast<float>(bright);
    EXPECT_LT(brdf::rms(maps.diffuse, diffuse), 0.01);
    EXPECT_LT(brdf::medianAngleDeg(maps.normal, truth.normal), 0.5);
  }
  ASSERT_TRUE(outcome.product);
  EXPECT_EQ(outcome.product->kind, "brdf");
  EXPECT_EQ(outcome.product->input_sha256s.size(), 3u * testing::kDomeLamps);
}

TEST_F(RunReflectance, LeavesPartialStepsOutAndNamesThem) {
  const auto outcome = fit(testing::domeRequest(testing::makeDomeRun(folder_.path(), 3, 1)));
  EXPECT_THAT(outcome.partial, ElementsAre(1));
  EXPECT_EQ(outcome.steps.size(), 2u);
}

TEST_F(RunReflectance, ThatWasStoppedGoesOnAndGivesTheSameBytes) {
  const auto request = testing::domeRequest(testing::makeDomeRun(folder_.path(), 3));
  StopsInTheSecondStep stopping;
  EXPECT_THROW(fitRun(folder_.path(), request, testing::now(), stopping), Stopped);
  const auto outcome = fit(request);
  EXPECT_THAT((std::vector<bool>{outcome.steps[0].fitted, outcome.steps[1].fitted,
                                 outcome.steps[2].fitted}),
              ElementsAre(false, true, true));
  const TempFolder other = TempFolder::inMemory();
  testing::makeDomeRun(other.path(), 3);
  Progress progress;
  const auto undisturbed = fitRun(other.path(), request, testing::now(), progress);
  EXPECT_EQ(bytesBelow(outcome.set), bytesBelow(undisturbed.set));
}

TEST_F(RunReflectance, SoFarIsAllButTheLastStepAndNoProduct) {
  auto request = testing::domeRequest(testing::makeDomeRun(folder_.path(), 3));
  request.so_far = true;
  const auto so_far = fit(request);
  EXPECT_EQ(so_far.steps.size(), 2u);
  EXPECT_FALSE(so_far.product);
  request.so_far = false;
  const auto whole = fit(request);
  EXPECT_FALSE(whole.steps[1].fitted);
  EXPECT_TRUE(whole.steps[2].fitted);
}

TEST_F(RunReflectance, StepsOfOtherOptionsAreMadeAnew) {
  auto request = testing::domeRequest(testing::makeDomeRun(folder_.path(), 2));
  request.so_far = true;
  fit(request);
  request.so_far = false;
  request.white_level = 0.9;
  EXPECT_TRUE(fit(request).steps[0].fitted);
}

// Three steps, each a pixel and a half to the right; of the second something else is seen.
class RegisteredReflectance : public RunReflectance {
 protected:
  static RunReflectanceRequest shoot(const TempFolder& folder, std::uint64_t second) {
    auto request =
        testing::domeRequest(testing::makeDomeRun(folder.path(), 3, -1, [second](int step) {
          return testing::wavyMaps(1.5 * step, step == 1 ? second : 1);
        }));
    request.frames.registration.emplace();
    return request;
  }
};

TEST_F(RegisteredReflectance, ShowsTheSamePlaceAtEveryStep) {
  const auto outcome = fit(shoot(folder_, 1));
  const brdf::BrdfSetInfo info = brdf::readBrdfSetInfo(outcome.set);
  ASSERT_EQ(info.steps(), 3);
  const RectPx middle{8, 4, 48, 40};
  for (int step = 0; step < 3; ++step) {
    const brdf::BrdfMaps maps = brdf::readBrdfMaps(outcome.set, info, step);
    Image<float> want = testing::wavyMaps(0, 1).diffuse;
    for (float& v : want.texels())
      v *= static_cast<float>(testing::domeBrightness(info.times[static_cast<std::size_t>(step)]));
    EXPECT_LT(brdf::rms(copyOf<float>(maps.diffuse.view().crop(middle)),
                        copyOf<float>(want.view().crop(middle))),
              0.01)  // without: 0.05 and more
        << step;
  }
}

TEST_F(RegisteredReflectance, LeavesOutAndNamesAStepWhosePlaceNoLampTells) {
  const auto outcome = fit(shoot(folder_, 7));
  EXPECT_THAT(outcome.left_out, ElementsAre(1));
  EXPECT_THAT(brdf::readBrdfSetInfo(outcome.set).times, ElementsAre(110, 1310));
  EXPECT_THAT(outcome.warnings,
              ::testing::IsSupersetOf({HasSubstr("step 1 left out: 0 lights do not tell"),
                                       HasSubstr("12 of 36 frames refused: step 1 l0 (lost: ")}));
}

TEST_F(RegisteredReflectance, GoesOnBehindAStepThatWasLeftOutWithTheSameBytes) {
  const auto request = shoot(folder_, 7);
  StopsInTheSecondStep stopping;
  EXPECT_THROW(fitRun(folder_.path(), request, testing::now(), stopping), Stopped);
  const auto outcome = fit(request);
  EXPECT_FALSE(outcome.steps[0].fitted);
  const TempFolder other = TempFolder::inMemory();
  Progress progress;
  const auto undisturbed = fitRun(other.path(), shoot(other, 7), testing::now(), progress);
  EXPECT_EQ(bytesBelow(outcome.set), bytesBelow(undisturbed.set));
}

TEST_F(RunReflectance, BinsPixelsIntoTexels) {
  auto request = testing::domeRequest(testing::makeDomeRun(folder_.path(), 1));
  request.bin = 3;
  const auto outcome = fit(request);
  EXPECT_EQ(brdf::readBrdfSetInfo(outcome.set).size, (SizePx{6, 5}));
  request.bin = 17;
  EXPECT_THROW(fit(request), WorkflowError);
}

TEST_F(RunReflectance, DoesNotWriteIntoWhatIsThereAlready) {
  auto request = testing::domeRequest(testing::makeDomeRun(folder_.path(), 1));
  request.out = folder_ / "out";
  fit(request);
  try {
    fit(request);
    FAIL();
  } catch (const WorkflowError& error) {
    EXPECT_EQ(error.exit(), Exit::kCannotCreate);
  }
}

}  // namespace
}  // namespace patina::workflow
