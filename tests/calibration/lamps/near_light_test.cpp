// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/lamps/near_light.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "calibration/lamps/mirror_sphere.h"
#include "processing/image/random.h"
#include "tests/calibration/lamps/lamp_ring.h"

namespace patina::calibration {
namespace {

using Vec = std::array<double, 3>;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

double distance(const Vec& a, const Vec& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

// A card of 200 mm, seen at 21 x 21 places, with relative noise.
std::vector<ShadedPoint> shadedCard(const NearLight& light, double noise) {
  std::vector<ShadedPoint> points;
  for (int y = -10; y <= 10; ++y)
    for (int x = -10; x <= 10; ++x) {
      ShadedPoint point;
      point.at_mm = {10.0 * x, 10.0 * y, 0};
      point.level = irradiance(light, point.at_mm, point.normal) *
                    (1 + noise * gaussian(hashSeed(3, static_cast<std::uint64_t>(x + 100),
                                                   static_cast<std::uint64_t>(y + 100))));
      points.push_back(point);
    }
  return points;
}

NearLight lampAt(const Vec& position_mm, double beam_exponent = 0) {
  NearLight light;
  light.position_mm = position_mm;
  light.strength = 1e5;
  light.beam_exponent = beam_exponent;
  return light;
}

NearLight placed(const std::vector<ShadedPoint>& points, const ShadingOptions& options = {}) {
  Progress progress;
  return positionFromShading(points, options, progress);
}

TEST(NearLight, FallsWithTheSquareAndTheCosine) {
  const NearLight light = lampAt({0, 0, 100});
  EXPECT_NEAR(irradiance(light, {0, 0, 0}, {0, 0, 1}), 10, 1e-9);
  EXPECT_NEAR(irradiance(light, {100, 0, 0}, {0, 0, 1}), 10 / std::pow(2, 1.5), 1e-9);
  EXPECT_EQ(irradiance(light, {0, 0, 0}, {0, 0, -1}), 0);
  EXPECT_NEAR(irradiance(lampAt({0, 0, 100}, 4), {100, 0, 0}, {0, 0, 1}), 10 / std::pow(2, 1.5) / 4,
              1e-9);
}

TEST(NearLight, IsPlacedExactlyByNoiselessShading) {
  for (const Vec& truth : {Vec{180, -90, 260}, Vec{0, 0, 400}, Vec{-350, 50, 150}}) {
    const NearLight found = placed(shadedCard(lampAt(truth), 0));
    EXPECT_LT(distance(found.position_mm, truth), 0.01);
    EXPECT_NEAR(found.strength / 1e5, 1, 1e-3);
  }
}

TEST(NearLight, IsPlacedWithinItsUncertaintyByNoisyShading) {
  const Vec truth{180, -90, 260};
  const NearLight found = placed(shadedCard(lampAt(truth), 0.005));
  for (int i = 0; i < 3; ++i) {
    EXPECT_LT(std::abs(found.position_mm[i] - truth[i]), 4 * found.sigma_mm[i]);
    EXPECT_LT(found.sigma_mm[i], 5);
  }
  EXPECT_NEAR(found.residual_rms, 0.005, 0.001);
}

TEST(NearLight, WithAConeGivesThatToo) {
  const Vec truth{120, 60, 300};
  ShadingOptions options;
  options.beam = true;
  const NearLight found = placed(shadedCard(lampAt(truth, 6), 0.001), options);
  EXPECT_LT(distance(found.position_mm, truth), 5);
  EXPECT_NEAR(found.beam_exponent, 6, 4 * found.beam_exponent_sigma);
}

TEST(NearLight, OfTheTwinIsPlacedByItsGreyCard) {
  LampRing ring;
  ring.lamps_mm = {{180, -90, 260}};
  ring.specimen = "grey_card";
  ring.size = "256x256";
  RingTwin twin(ring);
  const Image<float> picture = twin.pictureOf(0, std::chrono::milliseconds(20));
  const std::vector<float> falloff =
      twin::lensFalloff(picture.size(), twin::referenceProfile().lens);
  std::vector<ShadedPoint> points;
  const twin::SampleGrid& grid = twin.maker().grid();
  const RectPx patch = twin.maker().layout().patch_px;
  for (int y = 8; y < 256 - 8; y += 16)
    for (int x = 8; x < 256 - 8; x += 16) {
      if (x < patch.x + patch.width + 16 && y > patch.y - 16) continue;
      double sum = 0;
      for (int v = -6; v < 6; ++v)
        for (int u = -6; u < 6; ++u)
          sum += picture.at(x + u, y + v, 1) / falloff[grid.index(x + u, y + v)] / 144;
      const std::size_t k = grid.index(x, y);
      points.push_back({{grid.x_mm[k], grid.y_mm[k], 0}, {0, 0, 1}, sum});
    }
  const NearLight found = placed(points);
  std::printf("near lamp by its card: %.1f mm off, sigma %.1f %.1f %.1f mm\n",
              distance(found.position_mm, ring.lamps_mm[0]), found.sigma_mm[0], found.sigma_mm[1],
              found.sigma_mm[2]);
  EXPECT_LT(distance(found.position_mm, ring.lamps_mm[0]), 0.03 * 330);
}

TEST(NearLight, OfTheTwinIsPlacedByThreeSpheres) {
  LampRing ring;
  ring.lamps_mm = {{180, -90, 260}, {-100, 120, 350}};
  ring.size = "320x320";
  std::vector<std::vector<LightRay>> rays(2);
  for (const Vec& middle : {Vec{-18, 12, 8}, Vec{18, -4, 8}, Vec{4, 17, 8}}) {
    ring.targets = {mirrorSphere(middle, 16)};
    RingTwin twin(ring);
    SphereOptions options;
    options.camera.focal_px = 1.2 * 320;
    options.camera.k1 = -0.12;
    options.camera.k2 = 0.03;
    Progress progress;
    const SphereLights found = lightsFromSphere(
        {2, [&](int i) { return twin.pictureOf(i, std::chrono::microseconds(200)); }}, options,
        progress);
    for (int i = 0; i < 2; ++i) {
      LightRay ray;
      for (int k = 0; k < 3; ++k) ray.from_mm[k] = middle[k] + 8 * found.lights[i].normal[k];
      ray.direction = found.lights[i].direction;
      rays[i].push_back(ray);
    }
  }
  for (int i = 0; i < 2; ++i) {
    const NearLight found = positionFromRays(rays[i]);
    std::printf("near lamp by three spheres: %.1f mm off\n",
                distance(found.position_mm, ring.lamps_mm[i]));
    EXPECT_LT(distance(found.position_mm, ring.lamps_mm[i]), 10);
    EXPECT_LT(found.residual_rms, 0.3);
  }
}

TEST(NearLight, OfRaysIsWhereTheyMeet) {
  const Vec truth{50, 60, 300};
  std::vector<LightRay> rays;
  for (const Vec& from : {Vec{-40, 0, 0}, Vec{40, 10, 0}, Vec{0, -50, 5}}) {
    LightRay ray;
    ray.from_mm = from;
    const double length = distance(from, truth);
    for (int k = 0; k < 3; ++k) ray.direction[k] = (truth[k] - from[k]) / length;
    rays.push_back(ray);
  }
  const NearLight found = positionFromRays(rays);
  EXPECT_LT(distance(found.position_mm, truth), 1e-4);
  EXPECT_GT(found.sigma_mm[2], found.sigma_mm[0]) << "depth is what rays know least";
}

TEST(NearLight, RefusesWhatDoesNotTellAPlace) {
  LightRay ray;
  ray.direction = {0, 0, 1};
  LightRay beside = ray;
  beside.from_mm = {30, 0, 0};
  EXPECT_THAT(([&] { positionFromRays({ray}); }),
              ThrowsMessage<CalibrationError>(HasSubstr("two or more")));
  EXPECT_THAT(([&] {
                positionFromRays({ray, beside});
              }),
              ThrowsMessage<CalibrationError>(HasSubstr("nearly parallel")));
  std::vector<ShadedPoint> card = shadedCard(lampAt({180, -90, 260}), 0);
  EXPECT_THAT(([&] {
                placed({card.begin(), card.begin() + 5});
              }),
              ThrowsMessage<CalibrationError>(HasSubstr("12 points")));
  EXPECT_THAT(([&] {
                placed(shadedCard(lampAt({1e4, 0, 5e4}), 0.005));
              }),
              ThrowsMessage<CalibrationError>(HasSubstr("too far away")));
  for (std::size_t i = 0; i < card.size(); i += 3) card[i].level *= 1.2;
  EXPECT_THAT(([&] { placed(card); }),
              ThrowsMessage<CalibrationError>(HasSubstr("not that of one near lamp")));
  card[0].level = 0;
  EXPECT_THAT(([&] { placed(card); }), ThrowsMessage<CalibrationError>(HasSubstr("not lit")));
}

}  // namespace
}  // namespace patina::calibration
