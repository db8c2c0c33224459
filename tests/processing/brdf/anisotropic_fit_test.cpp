// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/brdf/anisotropic_fit.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "tests/processing/brdf/lit_maps.h"

namespace patina::brdf {
namespace {

constexpr int kSide = 12;

// Brushed along a direction that turns slowly from texel to texel.
BrdfMaps brushed(float along, float across) {
  BrdfMaps maps = rollingMaps(kSide, kSide, {0.3f, along});
  Image<float> tangent(kSide, kSide, 3);
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      const auto n = maps.normal.view().texel(x, y);
      const float angle = 0.15f * static_cast<float>(x) - 0.6f;
      const Vec3 flat{std::cos(angle), std::sin(angle), 0};
      const float off = dot(flat, {n[0], n[1], n[2]});
      const Vec3 t = normalized({flat.x - off * n[0], flat.y - off * n[1], flat.z - off * n[2]});
      const auto to = tangent.view().texel(x, y);
      to[0] = t.x, to[1] = t.y, to[2] = t.z;
    }
  maps.extra["Tangent"] = tangent;
  maps.extra["RoughnessY"] = Image<float>(kSide, kSide, 1, across);
  return maps;
}

double medianTurnDeg(const Image<float>& a, const Image<float>& b) {
  Image<float> same = b;
  for (int y = 0; y < a.height(); ++y)
    for (int x = 0; x < a.width(); ++x) {
      const auto p = a.view().texel(x, y);
      const auto q = same.view().texel(x, y);
      if (p[0] * q[0] + p[1] * q[1] + p[2] * q[2] < 0)
        for (float& v : q) v = -v;
    }
  return medianAngleDeg(a, same);
}

TEST(SplitRoughness, RecoversBothRoughnessesAndTheirDirection) {
  const BrdfMaps truth = brushed(0.5f, 0.2f);
  const LitSurface surface = lit(truth, Model::kWardAnisotropic, dome(48), 0.002);
  Progress progress;
  const MultiLightFit fit =
      fitManyLights(surface.samples, calmOptions(Model::kWardAnisotropic), {}, progress);
  EXPECT_LT(rms(fit.maps.roughness, truth.roughness), 0.03);
  EXPECT_LT(rms(fit.maps.extra.at("RoughnessY"), truth.extra.at("RoughnessY")), 0.02);
  EXPECT_LT(medianTurnDeg(fit.maps.extra.at("Tangent"), truth.extra.at("Tangent")), 2);
  EXPECT_LT(medianAngleDeg(fit.maps.normal, truth.normal), 0.5);
  EXPECT_LT(rms(fit.maps.diffuse, truth.diffuse), 0.01);
  EXPECT_LT(rms(fit.maps.specular, truth.specular), 0.02);
}

TEST(SplitRoughness, KeepsARoundLobeRound) {
  BrdfMaps truth = rollingMaps(kSide, kSide, {0.2f, 0.3f});
  const LitSurface surface = lit(truth, Model::kWard, dome(48), 0.002);
  Progress progress;
  const MultiLightFit fit =
      fitManyLights(surface.samples, calmOptions(Model::kWardAnisotropic), {}, progress);
  int round = 0;
  const Image<float>& across = fit.maps.extra.at("RoughnessY");
  for (std::size_t i = 0; i < across.texels().size(); ++i)
    round += across.texels()[i] > 0.85f * fit.maps.roughness.texels()[i];
  EXPECT_GT(round, kSide * kSide * 95 / 100);
}

TEST(SplitRoughness, RelitUnderLightsLeftOutIsCloserThanWithOneRoughness) {
  const BrdfMaps truth = brushed(0.6f, 0.2f);
  const LitSurface surface = lit(truth, Model::kWardAnisotropic, dome(36), 0.002);
  Progress progress;
  const MultiLightFit one = fitManyLights(surface.samples, calmOptions(Model::kWard), {}, progress),
                      two = fitManyLights(surface.samples, calmOptions(Model::kWardAnisotropic), {},
                                          progress);
  BrdfSetInfo as_one, as_two;
  as_one.model = Model::kWard;
  as_two.model = Model::kWardAnisotropic;
  double off_one = 0, off_two = 0;
  for (const SurfaceLight& light : dome(7, 60)) {
    const Image<float> want = relight(truth, as_two, light);
    off_one += rms(relight(one.maps, as_one, light), want);
    off_two += rms(relight(two.maps, as_two, light), want);
  }
  EXPECT_LT(off_two, 0.2 * off_one);
}

TEST(SplitRoughness, GivesTheSameBytesForAnyNumberOfThreads) {
  const LitSurface surface = lit(brushed(0.5f, 0.2f), Model::kWardAnisotropic, dome(24));
  const auto fitted = [&](std::size_t threads) {
    tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    Progress progress;
    return fitManyLights(surface.samples, calmOptions(Model::kWardAnisotropic), {}, progress)
        .maps.extra.at("RoughnessY")
        .texels();
  };
  EXPECT_EQ(fitted(1), fitted(8));
}

}  // namespace
}  // namespace patina::brdf
