// SPDX-License-Identifier: GPL-3.0-or-later
#include "db/care/scrub_rounds.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace patina::db::care {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

UtcTime at(std::int64_t t) { return utcFromNs(t); }

TEST(ScrubRounds, NothingCheckedIsAllDue) {
  EXPECT_THAT(ScrubRounds().due(10), ElementsAre(Range{1, 10}));
  EXPECT_THAT(ScrubRounds().due(0), IsEmpty());
}

TEST(ScrubRounds, NeverCheckedComesFirstThenTheOldest) {
  ScrubRounds rounds;
  rounds.checked({1, 3}, at(20));
  rounds.checked({4, 6}, at(10));
  EXPECT_THAT(rounds.due(9), ElementsAre(Range{7, 9}, Range{4, 6}, Range{1, 3}));
  EXPECT_EQ(rounds.oldest(), at(10));
}

TEST(ScrubRounds, ALaterCheckReplacesPartOfAnEarlierOne) {
  ScrubRounds rounds;
  rounds.checked({1, 9}, at(10));
  rounds.checked({4, 5}, at(20));
  EXPECT_THAT(rounds.due(9), ElementsAre(Range{1, 3}, Range{6, 9}, Range{4, 5}));
  rounds.checked({1, 9}, at(30));
  EXPECT_THAT(rounds.due(9), ElementsAre(Range{1, 9}));
}

TEST(ScrubRounds, RangesOfOneSliceJoin) {
  ScrubRounds rounds;
  rounds.checked({1, 2}, at(10));
  rounds.checked({3, 4}, at(10));
  EXPECT_EQ(rounds.text(), "1 4 10\n");
}

TEST(ScrubRounds, ReadBackFromTheirText) {
  ScrubRounds rounds;
  rounds.checked({1, 3}, at(20));
  rounds.checked({7, 9}, at(10));
  EXPECT_EQ(ScrubRounds::parse(rounds.text()).text(), rounds.text());
  EXPECT_THAT(ScrubRounds::parse("5 2 1\nrubbish").due(9), ElementsAre(Range{1, 9}));
  EXPECT_THAT(rounds.unchecked(9), ElementsAre(Range{4, 6}));
}

}  // namespace
}  // namespace patina::db::care
