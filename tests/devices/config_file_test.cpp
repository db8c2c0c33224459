// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/config_file.h"

#include <gmock/gmock.h>

#include <functional>

#include "tests/support/temp_folder.h"

namespace patina::devices {
namespace {

using namespace std::chrono_literals;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Pair;

ConfigTable parse(const std::string& toml) { return ConfigFile::parse(toml, "plan.toml"); }

// The message of the ConfigError that `call` throws, "" when it throws none.
std::string errorOf(const std::function<void()>& call) {
  try {
    call();
  } catch (const ConfigError& error) {
    EXPECT_EQ(error.exit(), Exit::kConfig);
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    return error.what();
  }
  return "";
}

TEST(ConfigFile, GivesEveryTypeBack) {
  ConfigTable table = parse(R"(
name = "banana"
count = 3
gain = 2
flag = true
interval = "10min"
exposure = "1/100"
size = "640x480"
rig = "rigs/twin.toml"
tags = ["a", "b"]
states = [[], ["key"], ["key", "lamp"]]
band = [0.97, 2]
)");
  EXPECT_EQ(table.takeString("name"), "banana");
  EXPECT_EQ(table.takeInteger("count", 1, 9), 3);
  EXPECT_EQ(table.takeNumber("gain", 0, 9), 2.0);
  EXPECT_TRUE(table.takeBool("flag"));
  EXPECT_EQ(table.takeDuration("interval", 50ms, 24h), 10min);
  EXPECT_EQ(table.takeExposure("exposure", 1us, 1min), 10ms);
  EXPECT_EQ(table.takeSize("size", 16, 4096), (SizePx{640, 480}));
  EXPECT_EQ(table.takePath("rig"), "rigs/twin.toml");
  EXPECT_THAT(table.takeStrings("tags"), ElementsAre("a", "b"));
  EXPECT_THAT(table.takeStringLists("states"),
              ElementsAre(ElementsAre(), ElementsAre("key"), ElementsAre("key", "lamp")));
  EXPECT_THAT(table.takeNumbers("band", 2), ElementsAre(0.97, 2));
  EXPECT_NO_THROW(table.finish());
}

TEST(ConfigFile, FallsBackWhereAKeyIsAbsent) {
  ConfigTable table = parse("");
  EXPECT_EQ(table.takeString("name", "x"), "x");
  EXPECT_EQ(table.takeInteger("count", 1, 9, 4), 4);
  EXPECT_EQ(table.takeDuration("interval", 50ms, 24h, 1h), 1h);
  EXPECT_FALSE(table.takeTable("twin").has_value());
  EXPECT_TRUE(table.takeTables("camera").empty());
  EXPECT_FALSE(table.has("faults"));
}

TEST(ConfigFile, NamesFileLineKeyAndRangeOfAnIntervalOfZero) {
  ConfigTable table = parse("# a plan\n\ninterval = \"0s\"\n");
  EXPECT_EQ(errorOf([&] { table.takeDuration("interval", 50ms, 24h * 400); }),
            "plan.toml:3: interval: 0s is out of range (50ms to 400d)");
}

TEST(ConfigFile, NamesWhatIsWantedWhereTheUnitIsMissing) {
  ConfigTable table = parse("interval = 10\nduration = \"10 parsecs\"\n");
  EXPECT_THAT(errorOf([&] { table.takeDuration("interval", 50ms, 1h); }),
              AllOf(HasSubstr("plan.toml:1: interval: is a whole number"), HasSubstr("\"10min\""),
                    HasSubstr("(50ms to 1h)")));
  EXPECT_THAT(errorOf([&] { table.takeDuration("duration", 50ms, 1h); }),
              AllOf(HasSubstr("plan.toml:2: duration: \"10 parsecs\" is not a duration")));
}

TEST(ConfigFile, NamesTheRangeOfNumbers) {
  ConfigTable table = parse("count = 12\ngain = -0.5\nwide = nan\nhuge = inf\nreal = 1.5\n");
  EXPECT_EQ(errorOf([&] { table.takeInteger("count", 1, 9); }),
            "plan.toml:1: count: 12 is out of range (1 to 9)");
  EXPECT_EQ(errorOf([&] { table.takeNumber("gain", 0, 1.5); }),
            "plan.toml:2: gain: -0.5 is out of range (0 to 1.5)");
  EXPECT_THAT(errorOf([&] { table.takeNumber("wide", 0, 1); }), HasSubstr("nan is out of range"));
  EXPECT_THAT(errorOf([&] { table.takeNumber("huge", 0, 1); }), HasSubstr("inf is out of range"));
  EXPECT_EQ(errorOf([&] { table.takeInteger("real", 1, 9); }),
            "plan.toml:5: real: is a decimal number, but must be a whole number (1 to 9)");
}

TEST(ConfigFile, RefusesListsThatHoldNumbersThatAreNone) {
  ConfigTable table = parse("band = [0.9, nan]\nshort = [1]\nmixed = [1, \"a\"]\n");
  EXPECT_THAT(errorOf([&] { table.takeNumbers("band", 2); }), HasSubstr("not finite"));
  EXPECT_THAT(errorOf([&] { table.takeNumbers("short", 2); }), HasSubstr("has 1 numbers"));
  EXPECT_THAT(errorOf([&] { table.takeNumbers("mixed", 2); }), HasSubstr("plan.toml:3: mixed"));
}

TEST(ConfigFile, AnUnknownKeyNamesTheNearestKnownOneAndAll) {
  ConfigTable table = parse("seed = 1\nintervall = \"10min\"\n");
  table.takeInteger("seed", 0, 9);
  table.has("interval");
  EXPECT_EQ(errorOf([&] { table.finish(); }),
            "plan.toml:2: intervall: is no known key; did you mean \"interval\"? (known: seed, "
            "interval)");
}

TEST(ConfigFile, TheFirstUnknownKeyIsTheOneReported) {
  ConfigTable table = parse("zebra = 1\nant = 2\n");
  EXPECT_THAT(errorOf([&] { table.finish(); }), HasSubstr("plan.toml:1: zebra"));
}

TEST(ConfigFile, AMissingKeyIsReportedAtTheLineOfItsTable) {
  ConfigTable table = parse("a = 1\n\n[[sweep]]\nb = 1\n\n[[sweep]]\nb = 2\n");
  auto sweeps = table.takeTables("sweep");
  ASSERT_EQ(sweeps.size(), 2u);
  EXPECT_EQ(sweeps[0].line(), 3);
  EXPECT_EQ(sweeps[1].line("b"), 7);
  EXPECT_EQ(errorOf([&] { sweeps[1].takeString("cameras"); }),
            "plan.toml:6: sweep.cameras: is missing; must be text in quotes");
}

TEST(ConfigFile, ALoneTableCountsAsAListOfOne) {
  ConfigTable table = parse("[patch]\ncamera = \"cam0\"\n");
  auto patches = table.takeTables("patch");
  ASSERT_EQ(patches.size(), 1u);
  EXPECT_EQ(patches[0].takeString("camera"), "cam0");
}

TEST(ConfigFile, ATableWhereAValueShouldBeIsSaidPlainly) {
  ConfigTable table = parse("camera = \"cam0\"\n[name]\nx = 1\n");
  EXPECT_THAT(errorOf([&] { table.takeTables("camera"); }), HasSubstr("must be tables [[camera]]"));
  EXPECT_THAT(errorOf([&] { table.takeString("name"); }),
              HasSubstr("is a table, but must be text"));
  EXPECT_THAT(errorOf([&] { table.takeTable("camera"); }), HasSubstr("must be one table [camera]"));
}

TEST(ConfigFile, IdsAreShortAndMadeForFileNames) {
  for (const std::string id : {"", "Cam", "a+b", "a b", "../x", "a.b", "caf\xc3\xa9",
                               "0123456789012345678901234567890123"}) {
    ConfigTable table = parse("id = \"" + id + "\"\n");
    EXPECT_THAT(errorOf([&] { table.takeId("id"); }), HasSubstr("is no id (1 to 32")) << id;
  }
  ConfigTable table = parse("id = \"cam-0_b\"\n");
  EXPECT_EQ(table.takeId("id"), "cam-0_b");
}

TEST(ConfigFile, AChoiceNamesTheOthers) {
  ConfigTable table = parse("mode = \"controled\"\n");
  EXPECT_EQ(errorOf([&] {
              table.takeChoice("mode", {"controlled", "uncontrolled"});
            }),
            "plan.toml:1: mode: \"controled\" is not one of controlled, uncontrolled; did you mean "
            "\"controlled\"?");
}

TEST(ConfigFile, PathsStartAtTheFilesOwnFolder) {
  ConfigTable table = ConfigFile::parse("a = \"../rig.toml\"\nb = \"/etc/rig.toml\"\nc = \"\"\n",
                                        "/lab/plans/plan.toml");
  EXPECT_EQ(table.takePath("a"), "/lab/rig.toml");
  EXPECT_EQ(table.takePath("b"), "/etc/rig.toml");
  EXPECT_THAT(errorOf([&] { table.takePath("c"); }), HasSubstr("is empty"));
}

TEST(ConfigFile, TheRestOfATableIsText) {
  ConfigTable table = parse("id = \"a\"\nport = 5\ngain = 0.1\nfast = true\nday = 2024-05-01\n");
  table.takeString("id");
  EXPECT_THAT(table.takeRest(), ElementsAre(Pair("day", "2024-05-01"), Pair("fast", "true"),
                                            Pair("gain", "0.1"), Pair("port", "5")));
  EXPECT_NO_THROW(table.finish());
}

TEST(ConfigFile, TextWithANulEscapeIsRefused) {
  ConfigTable table = parse("name = \"a\\u0000b\"\n");
  EXPECT_THAT(errorOf([&] { table.takeString("name"); }), HasSubstr("NUL"));
}

TEST(ConfigFile, WhatIsNoTomlIsReportedWithItsLine) {
  EXPECT_THAT(errorOf([] { parse("a = 1\nb = \n"); }), HasSubstr("plan.toml:2: "));
  EXPECT_THAT(errorOf([] { parse("a = 1\na = 2\n"); }), HasSubstr("plan.toml:2: "));
  EXPECT_THAT(errorOf([] { parse("a = 99999999999999999999999\n"); }), HasSubstr("plan.toml:1: "));
  EXPECT_THAT(errorOf([] { parse("a = \"never closed\n"); }), HasSubstr("plan.toml:1: "));
}

TEST(ConfigFile, KeysWithControlCharactersCannotForgeALine) {
  EXPECT_THAT(errorOf([] { parse("\"a\\nplan.toml:9: b\" = 1\n").finish(); }),
              HasSubstr("a\\x0aplan.toml:9"));
}

TEST(ConfigFile, ReadsAFileAndSaysWhatItCannotRead) {
  const patina::testing::TempFolder folder = patina::testing::TempFolder::inMemory();
  patina::testing::writeFile(folder / "rig.toml", "name = \"twin\"\r\n");
  EXPECT_EQ(ConfigFile::read(folder / "rig.toml").takeString("name"), "twin");
  patina::testing::writeFile(folder / "empty.toml", "");
  EXPECT_NO_THROW(ConfigFile::read(folder / "empty.toml").finish());
  for (const auto& missing : {folder / "none.toml", folder.path()}) {
    try {
      ConfigFile::read(missing);
      ADD_FAILURE() << missing;
    } catch (const Failure& failure) {
      EXPECT_EQ(failure.exit(), Exit::kIo);
      EXPECT_THAT(failure.what(), HasSubstr("cannot be read"));
    }
  }
}

}  // namespace
}  // namespace patina::devices
