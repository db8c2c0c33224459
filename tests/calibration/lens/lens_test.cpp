// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/lens/lens.h"

#include <gtest/gtest.h>

#include <cmath>

namespace patina::calibration {
namespace {

constexpr Lens kLens{{640, 480}, 500, 510, 322, 236, -0.12, 0.03, 1e-3, -2e-3, 0.01};

TEST(Lens, BendsRaysAsItsEquationsSay) {
  const double x = 0.3, y = -0.2, r2 = x * x + y * y;
  const double radial = 1 - 0.12 * r2 + 0.03 * r2 * r2 + 0.01 * r2 * r2 * r2;
  const std::vector<PlacePx> straight{{500 * x + 322, 510 * y + 236}};
  const PlacePx seen = distorted(kLens, straight)[0];
  EXPECT_NEAR(seen.x, 500 * (x * radial + 2e-3 * x * y - 2e-3 * (r2 + 2 * x * x)) + 322, 1e-9);
  EXPECT_NEAR(seen.y, 510 * (y * radial + 1e-3 * (r2 + 2 * y * y) - 4e-3 * x * y) + 236, 1e-9);
}

TEST(Lens, UndoesItsOwnDistortionInTheCornersToo) {
  const std::vector<PlacePx> seen{{0, 0}, {639, 0}, {639, 479}, {320, 240}, {-0.5, 479.5}};
  const std::vector<PlacePx> back = distorted(kLens, undistorted(kLens, seen));
  for (std::size_t i = 0; i < seen.size(); ++i) {
    EXPECT_NEAR(back[i].x, seen[i].x, 1e-6);
    EXPECT_NEAR(back[i].y, seen[i].y, 1e-6);
  }
}

TEST(Lens, KnowsTheWidestAngleItsPictureSees) {
  Lens plain = kLens;
  plain.k1 = plain.k2 = plain.k3 = plain.p1 = plain.p2 = 0;
  EXPECT_NEAR(widestRadius(plain), std::hypot(322.5 / 500, 243.5 / 510), 1e-9);
  EXPECT_GT(widestRadius(kLens), widestRadius(plain)) << "a barrel sees more";
}

TEST(Lens, IsRefusedWithNumbersNoCameraHas) {
  Lens lens = kLens;
  EXPECT_NO_THROW(lens.check());
  lens.k2 = std::nan("");
  EXPECT_THROW(lens.check(), CalibrationError);
  lens = kLens;
  lens.fy = 0;
  EXPECT_THROW(lens.check(), CalibrationError);
}

}  // namespace
}  // namespace patina::calibration
