// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/picture_maker.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>

#include "tests/devices/twin/bench_rig.h"

namespace patina::devices::twin {
namespace {

using namespace std::chrono_literals;

struct Studio {
  VirtualClock clock{UtcTime{}};
  World world;
  PictureMaker maker;
  explicit Studio(const RigSpec& spec)
      : world(spec, {}, clock), maker(world, spec.cameras[0], {}, 1) {}

  ShotLight shot(double key, double fill, Nanoseconds begin = 1h) const {
    ShotLight s;
    s.begin = begin;
    s.exposure = defaultExposure();
    s.levels = {key, fill};
    s.noise_key = static_cast<std::uint64_t>(begin.count());
    return s;
  }
};

double meanAbove(const RawMosaic& raw, RectPx rect) {
  double sum = 0;
  for (int y = rect.y; y < rect.y + rect.height; ++y)
    for (int x = rect.x; x < rect.x + rect.width; ++x) sum += raw.samples.at(x, y) - 64.0;
  return sum / (static_cast<double>(rect.width) * rect.height);
}

TEST(PictureMaker, AGreyCardUnderOneLampFillsFortyFivePercentOfTheWell) {
  Studio studio(benchRig("grey_card", "256x256"));
  const RawMosaic raw = studio.maker.expose(studio.shot(1, 0));
  EXPECT_NEAR(meanAbove(raw, {112, 112, 32, 32}) / (4095 - 64), 0.45, 0.01);
}

TEST(PictureMaker, LightIsAddedUp) {
  Studio studio(benchRig("grey_card", "256x256"));
  const RectPx middle{100, 100, 40, 40};
  const double key = meanAbove(studio.maker.expose(studio.shot(0.5, 0)), middle),
               fill = meanAbove(studio.maker.expose(studio.shot(0, 0.5)), middle),
               both = meanAbove(studio.maker.expose(studio.shot(0.5, 0.5)), middle);
  EXPECT_NEAR(both / (key + fill), 1, 0.005);
}

TEST(PictureMaker, IsDarkWithoutLight) {
  Studio studio(benchRig("grey_card", "64x48"));
  const double lit = meanAbove(studio.maker.expose(studio.shot(1, 0)), {0, 0, 64, 48}),
               dark = meanAbove(studio.maker.expose(studio.shot(0, 0)), {0, 0, 64, 48});
  EXPECT_LT(dark, 0.01 * lit);
}

TEST(PictureMaker, DrawsThePatchWhereTheLayoutSays) {
  Studio studio(benchRig("banana_ripening", "256x256"));
  const RectPx patch = studio.maker.layout().patch_px;
  EXPECT_EQ(patch.width, 64);
  const RawMosaic raw = studio.maker.expose(studio.shot(1, 0));
  const std::vector<float> falloff = lensFalloff({256, 256}, referenceProfile().lens);
  double expected = 0, flat = 0;
  std::vector<float> card(256);
  const CameraView view(studio.maker.grid());
  const LampField field(view, LampPlace{}, true);
  std::vector<float> scratch;
  for (int y = patch.y; y < patch.y + 64; ++y) {
    shadeCardRow(field.row(y, scratch), 256, card.data());
    for (int x = patch.x; x < patch.x + 64; ++x) flat += card[x] * falloff[y * 256 + x] / 4096;
  }
  expected = 0.36 / 0.5 * 0.45 * (4095 - 64) * flat;
  EXPECT_NEAR(meanAbove(raw, patch) / expected, 1, 0.01);
}

TEST(PictureMaker, TwoLightStatesOfOneStepSeeTheSameSpecimen) {
  Studio a(benchRig("banana_ripening", "128x128")), b(benchRig("banana_ripening", "128x128"));
  a.maker.expose(a.shot(0, 1, 80h));
  const RawMosaic cached = a.maker.expose(a.shot(1, 0, 80h + 200ms));
  const RawMosaic alone = b.maker.expose(b.shot(1, 0, 80h + 200ms));
  EXPECT_EQ(cached.samples.texels(), alone.samples.texels());
}

// Large enough for several threads, with all physics there is.
RigSpec everything() {
  return parseRig(
      "[[camera]]\nid = 'cam0'\nbackend = 'twin'\n"
      "[[light]]\nid = 'key'\nbackend = 'twin'\nposition_mm = [-200, 150, 120]\n"
      "[[light]]\nid = 'fill'\nbackend = 'twin'\nposition_mm = [300, 100, 400]\n"
      "settings = { beam_deg = 30.0 }\n"
      "[twin]\nspecimen = 'copper_patination'\nsize = '320x256'\nshadows = true\n"
      "surroundings = 'daylight'\n"
      "[[twin.target]]\nkind = 'mirror_sphere'\nposition_mm = [-20, 10, 4]\nwidth_mm = 8.0\n",
      "rig.toml");
}

TEST(PictureMaker, GivesTheSameBytesForOneThreadAndForMore) {
  const auto exposed = [](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    Studio studio(everything());
    return studio.maker.expose(studio.shot(0.9, 0.4, 2h)).samples.texels();
  };
  const auto one = exposed(1);
  EXPECT_EQ(exposed(2), one);
  EXPECT_EQ(exposed(4), one);
}

// A time of day at which the sun shines, and lamps that do not.
TEST(PictureMaker, ShowsTheDayWithoutLamps) {
  RigSpec spec = everything();
  Studio day(spec);
  const double noon = meanAbove(day.maker.expose(day.shot(0, 0, 12h)), {100, 20, 100, 60}),
               midnight = meanAbove(day.maker.expose(day.shot(0, 0, 24h)), {100, 20, 100, 60});
  EXPECT_GT(noon, 100);
  EXPECT_LT(midnight, 5);
}

TEST(PictureMaker, ShadowsTakeLightAndNeverGiveIt) {
  RigSpec spec = everything();
  spec.twin->surroundings = Surroundings::kDark;
  spec.twin->specimen = "grass_growth";
  spec.twin->size = {128, 96};
  Studio with(spec);
  spec.twin->shadows = false;
  Studio without(spec);
  const auto a = with.maker.light(with.shot(1, 0, 60h)),
             b = without.maker.light(without.shot(1, 0, 60h));
  double lost = 0, all = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    EXPECT_LE(a[k], b[k] * 1.000001f);
    lost += b[k] - a[k];
    all += b[k];
  }
  EXPECT_GT(lost / all, 0.05) << "blades shade each other";
  EXPECT_LT(lost / all, 0.8);
}

TEST(PictureMaker, ExposureApertureAndIsoScaleTheNumbers) {
  Studio studio(benchRig("grey_card", "64x48"));
  const RectPx all{20, 0, 40, 30};
  ShotLight shot = studio.shot(0.5, 0);
  const double base = meanAbove(studio.maker.expose(shot), all);
  shot.exposure.time = 10ms;
  EXPECT_NEAR(meanAbove(studio.maker.expose(shot), all) / base, 0.5, 0.01);
  shot.exposure.iso = Iso{200};
  EXPECT_NEAR(meanAbove(studio.maker.expose(shot), all) / base, 1.0, 0.01);
  shot.exposure.f_number = FNumber{16};
  EXPECT_NEAR(meanAbove(studio.maker.expose(shot), all) / base, 0.25, 0.01);
}

}  // namespace
}  // namespace patina::devices::twin
