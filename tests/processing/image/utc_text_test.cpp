// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include "processing/image/failure.h"
#include "processing/image/random.h"
#include "processing/image/units.h"

namespace patina {
namespace {

TEST(ParseUtc, ReadsTimesDatesAndOffsets) {
  EXPECT_EQ(toNs(parseUtc("1970-01-01T00:00:00Z")), 0);
  EXPECT_EQ(toNs(parseUtc("2024-05-01")), 1'714'521'600'000'000'000);
  EXPECT_EQ(parseUtc("2024-05-01T12:00:00.25Z") - parseUtc("2024-05-01T12:00:00"),
            Nanoseconds{250'000'000});
  EXPECT_EQ(parseUtc("2024-05-01T14:00:00+02:00"), parseUtc("2024-05-01T12:00:00Z"));
  EXPECT_EQ(parseUtc("2024-05-01 12:00"), parseUtc("2024-05-01T12:00:00Z"));
  EXPECT_EQ(toNs(parseUtc("1969-12-31T23:59:59.999999999Z")), -1);
}

TEST(ParseUtc, RefusesDaysThatDoNotExistAndHostileText) {
  for (const char* text : {"", "2024-02-30", "2023-02-29", "2024-13-01", "2024-05-01T24:00:00Z",
                           "2024-05-01T12:60:00Z", "2024-05-01T12:00:60Z", "1600-01-01",
                           "9999-01-01", "2024-05-01T12:00:00.Z", "2024-05-01T12:00:00ZZ",
                           "2024-05-01T12:00:00+99:00", "2024-5-1", "20240501", "yesterday"}) {
    try {
      parseUtc(text);
      ADD_FAILURE() << text;
    } catch (const ProcessingError& e) {
      EXPECT_EQ(e.exit(), Exit::kUsage);
      EXPECT_THAT(e.what(), ::testing::HasSubstr("time '"));
    }
  }
}

TEST(FormatUtc, ReadsBackToTheMillisecond) {
  EXPECT_EQ(formatUtc(parseUtc("2024-05-01T12:00:00Z")), "2024-05-01T12:00:00.000Z");
  EXPECT_EQ(formatUtcCompact(parseUtc("2024-05-01T12:00:00Z")), "20240501T120000Z");
  EXPECT_EQ(formatUtc(utcFromNs(-1)), "1969-12-31T23:59:59.999Z");
  for (std::uint64_t i = 0; i < 500; ++i) {
    const auto ms = static_cast<std::int64_t>(uniformBelow(hashSeed(9, i), 8'000'000'000'000));
    const UtcTime t = utcFromNs(ms * 1'000'000);
    EXPECT_EQ(parseUtc(formatUtc(t)), t);
  }
}

}  // namespace
}  // namespace patina
