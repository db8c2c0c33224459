// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/registered_sweeps.h"

#include <gmock/gmock.h>

#include "calibration/failure.h"
#include "capture/workflow/failure.h"
#include "tests/capture/workflow/dome_run.h"

namespace patina::workflow {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::vector<SweepPicture> sweep(double x_px, std::uint64_t seed = 1) {
  std::vector<SweepPicture> pictures;
  for (std::size_t lamp = 0; lamp < 4; ++lamp)
    pictures.push_back({lamp, testing::wavyMaps(x_px, seed).diffuse});
  return pictures;
}

double largestDifference(const Image<float>& a, const Image<float>& b, const RectPx& region) {
  double most = 0;
  for (int y = region.y; y < region.y + region.height; ++y)
    for (int x = region.x; x < region.x + region.width; ++x)
      most = std::max<double>(most, std::abs(a.at(x, y, 1) - b.at(x, y, 1)));
  return most;
}
constexpr RectPx kMiddle{6, 6, 52, 36};

class Registered : public ::testing::Test {
 protected:
  RegisteredSweeps with(const RegistrationRequest& request, std::optional<PixelMap> map = {}) {
    return {request, {"a", "b", "c", "d"}, std::move(map), progress_};
  }
  Progress progress_;
};

TEST_F(Registered, LaysEveryLampOverTheFirstStep) {
  RegisteredSweeps sweeps = with({});
  std::vector<SweepPicture> first = sweep(0), second = sweep(1.3);
  EXPECT_GT(largestDifference(first[2].linear, second[2].linear, kMiddle), 0.03) << "before";
  sweeps.lay(0, first, true);
  sweeps.lay(1, second, true);
  ASSERT_EQ(second.size(), 4u);
  EXPECT_LT(largestDifference(first[2].linear, second[2].linear, kMiddle), 0.006);
  EXPECT_TRUE(sweeps.notes().empty());
}

TEST_F(Registered, ComposesWithAMapSoThatGeometryIsResampledOnce) {
  RegisteredSweeps sweeps = with({}, identityMap({20, 10, 32, 24}));
  std::vector<SweepPicture> first = sweep(0), second = sweep(1.3);
  sweeps.lay(0, first, true);
  sweeps.lay(1, second, true);
  EXPECT_EQ(first[0].linear.size(), (SizePx{32, 24}));
  EXPECT_NEAR(first[0].linear.at(5, 7, 1), sweep(0)[0].linear.at(25, 17, 1), 1e-5);
  EXPECT_LT(largestDifference(first[1].linear, second[1].linear, {0, 0, 32, 24}), 0.006);
}

TEST_F(Registered, LeavesOutAndNamesWhatCannotBeTrusted) {
  RegisteredSweeps sweeps = with({});
  std::vector<SweepPicture> first = sweep(0), second = sweep(0.5);
  sweeps.lay(0, first, true);
  second[1].linear = sweep(0.5, 7)[1].linear;
  sweeps.lay(8, second, true);
  ASSERT_EQ(second.size(), 3u);
  EXPECT_EQ(second[1].state, 2u);
  EXPECT_THAT(sweeps.notes(), ElementsAre(HasSubstr("1 of 8 frames refused: step 8 b (lost: ")));
}

TEST_F(Registered, WithoutResamplingOnlyTracks) {
  RegisteredSweeps sweeps = with({});
  std::vector<SweepPicture> first = sweep(0), second = sweep(1.3);
  sweeps.lay(0, first, false);
  sweeps.lay(1, second, false);
  EXPECT_EQ(largestDifference(second[0].linear, sweep(1.3)[0].linear, {0, 0, 64, 48}), 0);
}

TEST_F(Registered, WhatIsNotKnownIsFollowedAsWhiteAndStaysUnknown) {
  RegisteredSweeps sweeps = with({});
  std::vector<SweepPicture> first = sweep(0), second = sweep(1.5);
  for (SweepPicture& one : second)
    for (int c = 0; c < 3; ++c) one.linear.at(30, 20, c) = std::nanf("");
  sweeps.lay(0, first, true);
  sweeps.lay(1, second, true);
  ASSERT_EQ(second.size(), 4u);
  for (const int x : {28, 29}) EXPECT_TRUE(std::isnan(second[0].linear.at(x, 20, 1))) << x;
  EXPECT_NEAR(second[0].linear.at(40, 20, 1), first[0].linear.at(40, 20, 1), 0.006);
}

TEST_F(Registered, WhatLiesAsTheFirstStaysTheSensorsOwn) {
  RegisteredSweeps sweeps = with({});
  std::vector<SweepPicture> first = sweep(0), still = sweep(0.05), moved = sweep(0.3);
  sweeps.lay(0, first, true);
  sweeps.lay(1, still, true);
  sweeps.lay(2, moved, true);
  EXPECT_FALSE(first[0].resampled || still[0].resampled);
  EXPECT_EQ(still[0].linear.texels(), sweep(0.05)[0].linear.texels());
  EXPECT_TRUE(moved[0].resampled);
}

TEST_F(Registered, RefusesWhatItDoesNotDo) {
  RegistrationRequest deform;
  deform.deform = true;
  EXPECT_THROW(with(deform), WorkflowError);
  RegistrationRequest outside;
  outside.fiducials = {{60, 0, 64, 48}};
  RegisteredSweeps sweeps = with(outside);
  std::vector<SweepPicture> first = sweep(0);
  EXPECT_THROW(sweeps.lay(0, first, true), calibration::CalibrationError);
}

}  // namespace
}  // namespace patina::workflow
