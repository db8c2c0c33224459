// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/daemon/run_files.h"

#include <gmock/gmock.h>

#include "tests/capture/app/daemon/bench.h"

namespace patina::daemon {
namespace {

using ::testing::ElementsAre;

TEST(RunFiles, ClaimsWhatItsSweepsNameAndLeavesTheRestOfTheRig) {
  Bench bench;
  writePlan(bench.folder, "other", "cam1", "fill");
  RunFiles files = readRunFiles(bench.folder / "other.toml", 5);
  EXPECT_EQ(files.plan.seed, 5u);
  EXPECT_EQ(files.rig.cameras.size(), 2u);
  keepOnlyPlanned(files);
  EXPECT_THAT(claimsOf(files), ElementsAre("cam1", "fill"));
}

TEST(RunFiles, FaultsOfDevicesThatLeaveGoWithThem) {
  Bench bench;
  const auto rig = bench.folder / "rig.toml";
  testing::writeFile(rig, testing::readFile(rig) + "faults = \"faults.toml\"\n");
  testing::writeFile(bench.folder / "faults.toml",
                     "[[fault]]\nat = \"1h\"\ndevice = \"cam1\"\nkind = \"busy\"\n"
                     "[[fault]]\nat = \"1h\"\ndevice = \"cam0\"\nkind = \"busy\"\n");
  RunFiles files = readRunFiles(bench.folder / "card.toml", {});
  keepOnlyPlanned(files);
  ASSERT_EQ(files.faults.faults.size(), 1u);
  EXPECT_EQ(files.faults.faults[0].device, "cam0");
}

TEST(RunFiles, ABackendThatIsNotBuiltInIsUnavailable) {
  Bench bench;
  RunFiles files = readRunFiles(bench.folder / "card.toml", {});
  files.rig.cameras[0].backend = "telepathy";
  try {
    openRig(files, {"run", bench.clock.utc(), false}, bench.clock);
    FAIL();
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.exit(), Exit::kUnavailable);
  }
}

}  // namespace
}  // namespace patina::daemon
