// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/rectified_frames.h"

#include <gmock/gmock.h>

#include "capture/workflow/failure.h"
#include "capture/workflow/ttf_product.h"
#include "capture/workflow/view_calibration.h"
#include "capture/workflow/vignetting_calibration.h"
#include "tests/capture/workflow/small_run.h"

namespace patina::workflow {
namespace {

constexpr SizePx kSize{24, 16};

// Frames whose level rises to the right: place in the picture, in pixels.
class Ramps final : public ttf::FrameSource {
 public:
  std::int64_t count() const override { return 1; }
  std::optional<ttf::SourceFrame> next() override {
    if (std::exchange(given_, true)) return std::nullopt;
    Image<float> ramp(kSize.width, kSize.height, 1);
    for (int y = 0; y < kSize.height; ++y)
      for (int x = 0; x < kSize.width; ++x) ramp.at(x, y) = static_cast<float>(x);
    return ttf::SourceFrame{7, {}, std::move(ramp)};
  }

 private:
  bool given_ = false;
};

TEST(RectifiedFrames, AreLeftAsTheyAreWithoutMapAndFallOff) {
  Ramps ramps;
  RectifiedFrames frames(ramps, {}, {});
  EXPECT_EQ(frames.count(), 1);
  const auto frame = frames.next();
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->linear.at(11, 5), 11);
  EXPECT_EQ(frame->time_s, 7);
  EXPECT_FALSE(frames.next());
}

TEST(RectifiedFrames, AreFreedOfTheFallOffBeforeTheyAreMapped) {
  Ramps ramps;
  RectifiedFrames frames(ramps, calibration::Vignetting{-0.3, 0, 0}, identityMap({4, 0, 8, 5}));
  const auto frame = frames.next();
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->linear.size(), (SizePx{8, 5}));
  const double r = calibration::radiusAt(kSize, 6, 1);
  EXPECT_NEAR(frame->linear.at(2, 1), 6 / (1 - 0.3 * r * r), 1e-4);
}

class RectifiedRun : public ::testing::Test {
 protected:
  RectifiedRun() {
    testing::makeRun(archive_, std::vector<testing::MadeStep>(3, {{testing::MadeShot{}}}));
  }
  // 2 px a mm, straight down.
  void keepView(SizePx size = kSize, std::chrono::hours ago = {}) {
    ViewCalibration made;
    made.lens = {size, 100, 100, 11.5, 7.5, 0, 0, 0, 0, 0};
    made.fit.view = {{1, 0, 0, 0, -1, 0, 0, 0, -1}, {0, 0, 50}};
    made.taken = testing::now() - ago;
    ViewRequest request;
    request.camera = "cam0";
    workflow::keepView(archive_, made, request, testing::now());
  }
  void keepFallOff(std::chrono::hours ago) {
    VignettingCalibration made;
    made.fit.vignetting = {-0.5, 0, 0};
    made.size = kSize;
    made.taken = testing::now() - ago;
    keepVignetting(archive_, made, {}, "cam0", testing::now());
  }
  TtfOutcome build(const std::optional<RectifyRequest>& rectify) {
    TtfRequest request;
    request.run = "latest";
    request.rectify = rectify;
    Progress progress;
    return makeTtf(archive_, request, testing::now(), progress);
  }
  std::string refusal() {
    try {
      build(RectifyRequest{});
    } catch (const WorkflowError& e) {
      return e.what();
    }
    return "none";
  }
  testing::TempFolder folder_ = testing::TempFolder::inMemory();
  const std::filesystem::path archive_ = folder_ / "archive";
};

TEST_F(RectifiedRun, BecomesATextureInMillimetresThatNamesItsView) {
  keepView();
  const TtfOutcome outcome = build(RectifyRequest{calibration::RegionMm{-2, -1.5, 4, 3}, 4});
  EXPECT_EQ(outcome.size, (SizePx{16, 12}));
  EXPECT_DOUBLE_EQ(outcome.mm_per_texel, 0.25);
  EXPECT_THAT(outcome.calibrations, ::testing::ElementsAre("view 1: 0.0 days away"));
  const ttf::TtfReader reader(outcome.path);
  EXPECT_DOUBLE_EQ(reader.info().mm_per_texel, 0.25);
  EXPECT_THAT(outcome.product.input_sha256s.size(), 4u) << "three frames and the view";
  EXPECT_THAT(outcome.product.options_json, ::testing::HasSubstr("\"left_mm\":-2"));
}

TEST_F(RectifiedRun, TakesWhatIsSeenAtThePicturesOwnResolutionWhenNothingIsAsked) {
  keepView();
  const TtfOutcome outcome = build(RectifyRequest{});
  EXPECT_EQ(outcome.size, (SizePx{23, 15}));
  EXPECT_NEAR(outcome.mm_per_texel, 0.5, 1e-6);
}

TEST_F(RectifiedRun, IsRefusedWithoutAViewOfThisSizeOfPicture) {
  EXPECT_THAT(refusal(), ::testing::HasSubstr("patina calibrate view"));
  keepView({48, 32});
  EXPECT_THAT(refusal(), ::testing::HasSubstr("48x32"));
}

TEST_F(RectifiedRun, RefusesAViewOfLongAgoUnlessItIsToBeTaken) {
  keepView(kSize, std::chrono::hours(24 * 100));
  EXPECT_THAT(refusal(), ::testing::HasSubstr("view 1: 100 days away, at most 90"));
  TtfRequest request;
  request.run = "latest";
  request.rectify.emplace();
  request.correction.stale = true;
  Progress progress;
  EXPECT_THAT(makeTtf(archive_, request, testing::now(), progress).calibrations,
              ::testing::ElementsAre("view 1: 100.0 days away"));
}

TEST_F(RectifiedRun, SaysThatAFallOffOfLongAgoWasLeftOut) {
  keepFallOff(std::chrono::hours(24 * 100));
  const TtfOutcome outcome = build({});
  EXPECT_TRUE(outcome.calibrations.empty());
  ASSERT_EQ(outcome.calibrations_left.size(), 1u);
  EXPECT_THAT(outcome.calibrations_left[0],
              ::testing::HasSubstr("vignetting 1: 100 days away, at most 90; shoot an even"));
  EXPECT_EQ(Facts::parse(outcome.product.metadata_json).texts("calibrations_left"),
            outcome.calibrations_left)
      << "and the catalogue knows";
}

TEST_F(RectifiedRun, IsFreedOfItsLensFallOffUnlessItIsToBeUncorrected) {
  keepFallOff({});
  const auto corner = [&](bool masters) {
    TtfRequest request;
    request.run = "latest";
    request.correction.masters = masters;
    Progress progress;
    const TtfOutcome outcome = makeTtf(archive_, request, testing::now(), progress);
    EXPECT_EQ(outcome.calibrations.size(), masters ? 1u : 0u);
    return ttf::TtfReader(outcome.path).frame(0).at(0, 0);
  };
  EXPECT_GT(corner(true), 1.6 * corner(false));
}

}  // namespace
}  // namespace patina::workflow
