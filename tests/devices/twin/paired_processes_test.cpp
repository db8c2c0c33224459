// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/paired_processes.h"

#include <gtest/gtest.h>

namespace patina::devices::twin {
namespace {

constexpr SizePx kSize{48, 40};
constexpr const char *kUnder = "copper_patination", *kOver = "banana_ripening";

std::unique_ptr<Specimen> pair() {
  return pairProcesses(makeSpecimen(kUnder, 2), makeSpecimen(kOver, 5));
}

TEST(PairedProcesses, AreTheFirstOneAloneWhileTheSecondHasNotBegun) {
  const SurfaceMaps both = pair()->surfaceAt(0, kSize),
                    under = makeSpecimen(kUnder, 2)->surfaceAt(0, kSize);
  EXPECT_EQ(both.diffuse.texels(), under.diffuse.texels());
  EXPECT_EQ(both.height.texels(), under.height.texels());
}

TEST(PairedProcesses, MixAsFarAsTheSecondHasCome) {
  const SurfaceMaps both = pair()->surfaceAt(0.6, kSize),
                    under = makeSpecimen(kUnder, 2)->surfaceAt(0.6, kSize);
  const SampleGrid grid = SampleGrid::regular(kSize, makeSpecimen(kUnder, 2)->info().width_mm);
  const SurfaceMaps over = mapsAt(*makeSpecimen(kOver, 5)->prepare(grid), 0.6, kSize);
  for (int y = 0; y < kSize.height; ++y)
    for (int x = 0; x < kSize.width; ++x) {
      const float w = over.degree.at(x, y);
      EXPECT_NEAR(both.diffuse.at(x, y, 1),
                  (1 - w) * under.diffuse.at(x, y, 1) + w * over.diffuse.at(x, y, 1), 1e-5);
      EXPECT_NEAR(both.degree.at(x, y), 1 - (1 - under.degree.at(x, y)) * (1 - w), 1e-5);
      float length2 = 0;
      for (int c = 0; c < 3; ++c) length2 += both.normal.at(x, y, c) * both.normal.at(x, y, c);
      EXPECT_NEAR(length2, 1, 1e-4);
    }
}

TEST(PairedProcesses, AreMadeByName) {
  const auto specimen = makeSpecimen("copper_patination+banana_ripening", 1);
  EXPECT_EQ(specimen->info().name, "copper_patination+banana_ripening");
  EXPECT_EQ(specimen->info().duration, makeSpecimen(kUnder, 1)->info().duration);
  EXPECT_THROW(makeSpecimen("copper_patination+teapot", 1), ProcessingError);
}

}  // namespace
}  // namespace patina::devices::twin
