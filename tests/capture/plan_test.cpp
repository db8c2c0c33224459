// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/plan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace patina::capture {
namespace {

using namespace std::chrono_literals;
using ::testing::AllOf;
using ::testing::HasSubstr;

const char* const kPlan = R"(rig = "rig.toml"
specimen = "banana"
interval = "10min"
duration = "7d"
utc_offset = "+02:00"
windows = [{from = "22:00", to = "06:00"}]

[[sweep]]
lights = [["key"], ["key", "fill"], []]
exposures = ["1/50", "1/10"]

[light_check]
band = 0.03
settle = "2s"
max_hold = "1h"
)";

std::string with(const std::string& from, const std::string& to) {
  std::string text = kPlan;
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

std::string errorOf(const std::string& toml) {
  try {
    parsePlan(toml, "week.toml");
  } catch (const devices::ConfigError& error) {
    EXPECT_EQ(error.exit(), Exit::kConfig);
    return error.what();
  }
  return "no error";
}

TEST(Plan, ReadsEveryKey) {
  const Plan plan = parsePlan(with("[light_check]\n", R"([late]
policy = "skip"
[disk]
reserve = "2GB"
[after]
steps = ["ttf", "film"]
register = "translation"
fiducial = [0, 308, 76, 76]
[alerts.camera_down]
onset = "1min"
[light_check]
mode = "uncontrolled"
)"),
                              "/plans/week.toml");
  EXPECT_EQ(plan.rig_file, "/plans/rig.toml");
  EXPECT_EQ(plan.specimen, "banana");
  EXPECT_EQ(plan.interval, 10min);
  EXPECT_EQ(plan.duration, 168h);
  EXPECT_EQ(plan.utc_offset, 2h);
  ASSERT_EQ(plan.windows.size(), 1u);
  EXPECT_EQ(plan.windows[0].from, 22h);
  ASSERT_EQ(plan.sweeps.size(), 1u);
  EXPECT_EQ(plan.sweeps[0].exposures[1].time, 100ms);
  EXPECT_EQ(plan.light_check.mode, LightMode::kUncontrolled);
  EXPECT_EQ(plan.disk_reserve_bytes, 2'000'000'000u);
  EXPECT_EQ(plan.after.size(), 2u);
  EXPECT_EQ(plan.after_register, "translation");
  EXPECT_EQ(plan.after_fiducial, (RectPx{0, 308, 76, 76}));
  EXPECT_EQ(plan.alerts.rules[static_cast<std::size_t>(AlertKind::kCameraDown)].onset, 1min);
  EXPECT_EQ(plan.sha256.size(), 64u);
  EXPECT_EQ(shotsAStep(plan), 6);
}

TEST(Plan, ReadsExposuresAsTablesWithIsoAndAperture) {
  const Plan plan = parsePlan(
      with("[\"1/50\", \"1/10\"]", "[{time = \"1/100\", iso = 200, f_number = 5.6}]"), "week.toml");
  ASSERT_EQ(plan.sweeps[0].exposures.size(), 1u);
  EXPECT_EQ(plan.sweeps[0].exposures[0].time, 10ms);
  EXPECT_EQ(plan.sweeps[0].exposures[0].iso.value, 200);
  EXPECT_EQ(plan.sweeps[0].exposures[0].f_number.value, 5.6);
}

TEST(Plan, NamesTheLineAndTheNearestKeyOfAnUnknownOne) {
  EXPECT_THAT(errorOf(with("interval =", "intervall =")),
              AllOf(HasSubstr("week.toml:"), HasSubstr("interval")));
  EXPECT_THAT(errorOf(with("settle =", "setle =")),
              AllOf(HasSubstr("week.toml:14"), HasSubstr("setle"), HasSubstr("settle")));
}

TEST(Plan, RefusesAnIntervalOfZeroWithItsRange) {
  EXPECT_THAT(errorOf(with("10min", "0s")),
              AllOf(HasSubstr("week.toml:3"), HasSubstr("interval"), HasSubstr("50ms")));
  EXPECT_THAT(errorOf(with("10min", "49ms")), HasSubstr("out of range"));
}

TEST(Plan, RefusesASweepThatIsLongerThanTheInterval) {
  EXPECT_THAT(errorOf(with("10min", "4s")),
              AllOf(HasSubstr("week.toml:3"), HasSubstr("sweep"), HasSubstr("longer")));
}

TEST(Plan, RefusesWhatCannotBeMeant) {
  EXPECT_THAT(errorOf(with("\"22:00\"", "\"25:00\"")), HasSubstr("time of day"));
  EXPECT_THAT(errorOf(with("\"06:00\"", "\"22:00\"")), HasSubstr("never opens"));
  EXPECT_THAT(errorOf(with("[[\"key\"], [\"key\", \"fill\"], []]", "[]")), HasSubstr("lights"));
  EXPECT_THAT(errorOf(with("[\"key\", \"fill\"]", "[\"key\"]")), HasSubstr("twice"));
  EXPECT_THAT(errorOf(with("[\"1/50\", \"1/10\"]", "[]")), HasSubstr("empty"));
  EXPECT_THAT(errorOf(with("\"1/50\"", "\"fast\"")), HasSubstr("exposures"));
  EXPECT_THAT(errorOf(with("band = 0.03", "band = 3")), HasSubstr("0.5"));
  EXPECT_THAT(errorOf("rig = \"r\"\nspecimen = \"s\"\ninterval = \"1s\"\nduration = \"1h\"\n"),
              HasSubstr("sweep"));
}

TEST(Plan, RefusesToLayFramesOverOneAnotherAsNobodyCan) {
  const auto errorOfAfter = [](const char* line) {
    return errorOf(with("[light_check]\n", std::string("[after]\n") + line + "\n[light_check]\n"));
  };
  EXPECT_THAT(errorOfAfter("register = \"perspective\""), HasSubstr("affine"));
  EXPECT_THAT(errorOfAfter("fiducial = [0, 0, 8, 8]"), HasSubstr("register"));
  EXPECT_THAT(errorOfAfter("register = \"affine\"\nfiducial = [0, 0, 8]"), HasSubstr("fiducial"));
}

TEST(Plan, IsFedByStepsUnlessFramesAreRegistered) {
  const auto isFed = [](const char* line) {
    return isFedBySteps(
        parsePlan(with("[light_check]\n",
                       std::string("[after]\nsteps = [\"stbrdf\"]\n") + line + "\n[light_check]\n"),
                  "week.toml"));
  };
  EXPECT_TRUE(isFed(""));
  EXPECT_FALSE(isFed("register = \"translation\""));
}

TEST(Plan, ReadsAnOffsetFromUtcInEitherForm) {
  const auto offsetOf = [](const char* text) {
    return parsePlan(with("+02:00", text), "week.toml").utc_offset;
  };
  EXPECT_EQ(offsetOf("Z"), 0s);
  EXPECT_EQ(offsetOf("0h"), 0s);
  EXPECT_EQ(offsetOf("-05:30"), -(5h + 30min));
  EXPECT_EQ(offsetOf("5h45min"), 5h + 45min);
  EXPECT_THAT(errorOf(with("+02:00", "+15:00")), HasSubstr("offset"));
  EXPECT_THAT(errorOf(with("+02:00", "Berlin")), HasSubstr("offset"));
}

TEST(Plan, CapsAHoldAtTheEndOfItsSlot) {
  EXPECT_EQ(parsePlan(kPlan, "week.toml").light_check.max_hold, 10min);
}

TEST(Plan, CountsTheStepsInItsWindows) {
  const Plan plan = parsePlan(kPlan, "week.toml");
  EXPECT_EQ(slotCount(plan), 1008);
  EXPECT_EQ(stepCount(plan), 7 * 8 * 6);
}

TEST(Plan, NamesALightThatTheRigDoesNotHave) {
  const Plan plan = parsePlan(kPlan, "week.toml");
  devices::RigSpec rig;
  rig.name = "bench";
  rig.cameras.emplace_back().id = "cam0";
  rig.lights.emplace_back();
  rig.lights.back().id = "key";
  try {
    checkAgainst(plan, rig);
    FAIL() << "accepted";
  } catch (const devices::ConfigError& error) {
    EXPECT_THAT(error.what(),
                AllOf(HasSubstr("week.toml:9"), HasSubstr("\"fill\""), HasSubstr("it has: key")));
  }
}

TEST(Plan, ReadsSensorsOnAPeriodOnlyWhenItSaysSo) {
  EXPECT_EQ(parsePlan(kPlan, "week.toml").read_sensors_every, std::nullopt);
  const std::string text = std::string(kPlan) + "[sensors]\nevery = ";
  EXPECT_EQ(parsePlan(text + "\"90s\"\n", "week.toml").read_sensors_every, 90s);
  EXPECT_THAT(errorOf(text + "\"100ms\"\n"), AllOf(HasSubstr("every"), HasSubstr("1s")));
  EXPECT_THAT(errorOf(text + "\"1min\"\nwhich = 1\n"), HasSubstr("which"));
}

}  // namespace
}  // namespace patina::capture
