// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/windows.h"

#include <gtest/gtest.h>

namespace patina::capture {
namespace {

using namespace std::chrono_literals;

TEST(Windows, AreHalfOpenAndMayCrossMidnight) {
  Plan plan;
  plan.windows = {{22h, 6h}, {12h, 13h}};
  const UtcTime day = parseUtc("2024-05-01");
  EXPECT_TRUE(insideWindows(plan, day));
  EXPECT_TRUE(insideWindows(plan, day + 22h));
  EXPECT_FALSE(insideWindows(plan, day + 6h));
  EXPECT_TRUE(insideWindows(plan, day + 12h + 59min));
  EXPECT_FALSE(insideWindows(plan, day + 13h));
}

TEST(Windows, NameTheirNextOpening) {
  Plan plan;
  plan.utc_offset = -2h;
  plan.windows = {{8h, 9h}, {20h, 21h}};
  const UtcTime day = parseUtc("2024-05-01");
  EXPECT_EQ(nextOpening(plan, day + 11h), day + 22h);
  EXPECT_EQ(nextOpening(plan, day + 23h + 30min), day + 24h + 10h);
  EXPECT_FALSE(nextOpening(plan, day + 10h + 30min).has_value());
}

TEST(Windows, AreAlwaysOpenWhenThereAreNone) { EXPECT_TRUE(insideWindows(Plan{}, UtcTime{} - 5h)); }

}  // namespace
}  // namespace patina::capture
