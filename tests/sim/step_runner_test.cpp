// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/step_runner.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "tests/sim/simulation.h"

namespace patina::testing {
namespace {

using namespace std::chrono_literals;
using ::testing::Contains;
using ::testing::HasSubstr;

std::vector<std::string> twelve(const std::string& decision) {
  return std::vector<std::string>(12, decision);
}

TEST(StepRunner, TakesACameraDownAndGoesOnWithTheOther) {
  Simulation sim({.duration = "3h",
                  .cameras = 2,
                  .faults = "[[fault]]\nat = \"55min\"\ndevice = \"cam1\"\nkind = \"hang\"\n"
                            "duration = \"60min\"\n"});
  sim.run();
  const auto decisions = sim.decisions();
  EXPECT_EQ(std::count(decisions.begin(), decisions.end(), "failed"), 6);
  for (const auto& step : sim.reader().steps(sim.run_id, db::Decision::kFailed)) {
    EXPECT_EQ(step.shots_captured, 1);
    EXPECT_THAT(step.reason, HasSubstr("cam1: timeout"));
  }
  EXPECT_EQ(decisions[12], "captured");  // within two intervals of the fault's end
  const auto alarms = sim.events("alarm");
  ASSERT_EQ(alarms.size(), 2u);
  EXPECT_THAT(alarms[0].detail, HasSubstr("camera cam1 down begins"));
  EXPECT_THAT(alarms[1].detail, HasSubstr("is over"));
  sim.expectWhole();
}

TEST(StepRunner, HoldsWhileALampIsDeadAndGoesOnByItself) {
  Simulation sim({.duration = "3h",
                  .faults = "[[fault]]\nat = \"75min\"\ndevice = \"key\"\nkind = \"lamp_dead\"\n"
                            "duration = \"40min\"\n"});
  sim.run();
  std::vector<std::string> expected(18, "captured");
  for (std::size_t k : {8, 9, 10}) expected[k] = "held";
  EXPECT_EQ(sim.decisions(), expected);
  const auto back = sim.reader().step(sim.run_id, 11);  // dead until 115 min, due at 110
  EXPECT_GT(back->held, 4min);
  EXPECT_GT(back->retries, 0);
  EXPECT_THAT(sim.reader().step(sim.run_id, 9)->reason, HasSubstr("light key: patch:cam0"));
  EXPECT_THAT(sim.events("alarm").back().detail, HasSubstr("light key dead is over"));
  sim.expectWhole();
}

TEST(StepRunner, ShootsTheOtherLightsWhileOneIsHeld) {
  Simulation sim({.lights = R"([["key"], ["fill"]])",
                  .faults = "[[fault]]\nat = \"55min\"\ndevice = \"key\"\nkind = \"lamp_dead\"\n"});
  sim.run();
  const auto step = sim.reader().step(sim.run_id, 7);
  EXPECT_EQ(step->decision, db::Decision::kHeld);
  EXPECT_EQ(step->shots_captured, 1);
  sim.expectWhole();
}

TEST(StepRunner, AsksSeldomerTheLongerALightStaysAway) {
  Simulation sim({.duration = "24h",
                  .faults = "[[fault]]\nat = \"55min\"\ndevice = \"key\"\nkind = \"lamp_dead\"\n"});
  sim.run();
  const auto last = sim.reader().step(sim.run_id, 143);
  EXPECT_EQ(last->decision, db::Decision::kHeld);
  EXPECT_EQ(sim.reader().shotsOfStep(last->id).size(), 1u);  // as in a step that is not held
  EXPECT_GT(sim.reader().shotsOfStep(sim.reader().step(sim.run_id, 6)->id).size(), 10u);
}

// Its last try leaves the lamp on; it must not be warmer at the next step than it was when the gate
// learned it.
TEST(StepRunner, GoesOnAfterAHoldOfALampThatIsKept) {
  Simulation sim({.duration = "4h",
                  .lights = R"([["key"], ["fill"]])",
                  .between = "keep",
                  .faults = "[[fault]]\nat = \"95min\"\ndevice = \"key\"\nkind = \"lamp_step\"\n"
                            "amount = -0.05\nduration = \"40min\"\n"});
  sim.run();
  std::vector<std::string> expected(24, "captured");
  for (std::size_t k : {10, 11, 12}) expected[k] = "held";
  EXPECT_EQ(sim.decisions(), expected);
  sim.expectWhole();
}

// Steps of 5 % among the first ten checks, whatever the gate has learned by then.
TEST(StepRunner, TellsOfALampThatChangesWhileTheGateLearnsIt) {
  for (const int check : {3, 4, 5, 6, 7, 8, 9})
    for (const double amount : {-0.05, 0.05}) {
      Simulation sim({.duration = "3h",
                      .faults = "[[fault]]\nat = \"" + std::to_string(10 * check - 15) +
                                "min\"\ndevice = \"key\"\nkind = \"lamp_step\"\namount = " +
                                std::to_string(amount) + "\n"});
      int alerts = 0;
      sim.run([&](capture::SessionHooks& hooks) {
        hooks.on_alert = [&](const capture::AlertNews& news) {
          alerts += news.kind == capture::AlertKind::kLightChanged &&
                    news.event == capture::AlertEvent::kBegins && news.subject == "key";
        };
      });
      EXPECT_EQ(alerts, 1) << check << " " << amount;
      ASSERT_EQ(sim.events("light").size(), 1u) << check << " " << amount;
      EXPECT_THAT(sim.events("light")[0].detail, HasSubstr("light key: patch:cam0"));
      // The run goes on at the new level.
      EXPECT_EQ(sim.decisions(), std::vector<std::string>(18, "captured")) << check;
      sim.expectWhole();
    }
}

TEST(StepRunner, NeverHoldsInUncontrolledLight) {
  Simulation sim({.light_check = "mode = \"uncontrolled\"",
                  .faults = "[[fault]]\nat = \"55min\"\ndevice = \"key\"\nkind = \"lamp_dead\"\n"});
  sim.run();
  EXPECT_EQ(sim.decisions(), twelve("captured"));
  for (const auto& check : sim.reader().lightChecks(sim.run_id))
    EXPECT_EQ(check.verdict, "measure");
  sim.expectWhole();
}

TEST(StepRunner, HoldsOutsideTheBandOfATemperature) {
  // The twin's room swings between 18 and 22 degrees, coolest at 03:00.
  Simulation sim({.interval = "30min",
                  .duration = "24h",
                  .rig = "[[sensor]]\nid = \"air\"\nbackend = \"twin\"\nquantity = "
                         "\"temperature\"\nband = [19.0, 25.0]\n"});
  sim.run();
  const auto decisions = sim.decisions();
  EXPECT_EQ(decisions[0], "captured");
  EXPECT_EQ(decisions[30], "held");  // 03:00
  EXPECT_EQ(decisions[47], "captured");
  EXPECT_THAT(sim.reader().step(sim.run_id, 30)->reason, HasSubstr("temperature air"));
  EXPECT_TRUE(sim.reader().shotsOfStep(sim.reader().step(sim.run_id, 30)->id).empty());
  sim.expectWhole();
}

TEST(StepRunner, GoesOnWithoutASensorThatFallsSilent) {
  Simulation sim({.rig = "[[sensor]]\nid = \"lux0\"\nbackend = \"twin\"\nquantity = "
                         "\"illuminance\"\n",
                  .faults = "[[fault]]\nat = \"35min\"\ndevice = \"lux0\"\nkind = "
                            "\"sensor_silent\"\nduration = \"30min\"\n"});
  sim.run();
  EXPECT_EQ(sim.decisions(), twelve("captured"));
  int silent = 0;
  for (const auto& reading : sim.reader().readings(sim.run_id))
    silent += reading.quality == "silent" ? 1 : 0;
  EXPECT_EQ(silent, 3);
  EXPECT_EQ(sim.events("alarm").size(), 2u);
}

constexpr const char* kAir =
    "[[sensor]]\nid = \"air0\"\nbackend = \"twin\"\nquantity = \"temperature\"\n";

// From the first step to the last.
void expectNoGap(Simulation& sim, Nanoseconds longest) {
  std::optional<UtcTime> last;
  for (const auto& reading : sim.reader().readings(sim.run_id)) {
    EXPECT_LE(reading.utc - last.value_or(sim.t0), longest) << formatUtc(reading.utc);
    last = reading.utc;
  }
  ASSERT_TRUE(last);
  EXPECT_GE(*last, sim.t0 + sim.plan.duration - sim.plan.interval);  // the last step
}

TEST(StepRunner, ReadsSensorsOnThePlansPeriodBetweenStepsAndInAHeldOne) {
  Simulation sim({.interval = "1h",
                  .duration = "8h",
                  .rig = kAir,
                  .faults = "[[fault]]\nat = \"170min\"\ndevice = \"key\"\nkind = "
                            "\"lamp_dead\"\nduration = \"150min\"\n"});
  sim.plan.read_sensors_every = 5min;
  sim.run();
  expectNoGap(sim, 5min + 10s);
  std::map<std::int64_t, int> of_step;
  int between = 0;
  for (const auto& reading : sim.reader().readings(sim.run_id))
    reading.step_id ? ++of_step[*reading.step_id] : ++between;
  const auto held = sim.reader().steps(sim.run_id, db::Decision::kHeld);
  ASSERT_FALSE(held.empty());
  EXPECT_GE(of_step[held[0].id], 10);  // the hour it was held for
  EXPECT_EQ(of_step[sim.reader().step(sim.run_id, 0)->id], 1);
  EXPECT_GT(between, 30);
  sim.expectWhole();
}

TEST(StepRunner, ReadingSensorsOftenChangesNothingElse) {
  const SimulationOptions options{.lights = R"([["key"], ["fill"]])", .rig = kAir};
  Simulation seldom(options), often(options);
  often.plan.read_sensors_every = 90s;
  EXPECT_EQ(often.run().event_log_sha256, seldom.run().event_log_sha256);
  EXPECT_GT(often.reader().readings(often.run_id).size(),
            5 * seldom.reader().readings(seldom.run_id).size());
  Simulation again(options);
  again.plan.read_sensors_every = 90s;
  again.run();
  EXPECT_EQ(again.reader().readings(again.run_id).size(),
            often.reader().readings(often.run_id).size());
}

}  // namespace
}  // namespace patina::testing
