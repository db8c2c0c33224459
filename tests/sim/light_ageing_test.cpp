// SPDX-License-Identifier: GPL-3.0-or-later
// The picture's vote on specimens that age as they do in the paper, and nothing else happens.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>

#include "capture/light_gate.h"
#include "devices/twin/picture_maker.h"
#include "processing/image/image.h"

namespace patina::testing {
namespace {

namespace twin = devices::twin;

using Trouble = std::function<void(RawMosaic&, RectPx patch)>;

// What a share of the light is missing from, by shares of the picture; never from the patch.
Trouble shadow(double missing, double left, double right, double top, double low) {
  return [=](RawMosaic& raw, RectPx patch) {
    const int w = raw.samples.width(), h = raw.samples.height();
    for (int y = static_cast<int>(top * h); y < static_cast<int>(low * h); ++y)
      for (int x = static_cast<int>(left * w); x < static_cast<int>(right * w); ++x) {
        constexpr int kBorderPx = 4;
        if (x >= patch.x - kBorderPx && x < patch.x + patch.width + kBorderPx &&
            y >= patch.y - kBorderPx && y < patch.y + patch.height + kBorderPx)
          continue;
        raw.samples.at(x, y) = static_cast<std::uint16_t>(std::lround(
            raw.black_level + (1 - missing) * (raw.samples.at(x, y) - raw.black_level)));
      }
  };
}

Trouble shadowOverAFifth(double missing) { return shadow(missing, 0.6, 1, 0, 0.5); }

struct Ageing {
  devices::RigSpec rig;
  devices::VirtualClock clock{UtcTime{}};
  Nanoseconds duration;
  twin::World world;
  twin::PictureMaker maker;

  explicit Ageing(const std::string& specimen)
      : rig(devices::parseRig("name = 'ageing'\n"
                              "[[camera]]\nid = 'cam0'\nbackend = 'twin'\n"
                              "[[light]]\nid = 'key'\nbackend = 'twin'\n"
                              "position_mm = [180, 90, 260]\n"
                              "[twin]\nspecimen = '" +
                                  specimen + "'\nsize = '192x192'\n",
                              "rig.toml")),
        duration(twin::makeSpecimen(specimen, 3)->info().duration),
        world(rig, optionsOf(duration), clock),
        maker(world, rig.cameras[0], {}, 1) {}
  static twin::TwinOptions optionsOf(Nanoseconds duration) {
    twin::TwinOptions options;
    options.seed = 3;
    options.duration = duration;
    return options;
  }
  // Of a share of the process, with what a trouble makes of the picture.
  capture::LightSample at(double share, int shot, const Trouble& trouble = {}) {
    twin::ShotLight light;
    light.begin =
        Nanoseconds(static_cast<std::int64_t>(share * static_cast<double>(duration.count())));
    light.exposure = twin::defaultExposure();
    light.levels = {1};
    light.temperature = Celsius{20};
    light.noise_key = 100 + static_cast<std::uint64_t>(shot);
    RawMosaic raw = maker.expose(light);
    if (trouble) trouble(raw, maker.layout().patch_px);
    const RectPx patch = maker.layout().patch_px;
    capture::LightSample sample;
    sample.light_state = "key";
    sample.utc = UtcTime{} + std::chrono::hours(1) + light.begin;
    sample.patches = {{"cam0",
                       calibration::measurePatch(raw.samples.view(), raw.cfa, raw.black_level,
                                                 raw.white_level, patch),
                       std::nullopt}};
    sample.contents = {
        {"cam0",
         calibration::measureTiles(raw.samples.view(), raw.black_level, raw.white_level, patch),
         std::nullopt}};
    return sample;
  }
};

// Sixty pictures a process: what changes more from one to the next is no time-lapse. The long form
// takes more.
int shots() { return std::getenv("PATINA_LIGHT_TRIALS") ? 240 : 60; }

class LightOfAnAgeing : public ::testing::TestWithParam<const char*> {};

TEST_P(LightOfAnAgeing, SpecimenIsNeverTakenForAShadowOrAVisitor) {
  Ageing ageing(GetParam());
  capture::LightGate gate({}, {}, "run");
  for (int k = 0; k < shots(); ++k) {
    const capture::GateVerdict v = gate.judge(ageing.at(static_cast<double>(k) / shots(), k));
    EXPECT_EQ(v.reason, "") << "picture " << k;
    EXPECT_EQ(v.changed, "") << "picture " << k;
  }
}

// The gate is asked as it stands, again and again on its way, and forgets the answer.
TEST_P(LightOfAnAgeing, SpecimenDoesNotHideAShadowThatThePatchDoesNotSee) {
  constexpr int kShots = 240, kFirst = 24, kEvery = 12;
  const struct {
    const char* name;
    Trouble trouble;
  } troubles[] = {{"5 % missing everywhere", shadow(0.05, 0, 1, 0, 1)},
                  {"10 % missing on a fifth", shadowOverAFifth(0.1)},
                  {"30 % missing on a fifth", shadowOverAFifth(0.3)},
                  {"a hand", shadow(0.7, 0.4, 0.8, 0.1, 0.6)}};
  Ageing ageing(GetParam());
  capture::LightGate gate({}, {}, "run");
  std::array<int, 4> told{};
  int asked = 0;
  for (int k = 0; k < kShots; ++k) {
    const double share = static_cast<double>(k) / kShots;
    if (k >= kFirst && k % kEvery == 0) {
      ++asked;
      for (std::size_t i = 0; i < told.size(); ++i) {
        capture::LightGate as_it_stands = gate;
        const auto v = as_it_stands.judge(ageing.at(share, k, troubles[i].trouble));
        if (!v.reason.empty()) ++told[i];
      }
    }
    gate.judge(ageing.at(share, k));
  }
  std::printf("%s, of %d:", GetParam(), asked);
  for (std::size_t i = 0; i < told.size(); ++i) std::printf(" %s: %d;", troubles[i].name, told[i]);
  std::printf("\n");
  EXPECT_GE(told[0], 17) << "of " << asked;
}

INSTANTIATE_TEST_SUITE_P(Paper, LightOfAnAgeing,
                         ::testing::Values("banana_ripening", "copper_patination", "grass_growth",
                                           "paint_cracking", "snow_accumulation", "steel_rusting",
                                           "wood_drying"),
                         [](const auto& of) { return std::string(of.param); });

TEST(LightOfAnAgeingSpecimen, ShadowOverAFifthOfItIsToldAtOnce) {
  Ageing ageing("banana_ripening");
  capture::LightGate gate({}, {}, "run");
  const auto shot = [&](int k, const Trouble& trouble) {  // every ten minutes of a week
    return gate.judge(ageing.at(k / 1008.0, k, trouble)).reason;
  };
  for (int k = 0; k < 20; ++k) EXPECT_EQ(shot(k, {}), "") << k;
  EXPECT_NE(shot(20, shadowOverAFifth(0.2)).find("of it changed by"), std::string::npos);
}

}  // namespace
}  // namespace patina::testing
