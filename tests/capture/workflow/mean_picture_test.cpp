// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/mean_picture.h"

#include <gmock/gmock.h>

#include "capture/workflow/failure.h"
#include "processing/image/encoding.h"
#include "tests/capture/workflow/small_run.h"

namespace patina::workflow {
namespace {

using testing::MadeShot;
using testing::MadeStep;
using testing::TempFolder;

class MeanPictures : public ::testing::Test {
 protected:
  MeanPicture mean(const MeanPictureRequest& request) {
    Progress progress;
    return meanPicture(folder_ / "archive", request, testing::now(), progress);
  }
  TempFolder folder_ = TempFolder::inMemory();
};

TEST_F(MeanPictures, OfAFolderIsLinearAndTakesNoMoreThanAskedFor) {
  testing::plantPngs(folder_ / "white", 3);  // levels 40, 50, 60
  MeanPictureRequest request;
  request.folder = folder_ / "white";
  request.light = "key";
  request.frames_most = 2;
  const MeanPicture found = mean(request);
  EXPECT_EQ(found.frames, 2);
  EXPECT_EQ(found.input_sha256s.size(), 2u);
  EXPECT_EQ(found.row.light_state, "key");
  EXPECT_NEAR(found.linear.at(3, 3),
              (linearFromSrgb(40.0f / 255) + linearFromSrgb(50.0f / 255)) / 2, 1e-5);
}

TEST_F(MeanPictures, OfARunIsWithoutItsLightGains) {
  testing::MadeShot shot;
  shot.checks = {testing::check("g", 0.5, "correct", 2)};
  testing::makeRun(folder_ / "archive", {{{shot}}, {{shot}}});
  MeanPictureRequest request;
  request.run = "latest";
  const MeanPicture found = mean(request);
  EXPECT_EQ(found.frames, 2);
  EXPECT_EQ(found.row.device_id, "cam0");
  EXPECT_EQ(found.row.light_state, "key");
  EXPECT_NEAR(found.linear.at(2, 2, 1), linearFromSrgb(100.0f / 255), 1e-5);
}

TEST_F(MeanPictures, TellThePatchsMeanLevelWhereEachOfThemDoes) {
  MadeStep one{{MadeShot{}}}, other = one, silent = one;
  one.shots[0].checks = {testing::check("y", 1.02, "measure")};
  other.shots[0].checks = {testing::check("y", 0.98, "measure")};
  for (MadeStep* step : {&one, &other}) step->shots[0].checks[0].baseline = 0;
  testing::makeRun(folder_ / "archive", {one, other, silent});
  MeanPictureRequest request;
  request.run = "latest";
  request.frames_most = 2;
  EXPECT_NEAR((*mean(request).patch)[1], 0.5, 1e-9);
  request.frames_most = 3;
  EXPECT_FALSE(mean(request).patch);
}

TEST_F(MeanPictures, NeedPicturesOfOneSize) {
  MeanPictureRequest request;
  request.folder = folder_ / "mixed";
  std::filesystem::create_directories(request.folder);
  EXPECT_THROW(mean(request), WorkflowError) << "none at all";
  testing::plantPng(request.folder / "a.png", {24, 16}, 100);
  testing::plantPng(request.folder / "b.png", {16, 16}, 100);
  EXPECT_THROW(mean(request), WorkflowError);
}

}  // namespace
}  // namespace patina::workflow
