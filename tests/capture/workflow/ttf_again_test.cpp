// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/ttf_again.h"

#include <gmock/gmock.h>

#include "capture/workflow/failure.h"
#include "capture/workflow/master.h"
#include "tests/capture/workflow/small_run.h"

namespace patina::workflow {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

class TtfAgain : public ::testing::Test {
 protected:
  TtfAgain() {
    testing::MadeShot brief, longer;
    brief.size = longer.size = {48, 40};
    brief.exposure = 1;
    brief.exposed = std::chrono::milliseconds(10);
    testing::makeRun(archive_, std::vector<testing::MadeStep>(4, {{longer, brief}}));
    request_.run = "latest";
    request_.selection.exposure = 0;
    request_.command = "patina ttf build";
  }
  void makeDark() {
    std::filesystem::create_directories(folder_ / "darks");
    for (int i = 0; i < 3; ++i)
      testing::plantPng(folder_ / "darks" / (std::to_string(i) + ".png"), {48, 40}, 30);
    MasterRequest dark;
    dark.kind = "dark";
    dark.folder = folder_ / "darks";
    dark.camera = "cam0";
    dark.exposure = std::chrono::milliseconds(20);
    dark.iso = 100;
    makeMaster(archive_, dark, testing::now(), progress_);
  }
  TtfOutcome build(const TtfRequest& request) {
    return makeTtf(archive_, request, testing::now(), progress_);
  }
  testing::TempFolder folder_ = testing::TempFolder::inMemory();
  const std::filesystem::path archive_ = folder_ / "archive";
  TtfRequest request_;
  Progress progress_;
};

TEST_F(TtfAgain, IsTheSameFileWhereNothingIsNewer) {
  request_.selection.every = 2;
  request_.build.region = RectPx{2, 3, 10, 8};
  request_.build.scale = 0.5;
  request_.build.mm_per_texel = 0.25;
  request_.process = "greening";
  const TtfOutcome first = build(request_);
  const TtfOutcome again = build(requestOf(first.product));
  EXPECT_NE(again.product.id, first.product.id);
  EXPECT_EQ(again.product.options_json, first.product.options_json);
  EXPECT_EQ(ttf::TtfReader(again.path).linearFrame(0).texels(),
            ttf::TtfReader(first.path).linearFrame(0).texels());
  EXPECT_DOUBLE_EQ(again.mm_per_texel, 0.25);
  EXPECT_THAT(again.product.metadata_json, HasSubstr("greening"));
}

TEST_F(TtfAgain, IsRegisteredRectifiedAndInColourAsItWas) {
  db::ProductRow product = build(request_).product;
  product.options_json.pop_back();
  product.options_json +=
      R"(,"register":"affine","markers":true,"deform":true,"fiducials":["1,2,30,40"],)"
      R"("colour":"xyz-d50","left_mm":-5,"bottom_mm":-4,"width_mm":10,"height_mm":8,)"
      R"("mm_per_texel":0.25})";
  const TtfRequest back = requestOf(product);
  ASSERT_TRUE(back.registration);
  EXPECT_EQ(back.registration->model, calibration::MotionModel::kAffine);
  EXPECT_TRUE(back.registration->markers && back.registration->deform);
  ASSERT_EQ(back.registration->fiducials.size(), 1u);
  EXPECT_EQ(rectText(back.registration->fiducials[0]), "1,2,30,40");
  EXPECT_EQ(back.colour, calibration::ColourSpace::kXyz);
  ASSERT_TRUE(back.rectify && back.rectify->region);
  EXPECT_EQ(back.rectify->region->left, -5);
  EXPECT_EQ(back.rectify->texels_per_mm, 4);
}

TEST_F(TtfAgain, TakesACalibrationThatWasMadeSince) {
  const TtfOutcome first = build(request_);
  makeDark();
  const TtfOutcome again = build(requestOf(first.product));
  EXPECT_THAT(again.calibrations, ::testing::ElementsAre(HasSubstr("dark 1")));
  EXPECT_LT(ttf::TtfReader(again.path).linearFrame(0).at(3, 3),
            ttf::TtfReader(first.path).linearFrame(0).at(3, 3));
}

TEST_F(TtfAgain, StaysUncorrectedAndMergedAsItWas) {
  makeDark();
  request_.correction = {false, false, false};
  request_.field = FieldUse::kNone;
  EXPECT_TRUE(build(requestOf(build(request_).product)).calibrations.empty());
  TtfRequest merged;
  merged.run = "latest";
  merged.selection.merged = true;
  const TtfRequest back = requestOf(build(merged).product);
  EXPECT_TRUE(back.selection.merged);
  EXPECT_TRUE(back.correction.masters);
  EXPECT_EQ(build(back).frames.exposures, 2);
}

TEST_F(TtfAgain, OfAProductThatDoesNotSayHowIsRefused) {
  db::ProductRow old;
  old.id = "ttf-old-1";
  old.options_json = R"({"camera":"cam0","light":"key","every":1,"file":0,"exposure":0})";
  EXPECT_THAT(([&] { requestOf(old); }),
              ThrowsMessage<WorkflowError>(HasSubstr("ttf-old-1 does not say its field_use")));
}

}  // namespace
}  // namespace patina::workflow
