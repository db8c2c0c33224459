// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include "tests/capture/app/rehearsed.h"

namespace patina::testing {
namespace {

using ::testing::HasSubstr;

TEST(RunSession, LogsEveryAcknowledgedFrame) {
  const TempFolder folder = TempFolder::inMemory();
  const std::string log = folder / "acks";
  answerOf(runPatina({"rehearse", quickPlan(), "--archive", folder / "a", "--log-acks", log}));
  const std::string lines = readFile(log);
  EXPECT_EQ(std::count(lines.begin(), lines.end(), '\n'), 12);
  EXPECT_THAT(lines, ::testing::StartsWith("ack 20240501T120000Z-copper "));
}

TEST(RunSession, TheSeedOfTheCommandLineReplacesThePlans) {
  const TempFolder folder = TempFolder::inMemory();
  const auto log = [&](const std::string& archive, const std::string& seed) {
    return answerOf(runPatina({"rehearse", quickPlan(), "--archive", folder / archive, "--seed",
                               seed, "--json"}))
        .text("/items/0/event_log_sha256");
  };
  EXPECT_NE(log("one", "1"), log("two", "2"));
}

TEST(RunSession, AFaultOfADeviceThatIsNotThereIsAConfigurationError) {
  const TempFolder folder = TempFolder::inMemory();
  const std::string plan =
      changedPlan(folder, {}, "size = \"128x128\"", "size = \"128x128\"\nfaults = \"faults.toml\"");
  writeFile(folder / "faults.toml",
            "[[fault]]\nat = \"1h\"\ndevice = \"cam7\"\nkind = \"hang\"\nduration = \"1min\"\n");
  const Finished finished = runPatina({"rehearse", plan, "--archive", folder / "a"});
  EXPECT_EQ(finished.exit, 78);
  EXPECT_THAT(finished.err, HasSubstr("cam7"));
}

TEST(RunSession, ALogThatCannotBeWrittenIsSaidBeforeTheFirstFrame) {
  const TempFolder folder = TempFolder::inMemory();
  EXPECT_EQ(runPatina({"rehearse", quickPlan(), "--archive", folder / "a", "--log-acks",
                       folder / "no/such/folder"})
                .exit,
            73);
}

}  // namespace
}  // namespace patina::testing
