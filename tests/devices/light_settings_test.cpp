// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/light_settings.h"

#include <gmock/gmock.h>

#include <limits>

#include "devices/config_file.h"
#include "tests/support/matchers.h"

namespace patina::devices {
namespace {

using namespace std::chrono_literals;
using patina::testing::Fails;
using patina::testing::IsOk;

LightCaps capsOf(const std::map<std::string, std::string>& values) {
  Settings settings(values, "light 'key'", "rig.toml");
  LightCaps caps = takeLightCaps(settings, "key");
  settings.finish();
  return caps;
}

TEST(LightSettings, ALampIsAnLedThatConfirmsNothingUnlessToldOtherwise) {
  const LightCaps caps = capsOf({});
  EXPECT_EQ(caps.id, "key");
  EXPECT_FALSE(caps.incandescent);
  EXPECT_FALSE(caps.confirms);
  EXPECT_EQ(caps.warm_up, 0ns);
}

TEST(LightSettings, ABulbRipplesWithItsMainsAndWarmsUp) {
  const LightCaps caps =
      capsOf({{"kind", "incandescent"}, {"mains_hz", "60"}, {"warm_up", "25min"}});
  EXPECT_TRUE(caps.incandescent);
  EXPECT_EQ(caps.mains_hz, 60);
  EXPECT_EQ(caps.warm_up, 25min);
  EXPECT_THROW(capsOf({{"kind", "candle"}}), ConfigError);
}

TEST(LightSettings, ALevelLiesFromNothingToFull) {
  EXPECT_THAT(checkLevel(0, "x"), IsOk());
  EXPECT_THAT(checkLevel(1, "x"), IsOk());
  for (const double level : {-0.01, 1.01, std::numeric_limits<double>::quiet_NaN()})
    EXPECT_THAT(checkLevel(level, "x"), Fails(Errc::kRefused));
}

}  // namespace
}  // namespace patina::devices
