// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/fault_plan.h"

#include <gmock/gmock.h>

#include "devices/config_file.h"
#include "devices/rig.h"
#include "tests/support/places.h"
#include "tests/support/temp_folder.h"

namespace patina::devices {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;

constexpr const char* kFaults = R"(seed = 42
[[fault]]
at = "3d2h"
device = "cam0"
kind = "hang"
duration = "40s"
[[fault]]
at = "1h30min"
device = "key"
kind = "lamp_drift"
amount = -0.05
[[fault]]
at = "0s"
device = "lux0"
kind = "sensor_silent"
)";

constexpr const char* kRig = R"(
camera = [{ id = "cam0", backend = "twin" }]
light = [{ id = "key", backend = "twin" }]
sensor = [{ id = "lux0", backend = "twin", quantity = "illuminance" }]
)";

std::string errorOf(const std::string& toml) {
  try {
    checkAgainst(parseFaults(toml, "faults.toml"), parseRig(kRig, "rig.toml"));
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

std::string fault(const std::string& device, const std::string& kind, const std::string& rest) {
  return "[[fault]]\nat = \"1h\"\ndevice = \"" + device + "\"\nkind = \"" + kind + "\"\n" + rest;
}

TEST(FaultPlan, GivesBackWhatItsFileSays) {
  const FaultPlan plan = parseFaults(kFaults, "faults.toml");
  EXPECT_EQ(plan.seed, 42u);
  ASSERT_EQ(plan.faults.size(), 3u);
  EXPECT_EQ(plan.faults[0].at, 74h);
  EXPECT_EQ(plan.faults[0].device, "cam0");
  EXPECT_EQ(plan.faults[0].kind, FaultKind::kHang);
  EXPECT_EQ(plan.faults[0].duration, 40s);
  EXPECT_EQ(plan.faults[0].line, 2);
  EXPECT_EQ(plan.faults[1].at, 90min);
  EXPECT_EQ(plan.faults[1].amount, -0.05);
  EXPECT_EQ(plan.faults[2].duration, 0s);
  EXPECT_EQ(errorOf(kFaults), "");
}

TEST(FaultPlan, ALampFaultWithoutDurationLastsForEver) {
  EXPECT_EQ(parseFaults(kFaults, "faults.toml").faults[1].duration, kFaultForEver);
}

TEST(FaultPlan, ReadsTheFileItIsGiven) {
  const auto folder = patina::testing::TempFolder::inMemory();
  patina::testing::writeFile(folder / "faults.toml", kFaults);
  EXPECT_EQ(readFaults(folder / "faults.toml").source, folder / "faults.toml");
}

TEST(FaultPlan, EveryKindHasANameThatParses) {
  for (int i = 0; i <= static_cast<int>(FaultKind::kPowerCut); ++i) {
    const auto kind = static_cast<FaultKind>(i);
    EXPECT_EQ(parseFaultKind(name(kind)), kind) << i;
  }
  EXPECT_THROW(parseFaultKind("gremlin"), Failure);
}

TEST(FaultPlan, ErrorsNameLineKeyAndWhatIsAllowed) {
  EXPECT_THAT(errorOf(fault("cam0", "hangs", "")),
              HasSubstr("faults.toml:4: fault.kind: \"hangs\" is not one of hang, busy"));
  EXPECT_THAT(errorOf(fault("cam0", "hang", "duration = \"-1s\"\n")),
              HasSubstr("faults.toml:5: fault.duration"));
  EXPECT_THAT(errorOf(fault("key", "lamp_step", "amount = -2\n")),
              HasSubstr("fault.amount: -2 is out of range (-1 to 10)"));
  EXPECT_THAT(errorOf(fault("key", "lamp_step", "")), HasSubstr("fault.amount: is missing"));
  EXPECT_THAT(errorOf(fault("cam0", "busy", "amount = 1\n")), HasSubstr("amount: is no known key"));
  EXPECT_THAT(errorOf("faults = 3\n"), HasSubstr("did you mean \"fault\"?"));
}

TEST(FaultPlan, AFaultMustFitADeviceOfTheRig) {
  EXPECT_EQ(errorOf("\n" + fault("cam1", "hang", "")),
            "faults.toml:2: fault.device: \"cam1\" is no camera, light or sensor of the rig; did "
            "you mean \"cam0\"?");
  EXPECT_THAT(errorOf(fault("key", "stale_frame", "")),
              HasSubstr("stale_frame cannot happen to 'key'"));
  EXPECT_THAT(errorOf(fault("cam0", "lamp_dead", "")), HasSubstr("lamp_dead cannot happen"));
  EXPECT_THAT(errorOf(fault("cam0", "sensor_silent", "")), HasSubstr("cannot happen to 'cam0'"));
  EXPECT_EQ(errorOf(fault("key", "lost", "") + fault("lux0", "hang", "")), "");
}

TEST(FaultPlan, APowerCutHappensToTheWholeRigAndNothingElseDoes) {
  EXPECT_EQ(errorOf(fault("rig", "power_cut", "duration = \"70min\"\n")), "");
  EXPECT_THAT(errorOf(fault("cam0", "power_cut", "")), HasSubstr("device = \"rig\""));
  EXPECT_THAT(errorOf(fault("rig", "hang", "")), HasSubstr("whole rig"));
}

TEST(FaultPlan, TheShippedExamplesFitTheirRigs) {
  int rigs = 0, plans = 0;
  const auto examples = patina::testing::sourceFolder() / "examples";
  for (const auto& entry : std::filesystem::recursive_directory_iterator(examples)) {
    if (entry.path().filename() != "rig.toml") continue;
    const RigSpec rig = readRig(entry.path());
    ++rigs;
    if (!rig.twin || !rig.twin->faults) continue;
    EXPECT_NO_THROW(checkAgainst(readFaults(*rig.twin->faults), rig)) << entry.path();
    ++plans;
  }
  EXPECT_GT(rigs, 0);
  EXPECT_GT(plans, 0);
}

}  // namespace
}  // namespace patina::devices
