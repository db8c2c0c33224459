// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/image/failure.h"

#include <gtest/gtest.h>

namespace patina {
namespace {

TEST(Failure, CarriesItsExitCodeAndItsLine) {
  const ProcessingError error(Exit::kBadData, "a.jpg: truncated");
  EXPECT_EQ(error.exit(), Exit::kBadData);
  EXPECT_STREQ(error.what(), "a.jpg: truncated");
}

TEST(FailureDeathTest, CheckAbortsWithItsConditionAndPlace) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  const int width = 0;
  EXPECT_DEATH(PATINA_CHECK(width > 0), "width > 0 is false at .*failure_test.cpp");
}

}  // namespace
}  // namespace patina
