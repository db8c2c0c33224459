// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/sensor/rounded_noise.h"

#include <gtest/gtest.h>

#include <cmath>

#include "processing/image/random.h"

namespace patina::calibration {
namespace {

TEST(RoundedMoments, FollowTheLawOfOneTwelfthOnlyAboveOneStep) {
  for (const double mean : {64.0, 64.3, 64.5}) {
    EXPECT_NEAR(roundedMoments(mean, 1.5).variance, 1.5 * 1.5 + 1.0 / 12, 1e-6);
    EXPECT_NEAR(roundedMoments(mean, 1.5).mean, mean, 1e-6);
  }
  EXPECT_NEAR(roundedMoments(64, 0.1).variance, 0, 1e-5);
  EXPECT_NEAR(roundedMoments(64.5, 0.1).variance, 0.25, 1e-5);
}

// Pixels whose means spread by `spread` about `mean`, each read twice.
double sigmaFound(double mean, double spread, double sigma) {
  double sum = 0, squares = 0, difference2 = 0;
  const int pixels = 200'000;
  for (int i = 0; i < pixels; ++i) {
    const double own = mean + spread * gaussian(hashSeed(1, i));
    const double a = std::round(own + sigma * gaussian(hashSeed(2, i))),
                 b = std::round(own + sigma * gaussian(hashSeed(3, i)));
    sum += a + b;
    squares += a * a + b * b;
    difference2 += (a - b) * (a - b);
  }
  const double n = 2.0 * pixels, m = sum / n;
  return sigmaBehindRounding(m, squares / n - m * m, difference2 / pixels / 2);
}

TEST(SigmaBehindRounding, IsFoundBelowAndAboveOneStepWhateverThePhase) {
  for (const double sigma : {0.3, 0.4, 0.8, 3.0})
    for (const double mean : {64.0, 64.25, 64.5})
      EXPECT_NEAR(sigmaFound(mean, 0, sigma) / sigma, 1, 0.02) << sigma << " at " << mean;
}

TEST(SigmaBehindRounding, IsNotTheSpreadOfThePixels) {
  for (const double spread : {0.2, 1.0, 5.0})
    EXPECT_NEAR(sigmaFound(64.1, spread, 0.4) / 0.4, 1, 0.02) << spread;
}

}  // namespace
}  // namespace patina::calibration
