// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/sensor/merge.h"

#include <gtest/gtest.h>

#include <cmath>

#include "calibration/sensor/radiance.h"
#include "tests/calibration/sensor/twin_shots.h"

namespace patina::calibration {
namespace {

using testing::TwinStudio;

NoiseModels twinNoise() {
  NoiseModels noise;
  noise.fill({.electrons_per_number = 30000.0 / 4031,
              .read_noise_e = 3,
              .full_well_e = 30000,
              .black_level = 64,
              .white_level = 4095});
  return noise;
}

// Exposures of one scene, owning what they lend.
struct Series {
  std::vector<Image<float>> light;
  std::vector<Image<std::uint8_t>> marks;
  std::vector<double> exposures_s;

  Series(TwinStudio& studio, std::vector<double> times) : exposures_s(std::move(times)) {
    for (const double t : exposures_s) {
      const RawMosaic raw =
          studio.maker.expose(TwinStudio::shot(1, 0, t, static_cast<std::uint64_t>(1e6 * t)));
      const SizePx size = raw.samples.size();
      light.emplace_back(size.width, size.height, 1);
      marks.emplace_back(size.width, size.height, 1);
      toRadiance(raw, prepareCorrection(size, 1, raw.cfa, {}, {}, {}), {1, 1, 1},
                 light.back().view(), marks.back().view());
    }
  }
  Merged merged() const {
    std::vector<Exposed> exposed;
    for (std::size_t i = 0; i < light.size(); ++i)
      exposed.push_back({light[i].view(), marks[i].view(), exposures_s[i]});
    return mergeExposures(exposed, {0, 1, 1, 2}, twinNoise());
  }
};

TEST(MergeExposures, ErrsAsMuchAsItSaysAndIsNotBiased) {
  TwinStudio studio("banana_ripening", "256x192");
  const Series series(studio, {0.0025, 0.01, 0.04, 0.16});
  const Merged merged = series.merged();
  // Truth: the mean of many frames of 2.5 ms, which saturates nowhere.
  std::vector<double> truth(256 * 192);
  constexpr int kMany = 400;
  for (int i = 0; i < kMany; ++i) {
    const RawMosaic raw =
        studio.maker.expose(TwinStudio::shot(1, 0, 0.0025, 10'000 + static_cast<std::uint64_t>(i)));
    for (std::size_t k = 0; k < truth.size(); ++k)
      truth[k] += (raw.samples.texels()[k] - 64.0) / 4031 / 0.0025 / kMany;
  }
  double ratio = 0, bias = 0, sum = 0, n = 0;
  for (std::size_t k = 0; k < truth.size(); ++k) {
    const double e = merged.light.texels()[k] - truth[k], s = merged.error.texels()[k];
    if (truth[k] > 40) continue;                                  // hot pixels
    const double of_truth = truth[k] / (0.0025 * 30000) / kMany;  // shot noise
    ratio += e * e / (s * s + of_truth);
    bias += e;
    sum += truth[k];
    n += 1;
  }
  EXPECT_NEAR(std::sqrt(ratio / n), 1, 0.1);
  EXPECT_LT(std::abs(bias / sum), 0.001);
  EXPECT_NEAR(merged.disagreement, 1, 0.1);
  EXPECT_LT(merged.saturated, 20);
}

TEST(MergeExposures, IsBetterThanAnyExposureAlone) {
  TwinStudio studio("banana_ripening", "64x48");
  const Series all(studio, {0.005, 0.02}), one(studio, {0.02});
  const Merged merged = all.merged(), alone = one.merged();
  for (std::size_t k = 0; k < merged.error.texels().size(); ++k)
    if (alone.marks.texels()[k] == 0) {
      EXPECT_LT(merged.error.texels()[k], 1.02f * alone.error.texels()[k]);
    }
}

TEST(MergeExposures, MarksWhatIsSaturatedInAllAndGivesItsLeastLight) {
  TwinStudio studio("grey_card", "64x48");
  const Merged merged = Series(studio, {0.5, 1}).merged();
  EXPECT_GT(merged.saturated, 1000);
  EXPECT_EQ(merged.marks.at(32, 24), kSaturated);
  EXPECT_TRUE(std::isinf(merged.error.at(32, 24)));
  EXPECT_NEAR(merged.light.at(32, 24), 2, 1e-5);  // white in half a second
}

TEST(MergeExposures, RefusesNothingUnequalSizesAndTimelessExposures) {
  const auto refused = [](const std::vector<Exposed>& exposures) {
    EXPECT_THROW((void)mergeExposures(exposures, {0, 1, 1, 2}, twinNoise()), CalibrationError);
  };
  const Image<float> light(4, 4, 1), other(4, 5, 1);
  const Image<std::uint8_t> marks(4, 4, 1), other_marks(4, 5, 1);
  refused({});
  refused({{light.view(), marks.view(), 0}});
  refused({{light.view(), marks.view(), 1}, {other.view(), other_marks.view(), 1}});
}

}  // namespace
}  // namespace patina::calibration
