// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/lens/fiducials.h"

#include <gmock/gmock.h>

#include <cmath>

#include "tests/calibration/lens/twin_boards.h"

namespace patina::calibration {
namespace {

// The markers of a 3x3 ChArUco board lie in its four white squares: a sheet of fiducials.
constexpr SizePx kSize{320, 240};
constexpr double kSquareMm = 24;
Image<float> sheet(const devices::twin::CameraPose& pose) {
  return greyOf(testing::shootTwin(kSize, pose,
                                   {testing::placed(testing::charuco(3, 3, kSquareMm), {5, 5, 0})})
                    .view());
}
const std::vector<Fiducial> kSheet{{0, 5, 29, 0}, {1, -19, 5, 0}, {2, 29, 5, 0}, {3, 5, -19, 0}};

TEST(Fiducials, TellWhereTheCameraStandsInTheRigsOwnMillimetres) {
  auto pose = testing::overhead(0, 1.4);
  pose.position_mm = {-40, -60, 170};
  const FiducialSight sight = findFiducials(sheet(pose).view(), kSheet, 0.75 * kSquareMm);
  EXPECT_TRUE(sight.missing.empty());
  ASSERT_EQ(sight.plane.seen_px.size(), 16u);
  const ViewFit fit = fitView(testing::trueLens(kSize, pose), sight.plane);
  const PointMm at = fit.report.camera_mm;
  EXPECT_LT(std::hypot(at.x + 40, at.y + 60, at.z - 170), 2);
  EXPECT_LT(fit.report.rms_px, 0.5);
}

TEST(Fiducials, ThatAreMissingAreNamedAndNoneAtAllIsAnError) {
  const Image<float> picture = sheet(testing::overhead(170, 1.4));
  const std::vector<Fiducial> more{{0, 5, 29, 0}, {7, 0, 0, 0}};
  EXPECT_THAT(findFiducials(picture.view(), more, 18).missing, ::testing::ElementsAre(7));
  EXPECT_THROW(findFiducials(picture.view(), std::vector<Fiducial>{{9, 0, 0, 0}}, 18),
               CalibrationError);
  EXPECT_THROW(findFiducials(picture.view(), std::vector<Fiducial>{{1, 0, 0, 0}, {1, 5, 0, 0}}, 18),
               CalibrationError);
  EXPECT_THROW(findFiducials(picture.view(), kSheet, 0), CalibrationError);
}

}  // namespace
}  // namespace patina::calibration
