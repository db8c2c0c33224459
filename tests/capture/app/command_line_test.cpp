// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include "tests/support/child.h"

namespace patina::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

TEST(CommandLine, UnknownVerbIsAUsageError) {
  const Finished finished = runPatina({"wither"});
  EXPECT_EQ(finished.exit, 64);
  EXPECT_EQ(finished.out, "");
  EXPECT_THAT(finished.err, StartsWith("patina: "));
}

TEST(CommandLine, VerbsOfLaterIssuesAreNotThere) {
  EXPECT_EQ(runPatina({"brdf", "fit"}).exit, 64);
  EXPECT_EQ(runPatina({"stbrdf", "fit"}).exit, 64);
}

TEST(CommandLine, NoVerbIsAUsageErrorThatPointsToTheHelp) {
  const Finished finished = runPatina({});
  EXPECT_EQ(finished.exit, 64);
  EXPECT_THAT(finished.err, HasSubstr("--help"));
}

TEST(CommandLine, UnknownOptionNamesItself) {
  const Finished finished = runPatina({"plan", "check", "x.toml", "--wilt"});
  EXPECT_EQ(finished.exit, 64);
  EXPECT_THAT(finished.err, HasSubstr("--wilt"));
  EXPECT_THAT(finished.err, HasSubstr("patina plan check --help"));
}

TEST(CommandLine, OptionOutOfRangeIsAUsageError) {
  EXPECT_EQ(runPatina({"plan", "check", "x.toml", "--threads", "0"}).exit, 64);
  EXPECT_EQ(runPatina({"plan", "check", "x.toml", "--seed", "minus one"}).exit, 64);
}

TEST(CommandLine, HelpOfAVerbHasAnExampleAndTheCommonOptions) {
  const Finished finished = runPatina({"plan", "check", "--help"});
  EXPECT_EQ(finished.exit, 0);
  EXPECT_THAT(finished.out, HasSubstr("Example:\n  patina plan check"));
  for (const char* option : {"--json", "--quiet", "--verbose", "--threads", "--seed", "--archive"})
    EXPECT_THAT(finished.out, HasSubstr(option));
}

TEST(CommandLine, VersionIsOneLine) {
  const Finished finished = runPatina({"--version"});
  EXPECT_EQ(finished.exit, 0);
  EXPECT_THAT(finished.out, ::testing::MatchesRegex("patina [0-9]+\\.[0-9]+\\.[0-9]+\n"));
}

}  // namespace
}  // namespace patina::testing
