// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/specimen.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>

#include "processing/brdf/abc.h"
#include "processing/brdf/ggx.h"

namespace patina::devices::twin {
namespace {

class EverySpecimen : public testing::TestWithParam<std::string> {
 protected:
  std::unique_ptr<Specimen> make(std::uint64_t seed = 3) const {
    return makeSpecimen(GetParam(), seed);
  }
};
std::vector<std::string> allNames() {
  std::vector<std::string> names;
  for (const SpecimenInfo& info : listSpecimens()) names.push_back(info.name);
  return names;
}
INSTANTIATE_TEST_SUITE_P(All, EverySpecimen, testing::ValuesIn(allNames()),
                         [](const auto& specimen) { return specimen.param; });

TEST_P(EverySpecimen, StaysWithinTheRangesOfItsMaps) {
  const auto specimen = make();
  for (const double time : {0.0, 0.1, 0.35, 0.6, 0.85, 1.0}) {
    const SurfaceMaps maps = specimen->surfaceAt(time, {96, 80});
    for (int y = 0; y < 80; ++y)
      for (int x = 0; x < 96; ++x) {
        for (int c = 0; c < 3; ++c) {
          ASSERT_GE(maps.diffuse.at(x, y, c), 0);
          ASSERT_GE(maps.specular.at(x, y, c), 0);
          ASSERT_LE(maps.diffuse.at(x, y, c) + maps.specular.at(x, y, c), 1) << "energy";
        }
        ASSERT_GT(maps.roughness.at(x, y), 0);
        ASSERT_LE(maps.roughness.at(x, y), 1);
        ASSERT_GE(maps.degree.at(x, y), 0);
        ASSERT_LE(maps.degree.at(x, y), 1);
        const float nx = maps.normal.at(x, y, 0), ny = maps.normal.at(x, y, 1),
                    nz = maps.normal.at(x, y, 2);
        ASSERT_NEAR(nx * nx + ny * ny + nz * nz, 1, 1e-4);
        ASSERT_GT(nz, 0);
        ASSERT_TRUE(std::isfinite(maps.height.at(x, y)));
      }
  }
}

TEST_P(EverySpecimen, DegreeRunsFromZeroToOneAndNeverFalls) {
  const auto specimen = make();
  const auto most = [](const Image<float>& degree) {
    return *std::max_element(degree.texels().begin(), degree.texels().end());
  };
  Image<float> before = specimen->surfaceAt(0, {80, 64}).degree;
  EXPECT_EQ(most(before), 0);
  for (int i = 1; i <= 60; ++i) {
    Image<float> now = specimen->surfaceAt(i / 60.0, {80, 64}).degree;
    for (std::size_t k = 0; k < now.texels().size(); ++k)
      ASSERT_GE(now.texels()[k], before.texels()[k] - 1e-6f) << "time " << i / 60.0;
    before = std::move(now);
  }
  if (GetParam() != "grey_card") {  // which does not age
    EXPECT_GT(most(before), 0.99f);
  }
}

TEST_P(EverySpecimen, IsTheSameForOneThreadAndForMore) {
  const auto one = make(), two = make();
  SurfaceMaps serial;
  {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
    serial = one->surfaceAt(0.61, {256, 256});
  }
  const SurfaceMaps parallel = two->surfaceAt(0.61, {256, 256});
  EXPECT_EQ(serial.diffuse.texels(), parallel.diffuse.texels());
  EXPECT_EQ(serial.normal.texels(), parallel.normal.texels());
  EXPECT_EQ(serial.degree.texels(), parallel.degree.texels());
}

TEST_P(EverySpecimen, NeedsNoTimeBeforeTheOneAskedFor) {
  const auto fresh = make(), used = make();
  used->surfaceAt(0.1, {64, 64});
  used->surfaceAt(0.9, {32, 32});
  EXPECT_EQ(used->surfaceAt(0.5, {64, 64}).diffuse.texels(),
            fresh->surfaceAt(0.5, {64, 64}).diffuse.texels());
}

// Box-filters by a whole factor.
Image<float> shrunk(const Image<float>& image, int factor) {
  Image<float> out(image.width() / factor, image.height() / factor, image.channels());
  for (int y = 0; y < out.height() * factor; ++y)
    for (int x = 0; x < out.width() * factor; ++x)
      for (int c = 0; c < image.channels(); ++c)
        out.at(x / factor, y / factor, c) += image.at(x, y, c) / (factor * factor);
  return out;
}

TEST_P(EverySpecimen, HasTheSameTruthAtAnySize) {
  const auto specimen = make();
  const std::array times{0.05, 0.5, 0.95};
  std::vector<Image<float>> fine, coarse;  // each size is prepared once
  for (const double time : times)
    fine.push_back(shrunk(specimen->surfaceAt(time, {512, 512}).diffuse, 4));
  for (const double time : times) coarse.push_back(specimen->surfaceAt(time, {128, 128}).diffuse);
  for (std::size_t i = 0; i < times.size(); ++i) {
    double difference = 0, fine_sum = 0, coarse_sum = 0;
    for (std::size_t k = 0; k < fine[i].texels().size(); ++k) {
      difference += std::abs(fine[i].texels()[k] - coarse[i].texels()[k]);
      fine_sum += fine[i].texels()[k];
      coarse_sum += coarse[i].texels()[k];
    }
    EXPECT_LT(difference / fine_sum, 0.08) << "time " << times[i] << ", texel by texel";
    EXPECT_NEAR(coarse_sum / fine_sum, 1, 0.02) << "time " << times[i] << ", as a whole";
  }
}

// Seen from within 60 degrees of the normal: beyond, Lambert's diffuse part does not know what
// gloss has taken.
TEST_P(EverySpecimen, NeverReflectsMoreThanItReceives) {
  const auto specimen = make();
  const MeasuredReflectance* measured = specimen->measured();
  for (const double time : {0.1, 0.5, 1.0}) {
    const SurfaceMaps maps = specimen->surfaceAt(time, {24, 24});
    for (const int k : {3, 150, 290, 431}) {
      const int x = k % 24, y = k / 24;
      for (const float n_v : {1.0f, 0.5f})
        for (int c = 0; c < 3; ++c) {
          const double degree = maps.degree.at(x, y);
          const double gloss =
              measured ? (1 - degree) * brdf::abcDirectionalAlbedo(measured->fresh, c, n_v, 48) +
                             degree * brdf::abcDirectionalAlbedo(measured->aged, c, n_v, 48)
                       : brdf::ggxDirectionalAlbedo(n_v, maps.specular.at(x, y, c),
                                                    maps.roughness.at(x, y), 48);
          EXPECT_LE(maps.diffuse.at(x, y, c) + gloss, 1.0)
              << "time " << time << " texel " << x << "," << y << " n.v " << n_v;
        }
    }
  }
}

// Where one thing ends before another there is a cliff that no normal tells of: texels are counted,
// not averaged.
TEST_P(EverySpecimen, ItsNormalsFollowItsHeights) {
  constexpr float kSteepEnough = 0.05f;  // to have a side
  const auto specimen = make();
  const int side = 384;
  const auto texel_mm = static_cast<float>(specimen->info().width_mm / side);
  for (const double time : {0.3, 0.8}) {
    const SurfaceMaps maps = specimen->surfaceAt(time, {side, side});
    int steep = 0, alike = 0, same_side = 0;
    for (int y = 1; y + 1 < side; ++y)
      for (int x = 1; x + 1 < side; ++x) {
        const auto& h = maps.height;
        const float slopes[2] = {(h.at(x + 1, y) - h.at(x - 1, y)) / (2 * texel_mm),
                                 (h.at(x, y - 1) - h.at(x, y + 1)) / (2 * texel_mm)};
        for (int c = 0; c < 2; ++c) {
          const float told = -maps.normal.at(x, y, c) / maps.normal.at(x, y, 2);
          if (std::min(std::abs(slopes[c]), std::abs(told)) < kSteepEnough) continue;
          ++steep;
          same_side += slopes[c] * told > 0;
          alike += slopes[c] * told > 0 && std::abs(std::log2(slopes[c] / told)) < 1;
        }
      }
    if (steep < side) continue;  // flat
    EXPECT_GT(same_side, 0.6 * steep) << time;
    EXPECT_GT(alike, 0.4 * steep) << time;
  }
}

TEST(Specimens, AreListedWithNameDurationAndSize) {
  const auto infos = listSpecimens();
  ASSERT_GE(infos.size(), 3u);
  for (const SpecimenInfo& info : infos) {
    EXPECT_EQ(makeSpecimen(info.name, 1)->info().name, info.name);
    EXPECT_GT(info.duration.count(), 0);
    EXPECT_GT(info.width_mm, 0);
    EXPECT_FALSE(info.description.empty());
  }
}

TEST(Specimens, AnUnknownNameIsAUsageErrorThatListsTheOthers) {
  try {
    makeSpecimen("moon_cheese", 1);
    FAIL();
  } catch (const ProcessingError& e) {
    EXPECT_EQ(e.exit(), Exit::kUsage);
    EXPECT_NE(std::string(e.what()).find("banana_ripening"), std::string::npos);
  }
}

TEST(SampleGrid, RegularTexelsAreSquareAndCentred) {
  const SampleGrid grid = SampleGrid::regular({4, 2}, 8);
  EXPECT_FLOAT_EQ(grid.texel_mm, 2);
  EXPECT_FLOAT_EQ(grid.x_mm[0], -3);
  EXPECT_FLOAT_EQ(grid.y_mm[0], 1) << "y points up";
  EXPECT_FLOAT_EQ(grid.x_mm[grid.index(3, 1)], 3);
}

}  // namespace
}  // namespace patina::devices::twin
