// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/lamps/lamp_gains.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "calibration/lamps/gain_field.h"
#include "processing/image/random.h"
#include "tests/calibration/lamps/lamp_ring.h"

namespace patina::calibration {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;
using Pictures = std::vector<Image<float>>;

TEST(LampGains, AreSolvedFromPatchesThatLampsLightDifferently) {
  std::vector<GainSample> samples;
  for (int i = 0; i < 30; ++i) {
    const double a = 0.2 + 0.01 * i, b = 0.5 - 0.012 * i;
    const double noise = 1 + 0.001 * gaussian(hashSeed(8, static_cast<std::uint64_t>(i)));
    samples.push_back({(1.07 * a + 0.92 * b) * noise, {a, b}, 0.0005});
  }
  samples[4].now *= 1.5;  // a fly
  const LampGains gains = solveLampGains(samples);
  EXPECT_NEAR(gains.gain[0], 1.07, 0.003);
  EXPECT_NEAR(gains.gain[1], 0.92, 0.003);
  EXPECT_GT(gains.sigma[0], 0);
}

TEST(LampGains, AreRatiosWhereEveryLampWasShotAlone) {
  const LampGains gains = solveLampGains({{0.44, {0.4, 0}, 1e-4}, {0.27, {0, 0.3}, 1e-4}});
  EXPECT_NEAR(gains.gain[0], 1.1, 1e-9);
  EXPECT_NEAR(gains.gain[1], 0.9, 1e-9);
  EXPECT_NEAR(gains.sigma[0], 1e-4 / 0.4, 1e-9);
}

TEST(LampGains, AreRefusedWhereLampsLookAlike) {
  EXPECT_THAT(([] {
                solveLampGains({{0.5, {0.2, 0.3}, 0.001}, {0.502, {0.201, 0.3015}, 0.001}});
              }),
              ThrowsMessage<CalibrationError>(HasSubstr("shoot each lamp alone")));
  EXPECT_THAT(([] {
                solveLampGains({{0.5, {0.2, 0.3}, 0.001}});
              }),
              ThrowsMessage<CalibrationError>(HasSubstr("as many samples")));
  EXPECT_THAT(([] {
                solveLampGains({{0.5, {0.2, 0}, 0.001}, {0.5, {0.3, 0}, 0.001}});
              }),
              ThrowsMessage<CalibrationError>(HasSubstr("no light")));
}

constexpr auto kExposure = std::chrono::milliseconds(8);
constexpr int kFrames = 16;

LampRing twoLamps(const std::string& specimen) {
  LampRing ring;
  ring.specimen = specimen;
  ring.lamps_mm = {{-250, 60, 420}, {300, 100, 400}};
  ring.size = "320x320";
  return ring;
}

// What the camera would read without noise, grain or hot pixels.
Image<float> noiseless(RingTwin& twin, const std::vector<double>& levels) {
  const twin::SensorProfile& sensor = twin::referenceProfile().sensor;
  const std::vector<float> light = twin.maker().light(twin.shotAt(levels, kExposure));
  const SizePx size = twin.maker().layout().size;
  const std::vector<float> falloff = twin::lensFalloff(size, twin::referenceProfile().lens);
  RawMosaic raw;
  raw.samples = Image<std::uint16_t>(size.width, size.height, 1);
  const double full = sensor.grey_fill / sensor.grey_reflectance * toSeconds(kExposure) /
                      toSeconds(sensor.grey_exposure);
  for (std::size_t k = 0; k < light.size(); ++k)
    raw.samples.texels()[k] =
        static_cast<std::uint16_t>(std::min(light[k] * falloff[k] * full * 65535 + 0.5, 65535.0));
  return demosaic(raw);
}

Image<float> meanOf(const std::function<Image<float>(int)>& frame) {
  Image<float> mean = frame(0);
  for (int i = 1; i < kFrames; ++i) {
    const Image<float> next = frame(i);
    for (std::size_t k = 0; k < mean.texels().size(); ++k) mean.texels()[k] += next.texels()[k];
  }
  for (float& v : mean.texels()) v /= kFrames;
  return mean;
}

// What each pixel answers, of its own and by the lens; a flat, as frames of a run are divided by.
Image<float> flatOf(const std::vector<double>& levels) {
  RingTwin card(twoLamps("grey_card"));
  Image<float> flat = meanOf([&](int i) { return card.picture(levels, kExposure, 3000 + i); });
  const Image<float> truth = noiseless(card, levels);
  for (std::size_t k = 0; k < flat.texels().size(); ++k) flat.texels()[k] /= truth.texels()[k];
  return flat;
}
void divide(Image<float>& picture, const Image<float>& flat) {
  for (std::size_t k = 0; k < flat.texels().size(); ++k) picture.texels()[k] /= flat.texels()[k];
}

// The greatest relative difference over any 1,024 pixels that are above 5 % of full well.
double worstBias(const Image<float>& found, const Image<float>& truth) {
  constexpr int kSide = 32;
  double worst = 0;
  for (int y = 0; y + kSide <= truth.height(); y += kSide / 2)
    for (int x = 0; x + kSide <= truth.width(); x += kSide / 2)
      for (int c = 0; c < 3; ++c) {
        double is = 0, should = 0;
        bool lit = true;
        for (int v = y; v < y + kSide; ++v)
          for (int u = x; u < x + kSide; ++u) {
            is += found.at(u, v, c);
            should += truth.at(u, v, c);
            lit = lit && truth.at(u, v, c) > 0.05f;
          }
        if (lit) worst = std::max(worst, std::abs(is / should - 1));
      }
  return worst;
}

double patchOf(const Image<float>& picture, const RectPx& patch, int c) {
  double sum = 0;
  for (int y = patch.y + 4; y < patch.y + patch.height - 4; ++y)
    for (int x = patch.x + 4; x < patch.x + patch.width - 4; ++x) sum += picture.at(x, y, c);
  return sum;
}

struct Drift {
  std::vector<double> levels{1.08, 0.91};
  std::array<std::vector<double>, 2> alone{std::vector<double>{1.08, 0},
                                           std::vector<double>{0, 0.91}};
};

// Of each lamp and channel, from the grey patch in its single-lamp shots then and now.
std::vector<ChannelGains> gainsByPatch(RingTwin& twin, const Drift& drift) {
  const RectPx patch = twin.maker().layout().patch_px;
  std::vector<ChannelGains> gains;
  for (std::size_t lamp = 0; lamp < 2; ++lamp) {
    std::vector<double> then(2, 0);
    then[lamp] = 1;
    const Image<float> before = meanOf([&](int i) {
      return twin.picture(then, kExposure, 400 + 50 * static_cast<int>(lamp) + i);
    });
    const Image<float> now = meanOf([&](int i) {
      return twin.picture(drift.alone[lamp], kExposure, 600 + 50 * static_cast<int>(lamp) + i);
    });
    ChannelGains of_lamp{};
    for (int c = 0; c < 3; ++c)
      of_lamp[c] = static_cast<float>(
          solveLampGains({{patchOf(now, patch, c), {patchOf(before, patch, c)}, 0}}).gain[0]);
    gains.push_back(of_lamp);
  }
  return gains;
}

TEST(LampGains, UndoTwoLampsThatDriftApartOnAnySurface) {
  RingTwin twin(twoLamps("steel_rusting"));
  const Drift drift;
  const std::vector<ChannelGains> gains = gainsByPatch(twin, drift);
  EXPECT_NEAR(gains[0][1], 1.08, 0.001);
  EXPECT_NEAR(gains[1][1], 0.91, 0.001);
  const Image<float> truth = noiseless(twin, {1, 1});
  Image<float> corrected = meanOf([&](int i) {
    Image<float> frame = twin.picture(drift.levels, kExposure, i);
    const Image<float> a = twin.picture(drift.alone[0], kExposure, 100 + i),
                       b = twin.picture(drift.alone[1], kExposure, 200 + i);
    const std::vector<ImageView<const float>> shots{a.view(), b.view()};
    undoDriftByShots(frame.view(), shots, gains);
    return frame;
  });
  const Image<float> flat = flatOf({1, 1});
  divide(corrected, flat);
  Image<float> by_one_number =
      meanOf([&](int i) { return twin.picture(drift.levels, kExposure, i); });
  divide(by_one_number, flat);
  const RectPx patch = twin.maker().layout().patch_px;
  for (float& v : by_one_number.texels())
    v *= static_cast<float>(patchOf(truth, patch, 1) / patchOf(by_one_number, patch, 1));
  std::printf("two lamps apart, steel: bias %.3f %% by shots of each lamp, %.3f %% by one number\n",
              100 * worstBias(corrected, truth), 100 * worstBias(by_one_number, truth));
  EXPECT_LE(worstBias(corrected, truth), 0.002);
  EXPECT_GT(worstBias(by_one_number, truth), 0.01);
}

TEST(LampGains, UndoTwoLampsByTheirFieldsOnAFlatMattSurface) {
  LampRing ring = twoLamps("grey_card");
  RingTwin twin(ring);
  const Drift drift;
  const std::vector<ChannelGains> gains = gainsByPatch(twin, drift);
  const RectPx patch = twin.maker().layout().patch_px;
  const int edge = patch.x + patch.width + 16;
  const std::vector<RectPx> card{{0, 0, 320, patch.y - 16},
                                 {edge, patch.y - 16, 320 - edge, 320 - patch.y + 16}};
  Pictures fields;
  Progress progress;
  for (std::size_t lamp = 0; lamp < 2; ++lamp) {
    std::vector<double> then(2, 0);
    then[lamp] = 1;
    const Image<float> white =
        meanOf([&](int i) { return twin.picture(then, kExposure, 900 + i); });
    fields.push_back(paintField(fitLampField(white.view(), card, {}, progress)));
  }
  const std::vector<ImageView<const float>> views{fields[0].view(), fields[1].view()};
  Image<float> corrected = meanOf([&](int i) {
    Image<float> frame = twin.picture(drift.levels, kExposure, i);
    undoDriftByFields(frame.view(), views, gains);
    return frame;
  });
  divide(corrected, flatOf({1, 0}));
  const Image<float> truth = noiseless(twin, {1, 1});
  std::printf("two lamps apart, card: bias %.3f %% by their fields\n",
              100 * worstBias(corrected, truth));
  EXPECT_LE(worstBias(corrected, truth), 0.002);
}

TEST(LampGains, AreRefusedForPicturesOfAnotherSize) {
  Image<float> frame(8, 8, 3, 1.0f);
  const Image<float> small(4, 8, 3, 1.0f);
  const std::vector<ImageView<const float>> views{small.view()};
  const std::vector<ChannelGains> gains{{1, 1, 1}}, none{{0, 1, 1}};
  EXPECT_THROW(undoDriftByFields(frame.view(), views, gains), CalibrationError);
  EXPECT_THROW(undoDriftByShots(frame.view(), views, gains), CalibrationError);
  const Image<float> shot(8, 8, 3, 1.0f);
  const std::vector<ImageView<const float>> whole{shot.view()};
  EXPECT_THROW(undoDriftByShots(frame.view(), whole, none), CalibrationError);
}

}  // namespace
}  // namespace patina::calibration
