// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/lamps/mirror_sphere.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/calibration/lamps/lamp_ring.h"

namespace patina::calibration {
namespace {

using Vec = std::array<double, 3>;
using std::chrono::microseconds;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

double degreesBetween(const Vec& a, const Vec& b) {
  const double dot = a[0] * b[0] + a[1] * b[1] + a[2] * b[2],
               length = std::sqrt((a[0] * a[0] + a[1] * a[1] + a[2] * a[2]) *
                                  (b[0] * b[0] + b[1] * b[1] + b[2] * b[2]));
  return std::acos(std::min(dot / length, 1.0)) * 180 / M_PI;
}

// The reference profile's lens, of a picture so wide.
SphereCamera referenceCamera(int width_px) {
  const twin::LensProfile& lens = twin::referenceProfile().lens;
  SphereCamera camera;
  camera.focal_px = lens.focal_length * width_px;
  camera.k1 = lens.k1;
  camera.k2 = lens.k2;
  return camera;
}

SphereShots shotsOf(RingTwin& ring, Nanoseconds exposure) {
  return {
      static_cast<int>(ring.lamps()),
      [&ring, exposure](int i) { return ring.pictureOf(static_cast<std::size_t>(i), exposure); },
      [](int i) { return "lamp " + std::to_string(i); }};
}

// Of every lamp: how far the direction found is from the lamp as the highlight's place sees it.
std::vector<double> errorsDeg(const SphereLights& found, const LampRing& ring) {
  const devices::TargetSpec& sphere = ring.targets.at(0);
  std::vector<double> errors;
  for (std::size_t i = 0; i < found.lights.size(); ++i) {
    Vec truth;
    for (int k = 0; k < 3; ++k)
      truth[k] = ring.lamps_mm[i][k] -
                 (sphere.position_mm[k] + sphere.width_mm / 2 * found.lights[i].normal[k]);
    errors.push_back(degreesBetween(truth, found.lights[i].direction));
  }
  return errors;
}

double worst(const std::vector<double>& errors) {
  return *std::max_element(errors.begin(), errors.end());
}

TEST(MirrorSphere, GivesTwentyFourLampsToHalfADegree) {
  LampRing ring;
  ring.lamps_mm = lampsAround(24, 500);
  ring.targets = {mirrorSphere({12, 8, 10}, 20)};
  RingTwin twin(ring);
  SphereOptions options;
  options.camera = referenceCamera(512);
  Progress progress;
  const SphereLights found = lightsFromSphere(shotsOf(twin, microseconds(200)), options, progress);
  const std::vector<double> errors = errorsDeg(found, ring);
  double sum = 0;
  for (const double e : errors) sum += e;
  std::printf(
      "24 lamps, sphere found at %.2f, %.2f, r %.2f (rim rms %.2f px): mean %.3f, worst "
      "%.3f degrees\n",
      found.sphere.disc().x_px, found.sphere.disc().y_px, found.sphere.disc().radius_px,
      found.sphere.report().rms_px, sum / 24, worst(errors));
  EXPECT_LE(worst(errors), 0.5);
}

TEST(MirrorSphere, SeesTheMiddleOfAClippedHighlight) {
  LampRing ring;
  ring.lamps_mm = lampsAround(6, 500);
  ring.targets = {mirrorSphere({-10, 5, 10}, 20)};
  RingTwin twin(ring);
  SphereOptions options;
  options.camera = referenceCamera(512);
  Progress progress;
  const SphereLights found =
      lightsFromSphere(shotsOf(twin, microseconds(10'000)), options, progress);
  EXPECT_GT(found.lights[0].clipped_share, 0.3);
  std::printf("clipped: worst %.3f degrees\n", worst(errorsDeg(found, ring)));
  EXPECT_LE(worst(errorsDeg(found, ring)), 0.5);
}

TEST(MirrorSphere, IsAnEllipseToAPinholeCamera) {
  LampRing ring;
  ring.lamps_mm = lampsAround(8, 600);
  ring.targets = {mirrorSphere({25, -18, 15}, 24)};
  ring.pose.distant = false;
  ring.pose.position_mm = {0, 0, 150};
  RingTwin twin(ring);
  SphereOptions options;
  options.camera = referenceCamera(512);
  options.camera.pinhole = true;
  Progress progress;
  const SphereLights found = lightsFromSphere(shotsOf(twin, microseconds(200)), options, progress);
  std::printf("pinhole: worst %.3f degrees\n", worst(errorsDeg(found, ring)));
  EXPECT_LE(worst(errorsDeg(found, ring)), 0.5);
  const Vec middle = found.sphere.middle();
  EXPECT_NEAR(middle[0] * 12, 25, 0.5) << "in radii, from the camera";
  EXPECT_NEAR(middle[2] * 12, 15 - 150, 1.5);
}

TEST(MirrorSphere, TakesTheDiscItIsGiven) {
  LampRing ring;
  ring.lamps_mm = lampsAround(3, 500);
  ring.targets = {mirrorSphere({0, 0, 10}, 20)};
  RingTwin twin(ring);
  SphereOptions options;
  options.camera = referenceCamera(512);
  Progress progress;
  const Disc found =
      lightsFromSphere(shotsOf(twin, microseconds(200)), options, progress).sphere.disc();
  options.given = found;
  const SphereLights given = lightsFromSphere(shotsOf(twin, microseconds(200)), options, progress);
  EXPECT_TRUE(given.sphere.report().given);
  EXPECT_LE(worst(errorsDeg(given, ring)), 0.5);
}

// A black ball on grey with round highlights.
struct Ball {
  Disc disc{60, 50, 30};
  std::vector<std::array<double, 3>> spots;  // x, y, radius in pixels
  float level = 0.8f;
};
Image<float> drawn(const Ball& ball, SizePx size = {120, 100}) {
  Image<float> picture(size.width, size.height, 1, 0.3f);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      if (std::hypot(x + 0.5 - ball.disc.x_px, y + 0.5 - ball.disc.y_px) < ball.disc.radius_px)
        picture.at(x, y) = 0.02f;
      for (const auto& [u, v, r] : ball.spots)
        if (std::hypot(x + 0.5 - u, y + 0.5 - v) < r) picture.at(x, y) = ball.level;
    }
  return picture;
}
SphereShots shotsOf(std::vector<Image<float>> pictures) {
  return {static_cast<int>(pictures.size()), [pictures](int i) { return pictures[i]; }};
}
auto asking(const std::vector<Image<float>>& pictures, const SphereOptions& options) {
  return [=] {
    Progress progress;
    lightsFromSphere(shotsOf(pictures), options, progress);
  };
}

TEST(MirrorSphere, ReflectsStraightBackAtItsMiddleAndSidewaysHalfwayOut) {
  Ball ball;
  ball.spots = {{60, 50, 3}};
  SphereOptions options;
  options.given = ball.disc;
  Progress progress;
  EXPECT_NEAR(lightsFromSphere(shotsOf({drawn(ball)}), options, progress).lights[0].direction[2], 1,
              1e-3);
  // At sin 45 degrees of its radius the normal is turned by 45 degrees, the light by 90.
  ball.spots = {{60 + 30 * M_SQRT1_2, 50, 2}};
  const Vec aside = lightsFromSphere(shotsOf({drawn(ball)}), options, progress).lights[0].direction;
  EXPECT_NEAR(aside[0], 1, 0.02);
  EXPECT_NEAR(aside[2], 0, 0.1);
  ball.spots = {{60, 35, 2}};
  EXPECT_GT(lightsFromSphere(shotsOf({drawn(ball)}), options, progress).lights[0].direction[1], 0.8)
      << "up in the picture is y";
}

TEST(MirrorSphere, RefusesWhatShowsNoDirectionAndNamesTheShot) {
  SphereOptions options;
  Ball ball;
  options.given = ball.disc;
  Ball lit = ball;
  lit.spots = {{65, 45, 3}};
  Ball two = lit;
  two.spots.push_back({45, 60, 3});
  Ball all = ball;
  all.spots = {{60, 50, 25}};
  all.level = 1;
  EXPECT_THAT(asking({drawn(lit), drawn(ball)}, options),
              ThrowsMessage<CalibrationError>(HasSubstr("shot 2: the sphere shows no highlight")));
  EXPECT_THAT(asking({drawn(two)}, options),
              ThrowsMessage<CalibrationError>(HasSubstr("several highlights")));
  EXPECT_THAT(asking({drawn(all)}, options),
              ThrowsMessage<CalibrationError>(HasSubstr("saturated all over")));
  EXPECT_THAT(asking({drawn(lit), drawn(lit, {130, 100})}, options),
              ThrowsMessage<CalibrationError>(HasSubstr("shot 2 is of another size")));
  EXPECT_THAT(asking({}, options), ThrowsMessage<CalibrationError>(HasSubstr("no picture")));
  options.least = 0;
  EXPECT_THAT(asking({drawn(lit)}, options),
              ThrowsMessage<CalibrationError>(HasSubstr("least is 0")));
}

TEST(MirrorSphere, DoesNotTakeAHotPixelForASecondLamp) {
  Ball ball;
  ball.spots = {{65, 45, 2}};
  Image<float> picture = drawn(ball);
  picture.at(45, 60) = 1;
  SphereOptions options;
  options.given = ball.disc;
  Progress progress;
  EXPECT_NEAR(lightsFromSphere(shotsOf({picture}), options, progress).lights[0].x_px, 65, 0.2);
}

}  // namespace
}  // namespace patina::calibration
