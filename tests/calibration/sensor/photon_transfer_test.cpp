// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/sensor/photon_transfer.h"

#include <gmock/gmock.h>

#include <cmath>
#include <cstdio>

#include "processing/image/random.h"
#include "tests/calibration/sensor/twin_shots.h"

namespace patina::calibration {
namespace {

using testing::TwinStudio;

struct Level {
  double lamp = 1, exposure_s = 0.02;
};

// A grey card under each level, every picture with noise of its own and a lamp that is not quite
// the same for both of a pair.
PairSource flatsOf(TwinStudio& studio, std::vector<Level> levels, double change = 0.001) {
  return [&studio, levels = std::move(levels), change,
          next = std::size_t{0}]() mutable -> std::optional<RawPair> {
    if (next == levels.size()) return std::nullopt;
    const Level& level = levels[next++];
    return RawPair{studio.maker.expose(TwinStudio::shot(level.lamp, 0, level.exposure_s, 2 * next)),
                   studio.maker.expose(TwinStudio::shot(level.lamp * (1 + change), 0,
                                                        level.exposure_s, 2 * next + 1))};
  };
}
PairSource darksOf(TwinStudio& studio, int pairs, double exposure_s = 0.02) {
  return [&studio, pairs, exposure_s, next = 0]() mutable -> std::optional<RawPair> {
    if (next == pairs) return std::nullopt;
    ++next;
    return RawPair{studio.maker.expose(TwinStudio::shot(0, 0, exposure_s, 1000 + 2ull * next)),
                   studio.maker.expose(TwinStudio::shot(0, 0, exposure_s, 1001 + 2ull * next))};
  };
}
PhotonTransfer measured(const PairSource& darks, const PairSource& flats) {
  Progress progress;
  return measurePhotonTransfer(darks, flats, {}, progress);
}
std::string refusal(const PairSource& darks, const PairSource& flats) {
  try {
    measured(darks, flats);
  } catch (const CalibrationError& error) {
    EXPECT_EQ(error.exit(), Exit::kBadData);
    return error.what();
  }
  return "not refused";
}

const std::vector<Level> kLevels{{0.1}, {0.25}, {0.5}, {0.8}, {1.2}, {1.6}, {2.6}};

TEST(PhotonTransfer, FindsGainReadNoiseAndFullWellOfTheReferenceProfile) {
  TwinStudio studio("grey_card", "512x384");
  const PhotonTransfer transfer = measured(darksOf(studio, 4), flatsOf(studio, kLevels));
  const auto& truth = devices::twin::referenceProfile().sensor;
  for (int c = 0; c < 3; ++c) {
    const NoiseModel& noise = transfer.noise[c];
    std::printf(
        "channel %d: gain %.4f e-/DN (truth %.4f), read noise %.3f e- (%.1f), full well "
        "%.0f e- (%.0f), residual %.2f %%, gain's standard error %.2f %%\n",
        c, noise.electrons_per_number, truth.electronsPerStep(), noise.read_noise_e,
        truth.read_noise, noise.full_well_e, truth.full_well, 100 * transfer.channels[c].residual,
        100 * transfer.channels[c].gain_error);
    EXPECT_NEAR(noise.electrons_per_number / truth.electronsPerStep(), 1, 0.02);
    EXPECT_NEAR(noise.read_noise_e / truth.read_noise, 1, 0.05);
    EXPECT_NEAR(noise.full_well_e / truth.full_well, 1, 0.02);
    EXPECT_TRUE(transfer.channels[c].well_filled);
    EXPECT_LT(transfer.channels[c].residual, 0.03);
    EXPECT_EQ(transfer.channels[c].levels.size(), 6u);  // the brightest is cut
  }
  EXPECT_GT(transfer.hot_left_out, 0);
}

// Numbers of a sensor of 2 e- a number whose pixels differ by 6 numbers in the dark, always the
// same, and by 3 from picture to picture.
RawMosaic patterned(double electrons, std::uint64_t picture) {
  constexpr double kElectronsPerNumber = 2, kPattern = 6, kRead = 3;
  RawMosaic raw;
  raw.samples = Image<std::uint16_t>(192, 192, 1);
  raw.black_level = 64, raw.white_level = 4095;
  for (std::uint64_t i = 0; i < raw.samples.texels().size(); ++i) {
    const double shot = std::sqrt(electrons) / kElectronsPerNumber;
    const double noise = std::hypot(kRead, shot) * gaussian(hashSeed(picture, i));
    raw.samples.texels()[i] = static_cast<std::uint16_t>(
        std::clamp(std::round(200 + electrons / kElectronsPerNumber +
                              kPattern * gaussian(hashSeed(7, i)) + noise),
                   0.0, 4095.0));
  }
  return raw;
}
PairSource patternedPairs(std::vector<double> electrons, std::uint64_t first) {
  return [electrons = std::move(electrons), first,
          next = std::size_t{0}]() mutable -> std::optional<RawPair> {
    if (next == electrons.size()) return std::nullopt;
    const double of = electrons[next++];
    return RawPair{patterned(of, first + 2 * next), patterned(of, first + 2 * next + 1)};
  };
}

TEST(PhotonTransfer, ReadNoiseIsWhatDiffersBetweenTwoDarksNotTheirPattern) {
  const PhotonTransfer transfer =
      measured(patternedPairs({0, 0, 0}, 100), patternedPairs({400, 1000, 2000, 4000, 6000}, 200));
  for (const NoiseModel& noise : transfer.noise) {
    EXPECT_NEAR(noise.electrons_per_number, 2, 0.04);
    EXPECT_NEAR(noise.read_noise_e, 6, 0.15);
  }
}

TEST(PhotonTransfer, LinearityTakesExposuresThatDiffer) {
  TwinStudio studio("grey_card", "128x128");
  const PhotonTransfer one_exposure = measured(darksOf(studio, 1), flatsOf(studio, kLevels));
  EXPECT_FALSE(one_exposure.channels[1].nonlinearity);
  const PhotonTransfer many = measured(
      darksOf(studio, 1), flatsOf(studio, {{0.5, 0.01}, {0.5, 0.02}, {0.5, 0.04}, {0.5, 0.06}}, 0));
  ASSERT_TRUE(many.channels[1].nonlinearity);
  EXPECT_LT(*many.channels[1].nonlinearity, 0.005);
}

TEST(PhotonTransfer, VarianceIsThatOfShotReadAndRounding) {
  const NoiseModel noise{.electrons_per_number = 2, .read_noise_e = 4};
  EXPECT_DOUBLE_EQ(noise.variance(0), 4 + 1.0 / 12);
  EXPECT_DOUBLE_EQ(noise.variance(100), 54 + 1.0 / 12);
  EXPECT_DOUBLE_EQ(noise.variance(-5), noise.variance(0));
}

TEST(PhotonTransfer, WhatGivesNoGainIsRefusedWithWhatToShoot) {
  TwinStudio studio("grey_card", "64x64");
  EXPECT_THAT(refusal(darksOf(studio, 0), flatsOf(studio, kLevels)),
              ::testing::HasSubstr("shoot two with the lens closed"));
  EXPECT_THAT(refusal(darksOf(studio, 1), flatsOf(studio, {})),
              ::testing::HasSubstr("no pair of flats"));
  EXPECT_THAT(refusal(darksOf(studio, 1), flatsOf(studio, {{9.0}})),
              ::testing::HasSubstr("all are saturated"));
  EXPECT_THAT(refusal(darksOf(studio, 1), flatsOf(studio, {{1.0}}, 0.2)),
              ::testing::HasSubstr("without touching lamp"));
  TwinStudio other("grey_card", "64x48");
  EXPECT_THAT(refusal(darksOf(studio, 1), flatsOf(other, kLevels)),
              ::testing::HasSubstr("differ in size"));
}

TEST(PhotonTransfer, OptionsOutOfRangeAreNamed) {
  EXPECT_THROW(PhotonTransferOptions{.tile_px = 31}.check(), CalibrationError);
  EXPECT_THROW(PhotonTransferOptions{.unequal_max = 0}.check(), CalibrationError);
}

}  // namespace
}  // namespace patina::calibration
