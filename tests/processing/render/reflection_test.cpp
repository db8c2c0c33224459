// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/render/reflection.h"

#include <gtest/gtest.h>

#include <cmath>

#include "processing/render/sample_points.h"

namespace patina::render {
namespace {

using mesh::V3f;

const Reflection kMatte{{0.8f, 0.4f, 0.2f}, 0, 1};
const Reflection kGlossy{{0.8f, 0.4f, 0.2f}, 0.05f, 0.25f};

V3f at(double degrees, double around = 0) {
  const double a = degrees * M_PI / 180;
  return {static_cast<float>(std::sin(a) * std::cos(around)),
          static_cast<float>(std::sin(a) * std::sin(around)), static_cast<float>(std::cos(a))};
}

// Over the dome, by the midpoint rule.
template <class Of>
double overDome(const Of& of) {
  double sum = 0;
  for (int i = 0; i < 300; ++i)
    for (int j = 0; j < 300; ++j) {
      const double z = (i + 0.5) / 300;
      sum += of(at(std::acos(z) * 180 / M_PI, 2 * M_PI * (j + 0.5) / 300));
    }
  return sum * 2 * M_PI / (300 * 300);
}

TEST(Reflection, OfAMatteSurfaceSendsItsColourOn) {
  EXPECT_NEAR(overDome([](const V3f& l) { return kMatte.towards(l, at(30)).x; }), 0.8, 1e-4);
}

TEST(Reflection, NeverMakesLight) {
  for (const double degrees : {0.0, 40.0, 75.0, 88.0})
    for (const float roughness : {0.1f, 0.4f, 1.0f}) {
      const Reflection white{{1, 1, 1}, 0.2f, roughness};
      EXPECT_LT(overDome([&](const V3f& l) { return white.towards(l, at(degrees)).x; }), 1.005)
          << degrees << ' ' << roughness;
    }
}

TEST(Reflection, IsTheSameWithEyeAndLightExchanged) {
  const V3f a = at(20, 0.3), b = at(65, 2.1);
  EXPECT_NEAR(kGlossy.towards(a, b).y / a.z, kGlossy.towards(b, a).y / b.z, 1e-6);
}

TEST(Reflection, DrawsDirectionsAsDenselyAsItSays) {
  const V3f v = at(50, 0.7);
  EXPECT_NEAR(overDome([&](const V3f& l) { return kGlossy.density(l, v); }), 1, 0.02);
  const double want = overDome([&](const V3f& l) { return kGlossy.towards(l, v).x; });
  double got = 0;
  constexpr int kDraws = 60000;
  for (std::uint32_t i = 0; i < kDraws; ++i) {
    SamplePoints points(9, i, kDraws);
    const auto which = points.next(), where = points.next();
    const V3f l = kGlossy.draw(v, which, where);
    if (l.z > 0) got += kGlossy.towards(l, v).x / kGlossy.density(l, v) / kDraws;
  }
  EXPECT_NEAR(got, want, 0.01);
}

}  // namespace
}  // namespace patina::render
