// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include "tests/capture/app/rehearsed.h"

namespace patina::testing {
namespace {

TEST(PowerCutRehearsal, GoesOnByItselfAndLosesNothingAcknowledged) {
  const TempFolder folder = TempFolder::inMemory();
  const TempFolder files = TempFolder::inMemory();
  const std::string plan =
      changedPlan(files, {{"\"2h\"", "\"6h\""}, {"[\"ttf\", \"film\"]", "[]"}},
                  "size = \"128x128\"", "size = \"128x128\"\nfaults = \"faults.toml\"");
  writeFile(files / "faults.toml",
            "[[fault]]\nat = \"1h5min\"\ndevice = \"rig\"\nkind = \"power_cut\"\n"
            "duration = \"35min\"\n\n"
            "[[fault]]\nat = \"4h\"\ndevice = \"rig\"\nkind = \"power_cut\"\n"
            "duration = \"1s\"\n");
  const std::string archive = folder / "a", acks = folder / "acks";
  const JsonAnswer answer =
      answerOf(runPatina({"rehearse", plan, "--archive", archive, "--log-acks", acks, "--json"}));
  EXPECT_EQ(answer.text("/items/0/end"), "finished");
  const double captured = answer.number("/items/0/captured");
  const double missed = answer.number("/items/0/missed");
  EXPECT_EQ(captured + missed, 36);
  EXPECT_GE(missed, 3);  // 35 minutes without power at one step in ten
  EXPECT_LE(missed, 6);
  EXPECT_EQ(runPatina({"archive", "verify", "--archive", archive}).exit, 0);
  const std::string log = readFile(acks);
  EXPECT_EQ(std::count(log.begin(), log.end(), '\n'), captured);
  EXPECT_FALSE(std::filesystem::exists(archive + ".power-cut"));
}

}  // namespace
}  // namespace patina::testing
