// SPDX-License-Identifier: GPL-3.0-or-later
// The picture's vote on specimens that age as they do in the paper, and nothing else happens.
#include <gtest/gtest.h>

#include <cstdlib>

#include "capture/light_gate.h"
#include "devices/twin/picture_maker.h"
#include "processing/image/image.h"

namespace patina::testing {
namespace {

namespace twin = devices::twin;

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
  // Of a share of the process; a shadow lies over a fifth of it, the upper right.
  capture::LightSample at(double share, int shot, double shadow) {
    twin::ShotLight light;
    light.begin =
        Nanoseconds(static_cast<std::int64_t>(share * static_cast<double>(duration.count())));
    light.exposure = twin::defaultExposure();
    light.levels = {1};
    light.temperature = Celsius{20};
    light.noise_key = 100 + static_cast<std::uint64_t>(shot);
    RawMosaic raw = maker.expose(light);
    for (int y = 0; y < raw.samples.height() / 2; ++y)
      for (int x = raw.samples.width() * 3 / 5; x < raw.samples.width(); ++x)
        raw.samples.at(x, y) = static_cast<std::uint16_t>(
            raw.black_level + (1 - shadow) * (raw.samples.at(x, y) - raw.black_level));
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
    const capture::GateVerdict v = gate.judge(ageing.at(static_cast<double>(k) / shots(), k, 0));
    EXPECT_EQ(v.reason, "") << "picture " << k;
    EXPECT_EQ(v.changed, "") << "picture " << k;
  }
}

INSTANTIATE_TEST_SUITE_P(Paper, LightOfAnAgeing,
                         ::testing::Values("banana_ripening", "copper_patination", "grass_growth",
                                           "paint_cracking", "snow_accumulation", "steel_rusting",
                                           "wood_drying"),
                         [](const auto& of) { return std::string(of.param); });

TEST(LightOfAnAgeingSpecimen, ShadowOverAFifthOfItIsToldAtOnce) {
  Ageing ageing("banana_ripening");
  capture::LightGate gate({}, {}, "run");
  const auto shot = [&](int k, double shadow) {  // every ten minutes of a week
    return gate.judge(ageing.at(k / 1008.0, k, shadow)).reason;
  };
  for (int k = 0; k < 20; ++k) EXPECT_EQ(shot(k, 0), "") << k;
  EXPECT_NE(shot(20, 0.2).find("of it changed by"), std::string::npos);
}

}  // namespace
}  // namespace patina::testing
