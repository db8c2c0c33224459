// SPDX-License-Identifier: GPL-3.0-or-later
// What a session makes of the troubles of the twin's world: where it can know of them it holds,
// flags or alarms, and says why; where it cannot, the run goes on.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "devices/twin/twin.h"
#include "devices/twin/view_troubles.h"
#include "devices/twin/visitors.h"
#include "tests/sim/simulation.h"

namespace patina::testing {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

// Steps 13 to 18 of 24 lie within the fault.
constexpr std::size_t kFirst = 13, kLast = 18;

struct Trouble {
  std::string device, kind, amount;
};
class TroubledSession {
 public:
  explicit TroubledSession(const Trouble& trouble, const std::string& more_rig = "",
                           std::uint64_t seed = 1, const std::string& between = "off",
                           const std::string& at = "125min", const std::string& lasts = "60min")
      : sim_({.duration = "4h",
              .light_check = "max_hold = \"0s\"",
              .lights = R"([["key"], ["fill"]])",
              .rig = more_rig,
              .between = between,
              .size = "128x96",
              .faults = "[[fault]]\nat = \"" + at + "\"\nduration = \"" + lasts +
                        "\"\ndevice = \"" + trouble.device + "\"\nkind = \"" + trouble.kind +
                        "\"\n" +
                        (trouble.amount.empty() ? "" : "amount = " + trouble.amount + "\n"),
              .specimen = "banana_ripening",
              .seed = seed}) {}

  Simulation& sim() { return sim_; }
  TroubledSession& run() {
    sim_.run();
    return *this;
  }
  std::vector<std::string> during() {
    const auto all = sim_.decisions();
    return {all.begin() + kFirst, all.begin() + kLast + 1};
  }
  // All but those within the fault and the one after it.
  std::vector<std::string> before() {
    const auto all = sim_.decisions();
    return {all.begin(), all.begin() + kFirst};
  }
  std::string last() { return sim_.decisions().back(); }
  std::string reason() { return sim_.reader().step(sim_.run_id, 15)->reason; }
  std::vector<std::string> alarms() {
    std::vector<std::string> details;
    for (const auto& event : sim_.events("alarm")) details.push_back(event.detail);
    return details;
  }

 private:
  Simulation sim_;
};

const char* const kLux =
    "[[sensor]]\nid = \"lux0\"\nbackend = \"twin\"\nquantity = \"illuminance\"\n";

void expectHeld(TroubledSession& session) {
  EXPECT_THAT(session.before(), Each("captured"));
  EXPECT_THAT(session.during(), Each("held"));
  EXPECT_EQ(session.last(), "captured") << "goes on by itself";
  session.sim().expectWhole();
}
void expectCaptured(TroubledSession& session) {
  EXPECT_THAT(session.sim().decisions(), Each("captured"));
  session.sim().expectWhole();
}

TEST(TroubledSession, HoldsALightWhoseWrongLampIsLitAndShootsTheOther) {
  TroubledSession session({"key", "wrong_lamp", ""});
  session.sim().rig_spec.lights[1].position_mm = {200, 150, 300};
  session.run();
  expectHeld(session);
  EXPECT_THAT(session.reason(),
              AllOf(StartsWith("light key: patch:cam0"),
                    HasSubstr("; that is the light of fill: is the wrong lamp lit?")));
  EXPECT_EQ(session.sim().reader().step(session.sim().run_id, 15)->shots_captured, 1);
  EXPECT_THAT(session.alarms(), ElementsAre(StartsWith("light key held begins"),
                                            StartsWith("light key held is over")));
}

TEST(TroubledSession, CannotTellALampThatGivesThePatchTheSameLight) {
  TroubledSession session({"key", "wrong_lamp", ""});  // both lamps hang above the middle
  expectCaptured(session.run());
}

class CoveredPatch : public ::testing::TestWithParam<const char*> {};

// The picture has seen too few shots to have a vote.
TEST_P(CoveredPatch, HoldsWhatNoOtherWitnessVouchesFor) {
  TroubledSession session({"cam0", GetParam(), "0.3"}, "", 1, "off", "45min", "20min");
  session.run();
  EXPECT_THAT(session.sim().decisions()[5], "held");
  EXPECT_THAT(session.sim().decisions()[6], "held");
  EXPECT_EQ(session.last(), "captured") << "goes on by itself";
  EXPECT_THAT(session.sim().reader().step(session.sim().run_id, 6)->reason,
              HasSubstr("patch:cam0 is partly covered (spread"));
  EXPECT_THAT(session.alarms(), Contains(StartsWith("light key held begins: light key: "
                                                    "patch:cam0 is partly covered")));
  session.sim().expectWhole();
}

TEST_P(CoveredPatch, GoesOnWithARemarkWhileALuxSensorVouchesForTheLight) {
  TroubledSession session({"cam0", GetParam(), "0.3"}, kLux, 1, "off", "45min", "20min");
  expectCaptured(session.run());
  EXPECT_THAT(session.alarms(),
              Contains(AllOf(HasSubstr("light key"), HasSubstr("patch:cam0 is partly covered"))));
  EXPECT_THAT(session.alarms().back(), HasSubstr("is over"));
}

TEST_P(CoveredPatch, GoesOnWithARemarkWhileThePictureVouchesForTheLight) {
  TroubledSession session({"cam0", GetParam(), "0.3"});
  expectCaptured(session.run());
  EXPECT_THAT(session.alarms(), Contains(AllOf(HasSubstr("light key"),
                                               HasSubstr("soiled or covered: the picture says"))));
  EXPECT_THAT(session.alarms().back(), HasSubstr("is over"));
}

INSTANTIATE_TEST_SUITE_P(By, CoveredPatch,
                         ::testing::Values("patch_soiled", "patch_snowed", "patch_overgrown"),
                         [](const auto& kind) { return std::string(kind.param); });

// It grows over four days, as slowly as a lamp may drift, which the gain undoes.
TEST(TroubledSession, TellsAPatchThatIsSlowlyOvergrownFromADriftByTheLuxSensor) {
  Simulation sim({.interval = "30min",
                  .duration = "3d",
                  .rig = kLux,
                  .size = "128x96",
                  .faults = "[[fault]]\nat = \"6h\"\ndevice = \"cam0\"\nkind = "
                            "\"patch_overgrown\"\nduration = \"40d\"\namount = 0.5\n"});
  sim.run();
  ASSERT_FALSE(sim.events("alarm").empty());
  EXPECT_THAT(sim.events("alarm")[0].detail,
              AllOf(StartsWith("light key drifting begins: light key: patch:cam0 (-5"),
                    HasSubstr("and sensor:lux0"), HasSubstr("have drifted apart")));
}

TEST(TroubledSession, TellsAPatchThatIsAllDirtFromALampByThePictureAlone) {
  for (const char* sensors : {"", kLux}) {
    TroubledSession session({"cam0", "patch_soiled", "1"}, sensors);
    expectCaptured(session.run());
    EXPECT_THAT(session.alarms()[0],
                AllOf(HasSubstr("patch:cam0 (-9"), HasSubstr("the picture says light")));
  }
}

TEST(TroubledSession, HoldsWhileTheLensIsFogged) {
  TroubledSession alone({"cam0", "condensation", "0.4"}),
      vouched({"cam0", "condensation", "0.4"}, kLux);
  expectHeld(alone.run());
  EXPECT_THAT(alone.reason(), HasSubstr("patch:cam0 r +"));
  expectHeld(vouched.run());
  EXPECT_THAT(vouched.reason(), HasSubstr("is at odds with sensor:lux0"));
}

// Share of the patch under the hand that a run of this seed sees.
double patchUnderHand(std::uint64_t seed) {
  devices::Fault hand;
  hand.at = std::chrono::minutes(125);
  hand.device = "cam0";
  hand.kind = devices::FaultKind::kHand;
  devices::FaultPlan plan;
  plan.seed = seed;
  const SizePx size{128, 96};
  const auto share = devices::twin::handShare(size, devices::twin::viewKey(plan, hand));
  const RectPx patch = TroubledSession({"cam0", "hand", ""}).sim().rig_spec.patches[0].rect_px;
  double under = 0;
  for (int y = patch.y; y < patch.y + patch.height; ++y)
    for (int x = patch.x; x < patch.x + patch.width; ++x)
      under += share[static_cast<std::size_t>(y) * 128 + x];
  return under / (static_cast<double>(patch.width) * patch.height);
}

TEST(TroubledSession, HoldsWhileAHandIsOverThePatchAndTellsOfAnother) {
  std::uint64_t over = 1, beside = 1;
  while (patchUnderHand(over) < 0.4) ++over;
  while (patchUnderHand(beside) > 0) ++beside;
  TroubledSession covered({"cam0", "hand", ""}, "", over), free({"cam0", "hand", ""}, "", beside);
  expectHeld(covered.run());
  EXPECT_THAT(covered.reason(), HasSubstr("patch:cam0"));
  expectCaptured(free.run());
  EXPECT_THAT(free.alarms(), Contains(AllOf(HasSubstr("light key: content:cam0"),
                                            HasSubstr("a shadow, a visitor,"))));
}

// A step's picture is taken within seconds of when it is due.
double walkedAtStep(std::size_t step) { return (10.0 * static_cast<double>(step) - 125) / 60; }

TEST(TroubledSession, IsNotMisledByAnInsectOnThePatch) {
  devices::Fault insect;
  insect.at = std::chrono::minutes(125);
  insect.device = "cam0";
  insect.kind = devices::FaultKind::kInsect;
  const RectPx patch = TroubledSession({"cam0", "insect", ""}).sim().rig_spec.patches[0].rect_px;
  const auto on_patch = [&](std::uint64_t seed) {
    devices::FaultPlan plan;
    plan.seed = seed;
    for (std::size_t step = kFirst; step <= kLast; ++step) {
      const auto place = devices::twin::insectAt({128, 96}, devices::twin::viewKey(plan, insect),
                                                 walkedAtStep(step));
      if (std::abs(place.x_px - patch.x - patch.width / 2.0) < patch.width / 2.0 - 3 &&
          std::abs(place.y_px - patch.y - patch.height / 2.0) < patch.height / 2.0 - 3)
        return true;
    }
    return false;
  };
  std::uint64_t seed = 1;
  while (!on_patch(seed)) ++seed;
  TroubledSession session({"cam0", "insect", ""}, "", seed);
  expectCaptured(session.run());
  EXPECT_THAT(session.alarms(), IsEmpty());
}

TEST(TroubledSession, TakesABumpedCameraForACoveredPatch) {
  TroubledSession session({"cam0", "camera_bumped", "3"});
  expectHeld(session.run());
  EXPECT_THAT(session.reason(), HasSubstr("patch:cam0 is partly covered"));
}

// The picture tells; that it was a bump is for registration to find.
TEST(TroubledSession, GoesOnWithARemarkWhenTheSpecimenIsBumped) {
  TroubledSession session({"specimen", "specimen_bumped", "5"}, kLux);
  expectCaptured(session.run());
  EXPECT_THAT(session.alarms(),
              Contains(AllOf(HasSubstr("content:cam0"), HasSubstr("or the specimen moved?"))));
}

// What leaves the patch as it is: for registration and calibration to find.
class UnknownTrouble : public ::testing::TestWithParam<Trouble> {};

TEST_P(UnknownTrouble, IsCapturedWithoutAWord) {
  TroubledSession session(GetParam(), kLux);
  session.sim().rig_spec.lights[0].position_mm = {-200, 150, 300};
  expectCaptured(session.run());
  EXPECT_THAT(session.alarms(), IsEmpty());
}

INSTANTIATE_TEST_SUITE_P(Of, UnknownTrouble,
                         ::testing::Values(Trouble{"specimen", "specimen_warps", "0.1"},
                                           Trouble{"cam0", "focus_creep", "10"},
                                           Trouble{"cam0", "insect", ""}),
                         [](const auto& trouble) { return trouble.param.kind; });

TEST(TroubledSession, HoldsALampThatStandsOnTheOtherSideAllAtOnce) {
  TroubledSession session({"key", "lights_mirrored", ""}, kLux);
  session.sim().rig_spec.lights[0].position_mm = {-200, 150, 300};
  session.run();
  expectHeld(session);
  EXPECT_THAT(session.reason(),
              AllOf(HasSubstr("patch:cam0"), HasSubstr("is at odds with sensor:lux0")));
}

TEST(TroubledSession, KnowsOfALostFocusWhenThePatchsBorderBlursIntoThePatch) {
  TroubledSession session({"cam0", "focus_creep", "120"});  // 5 pixels in the end, and for good
  session.run();
  EXPECT_THAT(session.before(), Each("captured"));
  EXPECT_EQ(session.last(), "held");
  EXPECT_THAT(session.alarms()[0],
              AllOf(StartsWith("light key held begins"), HasSubstr("patch:cam0")));
}

TEST(TroubledSession, DoubtsALuxSensorThatSticksWhileLampsAreSwitched) {
  TroubledSession session({"lux0", "sensor_stuck", ""}, kLux);
  expectCaptured(session.run());
  EXPECT_THAT(session.alarms(),
              Contains(AllOf(StartsWith("sensor lux0 doubtful begins: it says"),
                             HasSubstr("and the same before that is lit: stuck"))));
  EXPECT_THAT(session.alarms(), Contains(StartsWith("sensor lux0 doubtful is over")));
}

TEST(TroubledSession, NamesALuxSensorThatSticksWhileAllLampsRestLit) {
  TroubledSession session({"lux0", "sensor_stuck", ""}, kLux, 1, "on");
  expectCaptured(session.run());
  EXPECT_THAT(session.alarms(), Contains(AllOf(HasSubstr("light key: sensor:lux0 (+"),
                                               HasSubstr("at odds with the reference patch"))));
}

TEST(TroubledSession, DoubtsASensorAtTheEndOfItsRange) {
  TroubledSession lux({"lux0", "sensor_saturated", ""}, kLux),
      air({"air", "sensor_saturated", ""},
          "[[sensor]]\nid = \"air\"\nbackend = \"twin\"\nquantity = \"temperature\"\n");
  expectCaptured(lux.run());
  EXPECT_THAT(lux.alarms(),
              ElementsAre(StartsWith("sensor lux0 doubtful begins: it says 120000 lx under key"),
                          StartsWith("sensor lux0 doubtful is over")));
  expectCaptured(air.run());
  EXPECT_THAT(air.alarms(), ElementsAre(StartsWith("sensor air doubtful begins: it says 85 degC"),
                                        StartsWith("sensor air doubtful is over")));
}

}  // namespace
}  // namespace patina::testing
