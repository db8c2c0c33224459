// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/synthesis/texture_optimization/enlarge.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "processing/stbrdf/stbrdf_file.h"
#include "tests/processing/synthesis/texture_optimization/samples.h"
#include "tests/processing/synthesis/texture_optimization/stops_at.h"
#include "tests/support/temp_folder.h"

namespace patina::texture_optimization {
namespace {

EnlargeOptions shortly(SizePx size) {
  EnlargeOptions options;
  options.optimize.size = size;
  options.optimize.rounds = 3;
  return options;
}

TEST(Enlarge, MakesEveryMapLargerAndKeepsMapsTogether) {
  stbrdf::StbrdfSet set = blobs(40);
  set.maps.push_back(set.maps[2]);
  set.maps.back().name = "Height";
  Progress progress;
  const Enlarged larger = enlarge(set, shortly({80, 64}), {}, progress);
  ASSERT_EQ(larger.set.maps.size(), 4u);
  EXPECT_EQ(larger.set.size(), (SizePx{80, 64}));
  for (std::size_t k = 0; k < 2; ++k)
    EXPECT_EQ(larger.set.find("Height")->coefficients[k].texels(),
              larger.set.find("Roughness")->coefficients[k].texels());
  const auto& texels = larger.set.maps[0].coefficients[0].texels();
  EXPECT_GE(*std::min_element(texels.begin(), texels.end()), -0.1);
  EXPECT_LE(*std::max_element(texels.begin(), texels.end()), 1.1);
}

TEST(Enlarge, SeesWhatHappensLaterToo) {
  // At t = 0 the halves are alike; later one goes dark. A distance at t = 0 alone would mix them.
  stbrdf::StbrdfSet set = blobs(40);
  for (stbrdf::TimeMap& map : set.maps) {
    map.coefficients[0] = Image<float>(40, 40, map.coefficients[0].channels(), 0.6f);
    map.coefficients[1] = Image<float>(40, 40, map.coefficients[0].channels(), 0.0f);
    for (int y = 0; y < 40; ++y)
      for (int x = 20; x < 40; ++x)
        for (int c = 0; c < map.coefficients[1].channels(); ++c)
          map.coefficients[1].at(x, y, c) = -0.5f;
  }
  Progress progress;
  const Enlarged larger = enlarge(set, shortly({80, 80}), {}, progress);
  const Image<float> late = evaluate(larger.set.maps[0], larger.set.basis, 1, stbrdf::Clamp::kNone);
  int between = 0, dark = 0;
  for (const float v : late.texels()) {
    between += v > 0.2f && v < 0.5f;
    dark += v < 0.2f;
  }
  const auto all = static_cast<double>(late.texels().size());
  EXPECT_LT(between / all, 0.15);
  EXPECT_NEAR(dark / all, 0.5, 0.2);
}

TEST(Enlarge, RefusesWeightsThatLeaveNothing) {
  Progress progress;
  EnlargeOptions options = shortly({80, 80});
  options.diffuse = options.specular = 0;
  EXPECT_THROW(enlarge(blobs(40), options, {}, progress), ProcessingError);
  options.roughness = -1;
  EXPECT_THROW(enlarge(blobs(40), options, {}, progress), ProcessingError);
}

TEST(Enlarge, LeavesNothingWhereverItIsStopped) {
  const testing::TempFolder temp;
  const stbrdf::StbrdfSet set = blobs(40);
  const int stopped = stoppedEverywhere(temp.path(), [&](Progress& progress) {
    stbrdf::writeStbrdfSet(temp / "out", enlarge(set, shortly({60, 60}), {}, progress).set,
                           progress);
  });
  EXPECT_GT(stopped, 8);
  EXPECT_TRUE(std::filesystem::exists(temp / "out" / "Diffuse-0.exr"));
}

TEST(EnlargeBytes, GrowWithTheResult) {
  const stbrdf::StbrdfSet set = blobs(40);
  EXPECT_GT(enlargeBytes(set, {32768, 32768}), std::int64_t{24} << 30);
  EXPECT_LT(enlargeBytes(set, {80, 80}), 20'000'000);
}

}  // namespace
}  // namespace patina::texture_optimization
