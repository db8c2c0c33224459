// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include "tests/capture/app/rehearsed.h"

namespace patina::testing {
namespace {

using ::testing::HasSubstr;

class ArchiveReport : public Rehearsed {};

TEST_F(ArchiveReport, WritesPagesThatShowThePicturesOfTheirFolder) {
  std::filesystem::create_directories(place("report"));
  ASSERT_EQ(patina({"light", "report", "latest", "--out", place("report/light.png")}).exit, 0);
  const JsonAnswer report = answer({"archive", "report", "latest", "--out", place("report")});
  EXPECT_EQ(report.number("/items/0/captured"), 12);
  EXPECT_THAT(readFile(place("report/report.html")), HasSubstr("light.png"));
  EXPECT_THAT(readFile(place("report/report.md")), HasSubstr("light.png"));
}

TEST_F(ArchiveReport, WithoutAPlaceIsPrinted) {
  EXPECT_THAT(patina({"archive", "report"}).out, HasSubstr("20240501T120000Z-copper"));
}

}  // namespace
}  // namespace patina::testing
