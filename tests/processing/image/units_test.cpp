// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/image/units.h"

#include <gmock/gmock.h>

#include <climits>

#include "processing/image/failure.h"
#include "processing/image/random.h"

namespace patina {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;

template <class Body>
std::string usageErrorOf(const Body& body) {
  try {
    body();
  } catch (const ProcessingError& e) {
    EXPECT_EQ(e.exit(), Exit::kUsage);
    return e.what();
  }
  return "nothing was thrown";
}

TEST(ParseDuration, ReadsEveryUnitAndTheirSums) {
  EXPECT_EQ(parseDuration("50ms"), 50ms);
  EXPECT_EQ(parseDuration("10min"), 10min);
  EXPECT_EQ(parseDuration("36h"), 36h);
  EXPECT_EQ(parseDuration("7d"), 168h);
  EXPECT_EQ(parseDuration("1h30min"), 90min);
  EXPECT_EQ(parseDuration("0.5s"), 500ms);
  EXPECT_EQ(parseDuration("1.5h"), 90min);
  EXPECT_EQ(parseDuration("12us"), 12us);
  EXPECT_EQ(parseDuration("0s"), 0s);
  EXPECT_EQ(parseDuration("0.000000001s"), 1ns);
}

TEST(ParseDuration, RefusesWhatCouldBeMisread) {
  EXPECT_THAT(usageErrorOf([] { parseDuration("10m"); }), HasSubstr("write min or ms"));
  EXPECT_THAT(usageErrorOf([] { parseDuration("10"); }), HasSubstr("unit is missing"));
  EXPECT_THAT(usageErrorOf([] { parseDuration("-5min"); }), HasSubstr("negative"));
  EXPECT_THAT(usageErrorOf([] { parseDuration("30min1h"); }), HasSubstr("largest first"));
  EXPECT_THAT(usageErrorOf([] { parseDuration("1h1h"); }), HasSubstr("at most once"));
  EXPECT_THAT(usageErrorOf([] { parseDuration("0.1ns"); }), HasSubstr("finer"));
  EXPECT_THAT(usageErrorOf([] { parseDuration("110000d"); }), HasSubstr("292 years"));
  EXPECT_THAT(usageErrorOf([] { parseDuration("999999999999999999d"); }), HasSubstr("292 years"));
}

TEST(ParseDuration, RefusesHostileTextAndNamesTheForms) {
  for (const char* text :
       {"", " ", "5 min", "1e999d", "1e3s", "5.s", ".5s", "5..5s", "min", "5mins", "0x10s", "+5s",
        "5s\n", "nan", "infd", "99999999999999999999s", "5s5"}) {
    EXPECT_THAT(usageErrorOf([&] { parseDuration(text); }), HasSubstr("duration '")) << text;
  }
  const std::string long_text(100'000, '9');
  EXPECT_LT(usageErrorOf([&] { parseDuration(long_text); }).size(), 300u);
}

TEST(FormatDuration, GivesTheShortestFormThatReadsBack) {
  EXPECT_EQ(formatDuration(10min), "10min");
  EXPECT_EQ(formatDuration(36h), "36h");
  EXPECT_EQ(formatDuration(168h), "7d");
  EXPECT_EQ(formatDuration(90min), "90min");
  EXPECT_EQ(formatDuration(0ns), "0s");
  EXPECT_EQ(formatDuration(1500ms), "1500ms");
  EXPECT_EQ(formatDuration(24h + 1ns), "1d1ns");
  EXPECT_EQ(formatDuration(-10min), "-10min");
  EXPECT_NO_FATAL_FAILURE(formatDuration(Nanoseconds{INT64_MIN}));
  for (std::uint64_t i = 0; i < 2000; ++i) {
    const auto bits = static_cast<int>(uniformBelow(hashSeed(3, i), 63));
    const Nanoseconds d{static_cast<std::int64_t>(hashSeed(4, i) >> 1 >> bits)};
    EXPECT_EQ(parseDuration(formatDuration(d)), d) << formatDuration(d);
  }
}

TEST(ParseExposure, ReadsFractionsAndDurations) {
  EXPECT_EQ(parseExposure("1/100"), 10ms);
  EXPECT_EQ(parseExposure("1/8000s"), 125us);
  EXPECT_EQ(parseExposure("1/60"), 16'666'667ns);
  EXPECT_EQ(parseExposure("0.5s"), 500ms);
  EXPECT_EQ(parseExposure("20ms"), 20ms);
  for (const char* text : {"", "0s", "1/0", "0/5", "1/", "/100", "1/100ms", "1//2", "-1/100",
                           "1/1e9", "1/100 ", "999999999999999999/1", "1/999999999999999999"}) {
    EXPECT_THAT(usageErrorOf([&] { parseExposure(text); }), HasSubstr("exposure '")) << text;
  }
}

TEST(FormatExposure, WritesWhatCamerasShow) {
  EXPECT_EQ(formatExposure(10ms), "1/100");
  EXPECT_EQ(formatExposure(16'666'667ns), "1/60");
  EXPECT_EQ(formatExposure(500ms), "0.5s");
  EXPECT_EQ(formatExposure(2s), "2s");
  EXPECT_EQ(formatExposure(123'456'789ns), "0.123456789s");
  for (std::uint64_t i = 1; i < 2000; ++i) {
    const Nanoseconds d{static_cast<std::int64_t>(uniformBelow(hashSeed(5, i), 30'000'000'000)) +
                        1};
    EXPECT_EQ(parseExposure(formatExposure(d)), d) << formatExposure(d);
  }
}

TEST(ParseSize, ReadsWidthThenHeight) {
  EXPECT_EQ(parseSize("1024x768"), (SizePx{1024, 768}));
  for (const char* text : {"", "x", "1024", "1024x", "0x5", "5x0", "-1x5", "1.5x2", "10x10x10",
                           "99999999999x1", "10 x 10", "10X10"}) {
    EXPECT_THAT(usageErrorOf([&] { parseSize(text); }), HasSubstr("WIDTHxHEIGHT")) << text;
  }
}

TEST(ParseBytes, ReadsDecimalAndBinaryUnits) {
  EXPECT_EQ(parseBytes("4096"), 4096u);
  EXPECT_EQ(parseBytes("2GB"), 2'000'000'000u);
  EXPECT_EQ(parseBytes("500MiB"), 524'288'000u);
  EXPECT_EQ(parseBytes("1.5 kB"), 1500u);
  for (const char* text : {"", "GB", "1XB", "-1", "1e9", "999999999TB", "5 GBs"}) {
    EXPECT_THAT(usageErrorOf([&] { parseBytes(text); }), HasSubstr("size in bytes")) << text;
  }
}

TEST(FormatBytes, RoundsForPeople) {
  EXPECT_EQ(formatBytes(0), "0 B");
  EXPECT_EQ(formatBytes(999), "999 B");
  EXPECT_EQ(formatBytes(1500), "1.5 kB");
  EXPECT_EQ(formatBytes(999'999), "1.0 MB");
  EXPECT_EQ(formatBytes(1'500'000'000), "1.5 GB");
  EXPECT_EQ(formatBytes(UINT64_MAX), "18 EB");
}

TEST(FromSeconds, RoundsAndRefusesWhatDoesNotFit) {
  EXPECT_EQ(fromSeconds(0.1), 100ms);
  EXPECT_EQ(fromSeconds(-1e-9), -1ns);
  EXPECT_THROW(fromSeconds(1e300), ProcessingError);
  EXPECT_THROW(fromSeconds(std::stod("nan")), ProcessingError);
}

}  // namespace
}  // namespace patina
