// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/picture_times.h"

#include <gmock/gmock.h>

#include <algorithm>

namespace patina::workflow {
namespace {

using namespace std::chrono_literals;

TEST(NaturalOrder, ComparesRunsOfDigitsAsNumbers) {
  std::vector<std::string> names = {"a10.png", "a9.png", "a1.png", "a02.png", "b1.png", "a.png"};
  std::sort(names.begin(), names.end(),
            [](const std::string& a, const std::string& b) { return naturalLess(a, b); });
  EXPECT_THAT(names,
              ::testing::ElementsAre("a.png", "a1.png", "a02.png", "a9.png", "a10.png", "b1.png"));
}

TEST(NaturalOrder, IsStrictForNumbersLongerThanAnyInteger) {
  const std::string nines(60, '9'), one = "1" + std::string(60, '0');
  EXPECT_TRUE(naturalLess(nines, one));
  EXPECT_FALSE(naturalLess(one, nines));
  EXPECT_FALSE(naturalLess(one, one));
}

struct NamedTime {
  const char* name;
  const char* utc;
};
class TimeFromName : public ::testing::TestWithParam<NamedTime> {};

TEST_P(TimeFromName, IsFound) {
  const auto time = timeFromName(GetParam().name, parseUtc("2020-01-01T00:00:00Z"));
  ASSERT_TRUE(time) << GetParam().name;
  EXPECT_EQ(formatUtc(*time), formatUtc(parseUtc(GetParam().utc))) << GetParam().name;
}

INSTANTIATE_TEST_SUITE_P(
    CustomaryForms, TimeFromName,
    ::testing::Values(NamedTime{"2023-05-17", "2023-05-17T00:00:00Z"},
                      NamedTime{"20230517", "2023-05-17T00:00:00Z"},
                      NamedTime{"2023_05_17_12-30", "2023-05-17T12:30:00Z"},
                      NamedTime{"2019-10-22-11-05", "2019-10-22T11:05:00Z"},
                      NamedTime{"IMG_20230517_123015", "2023-05-17T12:30:15Z"},
                      NamedTime{"PXL_20230517_123015123", "2023-05-17T12:30:15.123Z"},
                      NamedTime{"20230517T123015Z", "2023-05-17T12:30:15Z"},
                      NamedTime{"20230517123015", "2023-05-17T12:30:15Z"},
                      NamedTime{"2023-05-17 12.30.15", "2023-05-17T12:30:15Z"},
                      NamedTime{"cam2_2023-05-17T12:30:15", "2023-05-17T12:30:15Z"},
                      NamedTime{"frame_1684326615", "2023-05-17T12:30:15Z"},
                      NamedTime{"1684326615123", "2023-05-17T12:30:15.123Z"},
                      NamedTime{"leaf day 3", "2020-01-04T00:00:00Z"},
                      NamedTime{"Day_03", "2020-01-04T00:00:00Z"},
                      NamedTime{"hour12", "2020-01-01T12:00:00Z"}));

TEST(TimeFromNameOf, NothingThatIsNoTime) {
  for (const char* name : {"frame_0012", "IMG_1234", "2023-13-45", "99999999", "holiday", "", "5",
                           "day 999999", "9681684326615"})
    EXPECT_FALSE(timeFromName(name)) << name;
}

std::vector<UtcTime> times(const std::vector<Nanoseconds>& since) {
  std::vector<UtcTime> all;
  for (const Nanoseconds one : since) all.push_back(UtcTime{} + one);
  return all;
}

TEST(Rhythm, LeavesAPlaceForEveryMissingPicture) {
  const Rhythm rhythm = findRhythm(times({0h, 24h, 48h, 96h, 120h}));
  EXPECT_TRUE(rhythm.regular);
  EXPECT_EQ(rhythm.interval, 24h);
  EXPECT_THAT(rhythm.numbers, ::testing::ElementsAre(0, 1, 2, 4, 5));
}

TEST(Rhythm, DoesNotRunOutOfStepWithASlowClock) {
  std::vector<Nanoseconds> since;
  for (int k = 0; k < 1000; ++k) since.push_back(k * 604s);  // 10 min by a clock 0.7 % slow
  const Rhythm rhythm = findRhythm(times(since));
  EXPECT_TRUE(rhythm.regular);
  EXPECT_EQ(rhythm.numbers.back(), 999);
}

TEST(Rhythm, TakesAPictureBetweenTwoStepsAsAnExtraOne) {
  std::vector<Nanoseconds> since;
  for (int k = 0; k < 40; ++k) since.push_back(k * 10min);
  since.insert(since.begin() + 7, 6 * 10min + 2min);
  const Rhythm rhythm = findRhythm(times(since));
  EXPECT_TRUE(rhythm.regular);
  EXPECT_EQ(rhythm.numbers[7], std::nullopt);
  EXPECT_EQ(rhythm.numbers[8], 7);
}

TEST(Rhythm, CallsTimesWithoutACommonDistanceIrregular) {
  const Rhythm rhythm = findRhythm(times({0min, 7min, 31min, 40min, 97min, 111min}));
  EXPECT_FALSE(rhythm.regular);
  EXPECT_THAT(rhythm.numbers, ::testing::ElementsAre(0, 1, 2, 3, 4, 5));
}

TEST(Rhythm, OfOneOrEqualTimesIsNone) {
  EXPECT_FALSE(findRhythm(times({5h})).regular);
  EXPECT_FALSE(findRhythm(times({5h, 5h, 5h})).regular);
  EXPECT_TRUE(findRhythm({}).numbers.empty());
}

}  // namespace
}  // namespace patina::workflow
