// SPDX-License-Identifier: GPL-3.0-or-later
#include "db/journal_lines.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace patina::db {
namespace {

using ::testing::HasSubstr;

TEST(JournalLines, TheChecksumIsThatOfZlib) {
  EXPECT_EQ(crc32(""), 0u);
  EXPECT_EQ(crc32("123456789"), 0xcbf43926u);
  EXPECT_EQ(crc32("The quick brown fox jumps over the lazy dog"), 0x414fa339u);
}

TEST(JournalLines, ARowIsOneObjectWhoseLastLineCommits) {
  JournalLines lines;
  EventRow event{7, "run", utcFromNs(5), "alarm", "a \"b\" \\ \n \x01"};
  lines.add(event);
  event.id = 8;
  event.run_id.clear();
  lines.add(event);
  const std::string text = lines.finish();
  const auto first = text.substr(0, text.find('\n'));
  const auto second = text.substr(text.find('\n') + 1);
  EXPECT_THAT(first, ::testing::StartsWith(
                         R"({"row":"event","id":7,"run_id":"run","utc_ns":5,"kind":"alarm",)"
                         R"("detail":"a \"b\" \\ \n \u0001","crc32":")"));
  EXPECT_THAT(second, HasSubstr(R"("run_id":null)"));
  EXPECT_THAT(second, HasSubstr(R"(,"commit":true,"crc32":")"));
}

TEST(JournalLines, NumbersAreWrittenSoThatTheyReadBackTheSame) {
  JournalLines lines;
  LightCheckRow check;
  check.level = 0.1;
  check.baseline = 1.0 / 3;
  check.ratio = std::nan("");
  check.gain = HUGE_VAL;
  lines.add(check);
  EXPECT_THAT(lines.finish(),
              HasSubstr(R"("level":0.1,"baseline":0.3333333333333333,"ratio":null,"gain":"inf")"));
}

TEST(JournalLines, BytesThatAreNoUtf8BecomeTheReplacementCharacter) {
  std::string copy;
  for (const char* fine : {"", "plain", "\xC3\xA4", "\xE2\x82\xAC", "\xF0\x9F\x8D\x8C"})
    EXPECT_EQ(validText(fine, copy), fine);
  const std::string bad = "\xEF\xBF\xBD";
  EXPECT_EQ(validText("a\xFFz", copy), "a" + bad + "z");
  EXPECT_EQ(validText("\xC0\xAF", copy), bad + bad) << "overlong";
  EXPECT_EQ(validText("\xED\xA0\x80", copy), bad + bad + bad) << "surrogate";
  EXPECT_EQ(validText("end\xE2\x82", copy), "end" + bad + bad) << "cut off";
}

}  // namespace
}  // namespace patina::db
