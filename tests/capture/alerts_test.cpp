// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/alerts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

namespace patina::capture {
namespace {

using namespace std::chrono_literals;

TEST(Alerts, TellOnceWhenSomethingBeginsAndOnceWhenItEnds) {
  std::vector<std::string> told;
  Alerts alerts([&](UtcTime, const std::string& detail) { told.push_back(detail); });
  const UtcTime t = parseUtc("2024-05-01");
  alerts.clear("light key", t);
  for (int i = 0; i < 5; ++i) alerts.raise("light key", "dark", t + i * 10min);
  EXPECT_TRUE(alerts.raised("light key"));
  alerts.clear("light key", t + 40min);
  alerts.clear("light key", t + 50min);
  EXPECT_THAT(told,
              ::testing::ElementsAre("light key begins: dark", "light key is over after 40min"));
}

}  // namespace
}  // namespace patina::capture
