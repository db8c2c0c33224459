// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/after_run.h"

#include <gmock/gmock.h>

#include "tests/capture/workflow/dome_run.h"

namespace patina::workflow {
namespace {

using testing::MadeShot;
using testing::MadeStep;
using testing::TempFolder;

class AfterRun : public ::testing::Test {
 protected:
  AfterRun() {
    MadeShot key, fill, dark;
    fill.light = "fill";
    dark.light = "off";
    run_ = testing::makeRun(folder_.path(), std::vector<MadeStep>(3, {{key, fill, dark}}));
  }
  std::vector<AfterProduct> finish(const std::vector<std::string>& steps) {
    AfterOptions options;
    options.steps = steps;
    Progress progress;
    return finishRun(folder_.path(), run_, options, testing::now, progress);
  }
  TempFolder folder_ = TempFolder::inMemory();
  std::string run_;
};

TEST_F(AfterRun, MakesATextureAndAFilmForEachLightButTheDark) {
  const auto products = finish({"ttf", "film"});
  std::vector<std::string> kinds;
  for (const AfterProduct& product : products) {
    kinds.push_back(product.kind);
    EXPECT_TRUE(std::filesystem::exists(product.path)) << product.path;
  }
  EXPECT_THAT(kinds, ::testing::ElementsAre("ttf", "film", "ttf", "film"));
}

TEST_F(AfterRun, CompletesWhatWasCutShortAndMakesNothingTwice) {
  finish({"ttf"});
  const auto products = finish({"ttf", "film"});
  ASSERT_EQ(products.size(), 4u);
  for (const AfterProduct& product : products) EXPECT_EQ(product.made, product.kind == "film");
  for (const AfterProduct& product : finish({"ttf", "film"})) EXPECT_FALSE(product.made);
}

TEST_F(AfterRun, MakesAgainWhatSomebodyDeleted) {
  std::filesystem::remove(finish({"ttf"}).front().path);
  const auto products = finish({"ttf"});
  EXPECT_TRUE(products[0].made);
  EXPECT_FALSE(products[1].made);
}

TEST(AfterADomesRun, ReflectanceAndItsAgeingAreMadeOnceAndGoOnFromWhatWasFed) {
  const TempFolder folder = TempFolder::inMemory();
  const std::string run = testing::makeDomeRun(folder.path(), 3);
  AfterOptions options;
  options.steps = {"stbrdf"};
  options.lamps = testing::domeRig();
  Progress progress;
  feedRun(folder.path(), run, options, progress);
  EXPECT_TRUE(db::ArchiveReader(folder.path()).products("brdf").empty());
  const auto products = finishRun(folder.path(), run, options, testing::now, progress);
  ASSERT_EQ(products.size(), 2u);
  EXPECT_EQ(products[0].kind, "brdf");
  EXPECT_EQ(products[1].kind, "stbrdf");
  for (const AfterProduct& product : finishRun(folder.path(), run, options, testing::now, progress))
    EXPECT_FALSE(product.made);
}

TEST(AfterADomesRun, FramesAreLaidOverTheFirstStepWhereThePlanAsksAndWhatIsLeftOutIsSaid) {
  const TempFolder folder = TempFolder::inMemory();
  const std::string run = testing::makeDomeRun(folder.path(), 3, -1, [](int step) {
    return testing::wavyMaps(1.5 * step, step == 1 ? 7 : 1);
  });
  AfterOptions options;
  options.steps = {"brdf"};
  options.lamps = testing::domeRig();
  options.registration.emplace();
  Progress progress;
  const auto products = finishRun(folder.path(), run, options, testing::now, progress);
  ASSERT_EQ(products.size(), 1u);
  EXPECT_EQ(brdf::readBrdfSetInfo(products[0].path.parent_path()).steps(), 2);
  EXPECT_THAT(products[0].warnings, ::testing::Contains(::testing::HasSubstr("step 1 left out")));
}

TEST_F(AfterRun, DoesNothingUnlessAsked) { EXPECT_TRUE(finish({}).empty()); }

}  // namespace
}  // namespace patina::workflow
