// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/registration/registration.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>
#include <utility>

#include "calibration/failure.h"
#include "processing/image/picture_file.h"
#include "processing/image/random.h"
#include "processing/image/warp.h"
#include "tests/calibration/registration/twin_pictures.h"
#include "tests/support/places.h"

namespace patina::calibration {
namespace {

constexpr Motion kGraf{7.6285898e-01, -2.9922929e-01, 2.2567123e+02,
                       3.3443473e-01, 1.0143901e+00,  -7.6999973e+01,
                       3.4663091e-04, -1.4364524e-05, 1.0};

// Mean distance between where two motions put the pixels of the reference that the frame shows.
double meanApart(const Motion& a, const Motion& truth, SizePx reference, SizePx frame) {
  double sum = 0;
  int count = 0;
  for (int y = 0; y < reference.height; y += 4)
    for (int x = 0; x < reference.width; x += 4) {
      const PlacePx at{static_cast<double>(x), static_cast<double>(y)};
      const PlacePx p = moved(a, at), q = moved(truth, at);
      if (q.x < 0 || q.y < 0 || q.x > frame.width - 1 || q.y > frame.height - 1) continue;
      sum += std::hypot(p.x - q.x, p.y - q.y);
      ++count;
    }
  return sum / count;
}

AlignOptions optionsOf(MotionModel model) {
  AlignOptions options;
  options.model = model;
  return options;
}

TEST(Registration, FindsTheHomographyOfTwoViewsOfAWallToAPixel) {
  PATINA_TEST_DATA_OR_SKIP(folder, "chessboards");
  const Image<float> one = readPicture(folder / "graf1.png").linear,
                     three = readPicture(folder / "graf3.png").linear;
  Progress progress;
  const Alignment found = align(three.view(), preparePicture(one.view()),
                                optionsOf(MotionModel::kHomography), progress);
  EXPECT_EQ(found.start, Start::kFeatures);
  const double apart = meanApart(found.frame_from_reference, kGraf, one.size(), three.size());
  RecordProperty("mean_px", std::to_string(apart));
  std::printf("graf1/3: mean distance from the given homography %.3f px, zncc %.3f, share %.2f\n",
              apart, found.agreement.zncc, found.agreement.share);
  EXPECT_LE(apart, 1.0);
}

// Gain 0.55, a gradient of 2.5 over the width, and a shadow with a sharp edge that keeps 35 %.
Image<float> underOtherLight(Image<float> picture) {
  for (int y = 0; y < picture.height(); ++y)
    for (int x = 0; x < picture.width(); ++x) {
      const float across = static_cast<float>(x) / picture.width();
      const bool shaded = x + 0.6 * y > 0.75 * picture.width() && x < 0.9 * picture.width();
      for (float& value : picture.view().texel(x, y))
        value *= 0.55f * (0.4f + 0.6f * across) * (shaded ? 0.35f : 1.0f);
    }
  return picture;
}

TEST(Registration, IsNotPulledByGainGradientAndShadow) {
  PATINA_TEST_DATA_OR_SKIP(folder, "chessboards");
  const Image<float> graf = readPicture(folder / "graf1.png").linear;
  const PreparedPicture reference = preparePicture(graf.view());
  const Motion turn{
      std::cos(0.01), -std::sin(0.01), 6.3, std::sin(0.01), std::cos(0.01), -2.4, 0, 0, 1};
  const struct {
    MotionModel model;
    Motion truth;
  } cases[] = {
      {MotionModel::kTranslation, shift(3.37, -5.71)},
      {MotionModel::kEuclidean, turn},
      {MotionModel::kAffine, {1.012, 0.004, -3.3, -0.006, 0.991, 4.1, 0, 0, 1}},
      {MotionModel::kHomography, {1.012, 0.004, -3.3, -0.006, 0.991, 4.1, 1e-5, -2e-5, 1}}};
  Progress progress;
  for (const auto& one : cases) {
    const Image<float> frame =
        underOtherLight(warpBilinear(graf.view(), inverse(one.truth), graf.size()));
    const Alignment found = align(frame.view(), reference, optionsOf(one.model), progress);
    const double apart = meanApart(found.frame_from_reference, one.truth, graf.size(), graf.size());
    std::printf("graf1 in other light, %s: %.4f px, verdict %s, start %d\n", name(one.model), apart,
                name(found.verdict), static_cast<int>(found.start));
    EXPECT_LE(apart, 0.2) << name(one.model);
    EXPECT_TRUE(isTrusted(found.verdict)) << name(found.verdict);
  }
}

struct ShiftErrors {
  double own_px = 0, expected_px = 0, by_card_px = 0;  // RMS of sqrt(x^2 + y^2)
  double noiseless_px = 0;                             // off by what the mosaic samples alone
  double bound_px = 0;                                 // of what noise allows
};

double squaredApart(const Motion& m, PlacePx by) {
  return (m[2] - by.x) * (m[2] - by.x) + (m[5] - by.y) * (m[5] - by.y);
}

struct Trials {
  int shifts = 2;  // random, within 4 px
  int noises = 1;  // pairs of pictures of each
  int frames = 1;  // of which each picture is the mean
};

// Found from the specimen itself and from a card beside it.
ShiftErrors shiftErrorsOf(const ShiftedSpecimen& twin, double time, const Trials& trials) {
  Progress progress;
  AlignOptions options;
  options.search = false;
  const std::vector<float> still = twin.lightAt(time, {});
  const Image<std::uint8_t> mask = twin.cardMask();
  const int pairs = trials.shifts * trials.noises;
  ShiftErrors sum;
  const auto add = [&](const std::vector<float>& light, PlacePx by, std::uint64_t key) {
    const std::uint64_t before = 1000 + key, after = 2 + key;  // noise of its own
    const Image<float> first = twin.developed(still, before, trials.frames),
                       card = twin.developed(twin.withCard(still, {}), before);
    const Alignment own = align(twin.developed(light, after, trials.frames).view(),
                                preparePicture(first.view()), options, progress);
    const Alignment by_card = align(twin.developed(twin.withCard(light, by), after).view(),
                                    preparePicture(card.view(), mask.view()), options, progress);
    sum.own_px += squaredApart(own.frame_from_reference, by) / pairs;
    sum.by_card_px += squaredApart(by_card.frame_from_reference, by) / pairs;
    sum.expected_px += own.agreement.uncertainty_px * own.agreement.uncertainty_px / pairs;
  };
  const PreparedPicture noiseless = preparePicture(twin.withoutNoise(still).view());
  for (int k = 0; k < trials.shifts; ++k) {
    const auto key = static_cast<std::uint64_t>(k);
    const PlacePx by{8 * uniform(hashSeed(3, key)) - 4, 8 * uniform(hashSeed(4, key)) - 4};
    const std::vector<float> light = twin.lightAt(time, by);
    for (int noise = 0; noise < trials.noises; ++noise)
      add(light, by, key + static_cast<std::uint64_t>(100 * noise));
    const Alignment found = align(twin.withoutNoise(light).view(), noiseless, options, progress);
    sum.noiseless_px += squaredApart(found.frame_from_reference, by) / trials.shifts;
  }
  return {std::sqrt(sum.own_px), std::sqrt(sum.expected_px), std::sqrt(sum.by_card_px),
          std::sqrt(sum.noiseless_px), twin.boundPx(still) / std::sqrt(trials.frames)};
}

int fromEnvironment(const char* name, int otherwise) {
  const char* text = std::getenv(name);
  return text ? std::atoi(text) : otherwise;
}

// A twentieth of a pixel, or what noise allows: of n shifts the RMS is known to 1 / sqrt(4 n) of
// itself, twice that is granted.
double limitPx(const ShiftErrors& found, int pairs) {
  const double by_chance = 1.15 * (1 + 1 / std::sqrt(static_cast<double>(pairs)));
  return std::max(0.05, by_chance * found.bound_px);
}

// PATINA_SHIFTS of each specimen and age, or of PATINA_SHIFTS_OF alone, in pictures of
// PATINA_SHIFT_SIDE pixels, each of PATINA_SHIFT_POINTS points across, print the whole table.
TEST(Registration, FindsRandomShiftsToATwentiethOfAPixelWhereverTheSurfaceShowsEnough) {
  const int shifts = fromEnvironment("PATINA_SHIFTS", 2),
            side = fromEnvironment("PATINA_SHIFT_SIDE", 256);
  const bool whole = std::getenv("PATINA_SHIFTS") != nullptr;
  for (const char* specimen :
       {"banana_ripening", "copper_patination", "grass_growth", "paint_cracking",
        "snow_accumulation", "steel_rusting", "wood_drying"}) {
    if (const char* only = std::getenv("PATINA_SHIFTS_OF"); only && specimen != std::string(only))
      continue;
    for (const double time : {0.1, 0.5, 0.9}) {
      if (!whole && time != 0.1) continue;
      // Specks of fresh steel have rims of half a pixel.
      const bool rims = specimen == std::string("steel_rusting") && time < 0.2 && side < 1000;
      const ShiftedSpecimen twin(specimen, {side, side},
                                 fromEnvironment("PATINA_SHIFT_POINTS", rims ? 4 : 2));
      const ShiftErrors found = shiftErrorsOf(twin, time, {.shifts = shifts});
      std::printf(
          "%-18s %.1f  bound %.4f px, expected %.3f px, found %.3f px RMS, without noise %.3f px; "
          "by a card %.3f px\n",
          specimen, time, found.bound_px, found.expected_px, found.own_px, found.noiseless_px,
          found.by_card_px);
      std::fflush(stdout);
      EXPECT_LE(found.own_px, limitPx(found, shifts)) << specimen << ' ' << time;
      if (shifts >= 8 && side < 1000 && found.own_px > 0.05) {
        EXPECT_LE(found.expected_px, 1.5 * found.own_px) << specimen << ' ' << time;
        EXPECT_GE(found.expected_px, found.own_px / 1.5) << specimen << ' ' << time;
      }
      EXPECT_LE(found.by_card_px, 0.05) << specimen << ' ' << time;
    }
  }
}

// Cracks and pits of a pixel: each frame samples something else of them.
TEST(Registration, IsNotPulledByDetailFinerThanAPixel) {
  for (const auto& [specimen, most_px] :
       {std::pair("paint_cracking", 0.02), {"steel_rusting", 0.02}}) {
    const ShiftErrors found =
        shiftErrorsOf(ShiftedSpecimen(specimen, {256, 256}), 0.5, {.shifts = 4});
    std::printf("%s half way: found %.3f px RMS, without noise %.3f px\n", specimen, found.own_px,
                found.noiseless_px);
    EXPECT_LE(found.own_px, most_px) << specimen;
  }
}

// Block by block at the finest level 0.115 px are found.
TEST(Registration, ComesNearWhatNoiseAllowsOnFreshCopper) {
  constexpr Trials kOne{.shifts = 6, .noises = 4};
  const ShiftedSpecimen twin("copper_patination", {256, 256});
  const ShiftErrors found = shiftErrorsOf(twin, 0.1, kOne);
  std::printf("fresh copper: bound %.4f px, expected %.3f px, found %.3f px RMS\n", found.bound_px,
              found.expected_px, found.own_px);
  EXPECT_LE(found.own_px, limitPx(found, kOne.shifts * kOne.noises));
  EXPECT_LE(found.expected_px, 1.5 * found.own_px);
  EXPECT_GE(found.expected_px, found.own_px / 1.5);
}

TEST(Registration, FindsFreshCopperToATwentiethOfAPixelInTheMeanOfFourFrames) {
  const ShiftErrors found = shiftErrorsOf(ShiftedSpecimen("copper_patination", {256, 256}), 0.1,
                                          {.shifts = 3, .noises = 4, .frames = 4});
  std::printf(
      "fresh copper, means of 4 frames: bound %.4f px, expected %.3f px, found %.3f px RMS\n",
      found.bound_px, found.expected_px, found.own_px);
  EXPECT_LE(found.own_px, 0.05);
}

TEST(Registration, FindsAShiftOfAThirdOfThePictureByItself) {
  const ShiftedSpecimen twin("steel_rusting", {256, 256});
  Progress progress;
  const Alignment found = align(twin.at(0.5, {85.3, -60.7}, 2).view(),
                                preparePicture(twin.at(0.5, {}, 1).view()), {}, progress);
  EXPECT_NE(found.start, Start::kGiven);
  EXPECT_NEAR(found.frame_from_reference[2], 85.3, 0.1);
  EXPECT_NEAR(found.frame_from_reference[5], -60.7, 0.1);
}

TEST(Registration, GivesTheSameAnswerForOneThreadAndForMore) {
  const ShiftedSpecimen twin("steel_rusting", {256, 256});
  const Image<float> frame = twin.at(0.5, {40.3, 2.6}, 2), still = twin.at(0.5, {}, 1);
  Progress progress;
  for (const MotionModel model : {MotionModel::kTranslation, MotionModel::kAffine}) {
    const Alignment many =
        align(frame.view(), preparePicture(still.view()), optionsOf(model), progress);
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    const Alignment single =
        align(frame.view(), preparePicture(still.view()), optionsOf(model), progress);
    EXPECT_EQ(many.frame_from_reference, single.frame_from_reference) << name(model);
    EXPECT_EQ(many.agreement.zncc, single.agreement.zncc) << name(model);
  }
}

TEST(Registration, SaysWhenAFrameShowsSomethingElse) {
  const ShiftedSpecimen rust("steel_rusting", {128, 128}), wood("wood_drying", {128, 128});
  Progress progress;
  const Alignment found =
      align(wood.at(0.5, {}, 2).view(), preparePicture(rust.at(0.5, {}, 1).view()), {}, progress);
  EXPECT_EQ(found.verdict, Verdict::kLost);
  EXPECT_EQ(align(Image<float>(128, 128, 3).view(), preparePicture(rust.at(0.5, {}, 1).view()), {},
                  progress)
                .verdict,
            Verdict::kLost)
      << "darkness";
}

TEST(Registration, SaysInNumbersWhyAFrameIsNotGood) {
  const AlignOptions options;
  Agreement agreement;
  agreement.judged_blocks = 100;
  agreement.share = 0.31;
  agreement.zncc = 0.2;
  const auto reason = [&](Verdict verdict) { return reasonOf(verdict, agreement, options); };
  EXPECT_EQ(reason(Verdict::kGood), "");
  EXPECT_EQ(reason(Verdict::kLost).substr(0, 50),
            "only 31 % of the blocks agree, wanted 50 %: hold o");
  agreement.share = 0.8;
  EXPECT_EQ(reason(Verdict::kLost), "hardly alike: correlation 0.20, wanted 0.30");
  agreement.zncc = 0.6;
  agreement.uncertainty_px = 0.71;
  EXPECT_EQ(reason(Verdict::kLost), "too little structure: 0.71 px expected, wanted 0.50 px");
  agreement.covered = 0.123;
  EXPECT_EQ(reason(Verdict::kCovered), "12.3 % in one piece is something else, allowed 4.0 %");
  agreement.contrast_coarse = 0.5;
  agreement.contrast_fine = 0.2;
  EXPECT_EQ(reason(Verdict::kFogged), "contrast is 0.50 of the reference's, wanted 0.80");
  EXPECT_EQ(reason(Verdict::kBlurred), "fine contrast is 0.40 of the coarse, wanted 0.70");
}

TEST(Registration, HoldsOnToNothingOutsideOfItsMask) {
  const ShiftedSpecimen twin("steel_rusting", {256, 256});
  Image<float> still = twin.at(0.5, {}, 1), frame = twin.at(0.5, {1.4, -0.8}, 2);
  // Another specimen fills the left 60 %, and moves against the rest.
  const ShiftedSpecimen other("wood_drying", {256, 256});
  const Image<float> grain = other.at(0.2, {}, 1), drier = other.at(0.8, {-3, 2}, 2);
  Image<std::uint8_t> mask(256, 256, 1, 255);
  for (int y = 0; y < 256; ++y)
    for (int x = 0; x < 154; ++x) {
      mask.at(x, y) = 0;
      for (int c = 0; c < 3; ++c) {
        still.at(x, y, c) = grain.at(x, y, c);
        frame.at(x, y, c) = drier.at(x, y, c);
      }
    }
  Progress progress;
  for (const MotionModel model : {MotionModel::kTranslation, MotionModel::kEuclidean}) {
    const Alignment found =
        align(frame.view(), preparePicture(still.view(), mask.view()), optionsOf(model), progress);
    EXPECT_NEAR(moved(found.frame_from_reference, {200, 128}).x - 200, 1.4, 0.08) << name(model);
    EXPECT_NEAR(moved(found.frame_from_reference, {200, 128}).y - 128, -0.8, 0.08) << name(model);
    EXPECT_EQ(found.verdict, Verdict::kGood) << name(found.verdict);
  }
}

TEST(Registration, RefusesOptionsThatMakeNoSense) {
  AlignOptions options;
  options.least_share = 1.5;
  EXPECT_THROW(options.check(), CalibrationError);
  options = {};
  options.start = {1, 0.1, 0, 0, 1, 0, 0, 0, 1};
  EXPECT_THROW(options.check(), CalibrationError);
}

}  // namespace
}  // namespace patina::calibration
