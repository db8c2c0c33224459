// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/config_guard.h"

#include <gmock/gmock.h>

#include "devices/config_file.h"
#include "processing/image/random.h"

namespace patina::devices {
namespace {

using ::testing::HasSubstr;

std::string errorOf(const std::string& toml) {
  try {
    ConfigFile::parse(toml, "plan.toml").finish();
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

std::string repeated(const std::string& text, int times) {
  std::string all;
  for (int i = 0; i < times; ++i) all += text;
  return all;
}

TEST(ConfigGuard, RefusesWhatCrashesTheParser) {
  EXPECT_THAT(errorOf("a" + repeated(".a", 20'000) + " = 1\n"), HasSubstr("more than 100 dots"));
  EXPECT_THAT(errorOf("a = " + repeated("[", 20'000)), HasSubstr("deeper than 16"));
  EXPECT_THAT(errorOf("a = " + repeated("{a=", 20'000)), HasSubstr("deeper than 16"));
  EXPECT_THAT(errorOf("[" + repeated("a.", 200) + "a]\n"), HasSubstr("more than 100 dots"));
}

TEST(ConfigGuard, RefusesTheLineThatIsTooDeepAndNamesIt) {
  EXPECT_THAT(errorOf("a = 1\n\nb = " + repeated("[", 17) + repeated("]", 17)),
              HasSubstr("plan.toml:3: nests"));
  EXPECT_EQ(errorOf("# " + repeated("[", 99) + "\n"), "");
}

TEST(ConfigGuard, ATableHeaderWithoutANameIsNamedWithItsLine) {
  for (const char* header : {"[=", "[.a]", "[[[a]]]", "[[\t=", "[\xc3\xa9]", "["}) {
    EXPECT_THAT(errorOf("a = 1\n " + std::string(header) + "\n"),
                HasSubstr("plan.toml:2: is a table header without a name"))
        << header;
  }
  EXPECT_THAT(errorOf("a = [\n[\n1],\n[]]\n[ b ]\n[\"c\"]\n"), HasSubstr("a: is no known key"));
}

TEST(ConfigGuard, RefusesMoreThan64KiBAndTakes64KiB) {
  const std::string comment = "#" + std::string(kConfigBytesMax - 2, 'x') + "\n";
  EXPECT_EQ(errorOf(comment), "");
  EXPECT_THAT(errorOf("\n" + comment), HasSubstr("64 KiB"));
}

TEST(ConfigGuard, BracketsInsideStringsAndCommentsDoNotCount) {
  const std::string many = repeated("[", 40);
  const auto passes = [](const std::string& toml) {
    EXPECT_NO_THROW(guardConfigText(toml, "plan.toml")) << toml;
  };
  passes("a = \"" + many + "\"\n");
  passes("a = '" + many + "\\'\n");
  passes("a = \"\\\"" + many + "\"\n");
  passes("a = \"\"\"\n" + many + "\"\n\"\"\"\n");
  passes("a = '''\n'" + many + "\n'''\n");
  passes("a = 1 # \"" + many + "\n");
}

TEST(ConfigGuard, BracketsBehindAStringCount) {
  for (const std::string text : {"\"x\"", "'x\\'", "\"\"", "\"\"\"x\"\"\"\"\"", "'''x'''''"}) {
    EXPECT_THROW(guardConfigText("a = [" + text + ", " + repeated("[", 17), "plan.toml"),
                 ConfigError)
        << text;
  }
}

TEST(ConfigGuard, RefusesNulBytesAndWhatIsNotUtf8) {
  EXPECT_THAT(errorOf(std::string("a = 1\nb = \0 2\n", 14)), HasSubstr("plan.toml:2: holds a NUL"));
  for (const char* bad :
       {"\xff", "\xc0\x80", "\xed\xa0\x80", "\xf4\x90\x80\x80", "\xe2\x82", "\x80"}) {
    EXPECT_THAT(errorOf("a = 1\n# " + std::string(bad) + "\n"),
                HasSubstr("plan.toml:2: is not UTF-8"));
  }
  EXPECT_EQ(errorOf("# caf\xc3\xa9 \xe2\x82\xac \xf0\x9f\x8d\x8c\n"), "");
}

TEST(ConfigGuard, LettersBeyondAsciiBelongInQuotesAndComments) {
  EXPECT_THAT(errorOf("a = 1\ncaf\xc3\xa9 = 2\n"), HasSubstr("plan.toml:2: has a letter outside"));
  EXPECT_EQ(errorOf("\xef\xbb\xbf# caf\xc3\xa9 \xe2\x82\xac\n"), "");
  ConfigTable table = ConfigFile::parse(
      "a = \"caf\xc3\xa9\" # \xc3\xa9\nb = \"\"\"x \\\n  \xc3\xa9\"\"\"\n", "plan.toml");
  EXPECT_EQ(table.takeString("a"), "caf\xc3\xa9");
  EXPECT_EQ(table.takeString("b"), "x \xc3\xa9");
}

TEST(ConfigGuard, RefusesAClosingBracketThatClosesNothing) {
  EXPECT_THAT(errorOf("a = 1\nb = [}\n"), HasSubstr("plan.toml:2: closes a bracket"));
  EXPECT_THAT(errorOf("a = 1 ]\n"), HasSubstr("plan.toml:1: closes a bracket"));
}

TEST(ConfigGuard, AnyBytesAtAllEndInAConfigErrorOrATable) {
  const std::string alphabet = "[]{}\"'#=.,\\\n ax0e-_+:\r\t\x80\xc3";
  for (std::uint64_t seed = 0; seed < 3000; ++seed) {
    std::string toml;
    for (std::uint64_t i = 0; i < 1 + seed % 120; ++i) {
      toml += alphabet[uniformBelow(hashSeed(seed, i), alphabet.size())];
    }
    EXPECT_NO_THROW(errorOf(toml)) << quoteForMessage(toml);
  }
}

TEST(ConfigGuard, QuotesHostileTextOnOneShortLine) {
  EXPECT_EQ(quoteForMessage("a\nb\x1b[31m"), "a\\x0ab\\x1b[31m");
  EXPECT_EQ(quoteForMessage("caf\xc3\xa9\xff"), "caf\xc3\xa9\\xff");
  EXPECT_LE(quoteForMessage(std::string(5000, 'x')).size(), 64u);
}

TEST(ConfigGuard, TheNearestWordIsNearOrNone) {
  const std::vector<std::string> words{"interval", "seed", "duration"};
  EXPECT_EQ(nearestWord("intervall", words), "interval");
  EXPECT_EQ(nearestWord("sead", words), "seed");
  EXPECT_EQ(nearestWord("windows", words), "");
  EXPECT_EQ(nearestWord(std::string(60'000, 'x'), words), "");
}

}  // namespace
}  // namespace patina::devices
