// SPDX-License-Identifier: GPL-3.0-or-later
// The closed loop on the twin's specimens: their truth under 24 lights with the reference profile's
// sensor noise, fitted, and held against the truth and against six more lights. Prints its table.
#include <gtest/gtest.h>

#include <cstdio>

#include "devices/twin/specimen.h"
#include "processing/brdf/picture_score.h"
#include "tests/processing/brdf/lit_maps.h"

namespace patina::brdf {
namespace {

constexpr int kSize = 128;
constexpr double kFullWell = 30000, kReadNoise = 3, kLevelPerWell = 0.5 / 0.45;  // white: 1

struct Score {
  double diffuse_rms = 0, normal_median_deg = 0, psnr_worst_db = HUGE_VAL;
  double told_share = 0;  // of texels with three lights or more within a lobe's width
  double told_specular_rms = 0, told_alpha_rms = 0;
  double sure_share = 0, sure_specular_rms = 0, sure_alpha_rms = 0;  // confidence >= 1/2
};

void expose(Image<float>& picture, std::uint64_t seed) {
  for (std::size_t j = 0; j < picture.texels().size(); ++j) {
    const double e = std::min(1.0, picture.texels()[j] / kLevelPerWell) * kFullWell;
    const double seen = e + std::sqrt(e + kReadNoise * kReadNoise) * gaussian(hashSeed(5, seed, j));
    picture.texels()[j] = static_cast<float>(std::min(1.0, seen / kFullWell) * kLevelPerWell);
  }
}

bool isLeftOut(std::size_t light) { return light % 5 == 2; }

int lightsWithinLobe(const std::vector<FitSample>& samples, std::span<const float> n, float alpha) {
  int count = 0;
  for (const FitSample& sample : samples) {
    const float n_h = dot(halfway(sample.light.direction, {0, 0, 1}), {n[0], n[1], n[2]});
    count += n_h > 0 && std::sqrt(1 - std::min(1.0f, n_h * n_h)) <= alpha * n_h;
  }
  return count;
}

struct RmsOf {
  double square = 0;
  long count = 0;
  void add(double off2) { square += off2, ++count; }
  double rms() const { return count ? std::sqrt(square / static_cast<double>(count)) : 0; }
};

void scoreGloss(const MultiLightFit& fit, const BrdfMaps& truth,
                const std::vector<FitSample>& samples, Score& score) {
  RmsOf told_s, told_a, sure_s, sure_a;
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x) {
      double s2 = 0;
      for (int c = 0; c < 3; ++c) {
        const double off = double{fit.maps.specular.at(x, y, c)} - truth.specular.at(x, y, c);
        s2 += off * off / 3;
      }
      const float alpha = truth.roughness.at(x, y);
      const double a = double{fit.maps.roughness.at(x, y)} - alpha;
      if (lightsWithinLobe(samples, truth.normal.view().texel(x, y), alpha) < 3) continue;
      told_s.add(s2), told_a.add(a * a);
      if (fit.maps.extra.at("Confidence").at(x, y) >= 0.5f) sure_s.add(s2), sure_a.add(a * a);
    }
  score.told_share = static_cast<double>(told_s.count) / (kSize * kSize);
  score.sure_share = static_cast<double>(sure_s.count) / std::max(1L, told_s.count);
  score.told_specular_rms = told_s.rms(), score.told_alpha_rms = told_a.rms();
  score.sure_specular_rms = sure_s.rms(), score.sure_alpha_rms = sure_a.rms();
}

Score scoreOf(const std::string& name) {
  auto maps = devices::twin::makeSpecimen(name, 1)->surfaceAt(0.5, {kSize, kSize});
  const BrdfMaps truth{std::move(maps.diffuse),
                       std::move(maps.specular),
                       std::move(maps.roughness),
                       std::move(maps.normal),
                       {}};
  const std::vector<SurfaceLight> lights = dome(30, 72);
  std::vector<Image<float>> pictures;
  for (std::size_t i = 0; i < lights.size(); ++i) {
    pictures.push_back(relight(truth, {}, lights[i]));
    expose(pictures.back(), i);
  }
  std::vector<FitSample> samples;
  for (std::size_t i = 0; i < lights.size(); ++i)
    if (!isLeftOut(i)) samples.push_back({pictures[i].view(), lights[i], {0, 0, 1}});
  MultiLightOptions options;
  options.noise = {static_cast<float>(kReadNoise / kFullWell),
                   static_cast<float>(kLevelPerWell / kFullWell), 0.001f};
  options.saturated = static_cast<float>(0.995 * kLevelPerWell);
  Progress progress;
  const MultiLightFit fit = fitManyLights(samples, options, {}, progress);
  Score score;
  score.diffuse_rms = rms(fit.maps.diffuse, truth.diffuse);
  score.normal_median_deg = medianAngleDeg(fit.maps.normal, truth.normal);
  scoreGloss(fit, truth, samples, score);
  for (std::size_t i = 0; i < lights.size(); ++i) {
    if (!isLeftOut(i)) continue;
    const Image<float> seen = relight(fit.maps, {}, lights[i]),
                       want = relight(truth, {}, lights[i]);
    score.psnr_worst_db =
        std::min(score.psnr_worst_db, psnrDb(meanSquareError(seen.view(), want.view())));
  }
  return score;
}

TEST(SpecimensFit, GivesBackTheTruthOfAllSevenAndPredictsLightsLeftOut) {
  std::printf(
      "specimen             diffuse normal  PSNR | 3 lights: share specular alpha | "
      "confident: share specular alpha\n");
  for (const char* name : {"banana_ripening", "copper_patination", "grass_growth", "paint_cracking",
                           "snow_accumulation", "steel_rusting", "wood_drying"}) {
    const Score s = scoreOf(name);
    std::printf(
        "%-20s %.4f  %.2f deg %.1f |           %.2f  %.4f   %.3f |            %.2f  %.4f   "
        "%.3f\n",
        name, s.diffuse_rms, s.normal_median_deg, s.psnr_worst_db, s.told_share,
        s.told_specular_rms, s.told_alpha_rms, s.sure_share, s.sure_specular_rms, s.sure_alpha_rms);
    // Tarnished copper's lobes are nearly as wide as the diffuse part, and their strength, 0.1, is
    // one that neither dielectrics nor metals have: it is held to the former's.
    const double wide = std::string(name) == "copper_patination" ? 2 : 1;
    EXPECT_LE(s.diffuse_rms, 0.010 * wide) << name;
    EXPECT_LE(s.normal_median_deg, 1) << name;
    EXPECT_GE(s.psnr_worst_db, 38) << name;
    EXPECT_LE(s.told_specular_rms, 0.020 * wide) << name;
  }
}

}  // namespace
}  // namespace patina::brdf
