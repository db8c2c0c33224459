// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/serial/line_output.h"

#include <gmock/gmock.h>

#include "devices/config_file.h"
#include "tests/devices/serial/fake_port.h"
#include "tests/support/matchers.h"

namespace patina::devices::serial {
namespace {

using patina::testing::FakePort;
using patina::testing::IsOk;
using ::testing::ElementsAre;

using Values = std::map<std::string, std::string>;

TEST(LineOutput, ActiveLowIsAssertedAtRest) {
  VirtualClock clock(utcFromNs(0));
  FakePort port(clock);
  port.is_open = true;
  const Values values{{"line", "dtr"}, {"active", "low"}};
  Settings settings(values, "light 'key'", "rig.toml");
  const auto line = takeLine(settings, "line");
  ASSERT_TRUE(line);
  ASSERT_THAT(line->drive(port, false), IsOk());
  ASSERT_THAT(line->drive(port, true), IsOk());
  EXPECT_THAT(port.did, ElementsAre("dtr 1 0", "dtr 0 0"));
}

TEST(LineOutput, IsNoneWithoutItsKeyAndRefusesOtherLines) {
  const Values none, cts{{"line", "cts"}};
  Settings empty(none, "light 'key'", "rig.toml");
  EXPECT_EQ(takeLine(empty, "line"), std::nullopt);
  Settings wrong(cts, "light 'key'", "rig.toml");
  EXPECT_THROW(takeLine(wrong, "line"), ConfigError);
}

TEST(TakeBytes, ResolvesEscapesAndRefusesUnknownOnes) {
  const Values values{{"on", "A\\n"}, {"off", "\\z"}};
  Settings settings(values, "light 'key'", "rig.toml");
  EXPECT_EQ(takeBytes(settings, "on"), "A\n");
  EXPECT_EQ(takeBytes(settings, "ask"), "");
  EXPECT_THROW(takeBytes(settings, "off"), ConfigError);
}

}  // namespace
}  // namespace patina::devices::serial
