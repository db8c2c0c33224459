// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/settings.h"

#include <gtest/gtest.h>

#include "devices/config_file.h"

namespace patina::devices {
namespace {

using Values = std::map<std::string, std::string>;

std::string messageOf(const std::function<void()>& call) {
  try {
    call();
  } catch (const ConfigError& e) {
    return e.what();
  }
  return "no error";
}

TEST(Settings, GiveTheValueOrTheFallback) {
  const Values values{{"width", "512"}, {"format", "jpeg"}, {"position_mm", "10,-20,0.5"}};
  Settings s(values, "camera 'cam0'", "rig.toml");
  EXPECT_EQ(s.takeInteger("width", 16, 1000, 64), 512);
  EXPECT_EQ(s.takeInteger("height", 16, 1000, 64), 64);
  EXPECT_EQ(s.takeChoice("format", {"dng", "jpeg"}), "jpeg");
  EXPECT_EQ(s.takePosition("position_mm", {}), (std::array<double, 3>{10, -20, 0.5}));
  EXPECT_EQ(s.takeExposure("exposure_min", Nanoseconds(5)), Nanoseconds(5));
  s.finish();
}

TEST(Settings, ErrorsNameFileDeviceKeyAndWhatIsAllowed) {
  const Values values{{"width", "7"}, {"format", "gif"}, {"depth", "3"}, {"exposure_max", "x"}};
  Settings s(values, "camera 'cam0'", "rig.toml");
  const std::string range = messageOf([&] { s.takeInteger("width", 16, 1000, 64); });
  for (const char* part : {"rig.toml", "cam0", "width", "16 to 1000"})
    EXPECT_NE(range.find(part), std::string::npos) << range;
  EXPECT_NE(messageOf([&] {
              s.takeChoice("format", {"dng", "jpeg"});
            }).find("dng, jpeg"),
            std::string::npos);
  EXPECT_NE(messageOf([&] { s.takeExposure("exposure_max", {}); }), "no error");
  EXPECT_NE(messageOf([&] { s.finish(); }).find("depth"), std::string::npos);
}

TEST(Settings, NumbersWithTailsAndFractionsAreRefused) {
  const Values values{{"width", "512px"}, {"height", "10.5"}, {"position_mm", "1,2"}};
  Settings s(values, "camera 'cam0'", "rig.toml");
  EXPECT_THROW(s.takeInteger("width", 16, 1000, 64), ConfigError);
  EXPECT_THROW(s.takeInteger("height", 1, 1000, 64), ConfigError);
  EXPECT_THROW(s.takePosition("position_mm", {}), ConfigError);
}

TEST(Settings, TextIsTakenAsItStands) {
  const Values values{{"on", " REL1\\n "}};
  Settings s(values, "light 'key'", "rig.toml");
  EXPECT_EQ(s.takeText("on", ""), " REL1\\n ");
  EXPECT_EQ(s.takeText("off", "x"), "x");
  s.finish();
}

TEST(Settings, DurationsHaveAUnitAndARange) {
  using namespace std::chrono_literals;
  const Values values{{"pulse", "20ms"}, {"half", "9s"}, {"boot", "3"}};
  Settings s(values, "trigger 'line'", "rig.toml");
  EXPECT_EQ(s.takeDuration("pulse", 1ms, 5s, 1s), 20ms);
  EXPECT_EQ(s.takeDuration("timeout", 1ms, 5s, 1s), 1s);
  EXPECT_NE(messageOf([&] { s.takeDuration("half", 0s, 5s, 0s); }).find("9s is out of range (0"),
            std::string::npos);
  EXPECT_NE(messageOf([&] { s.takeDuration("boot", 0s, 5s, 0s); }), "no error");
}

}  // namespace
}  // namespace patina::devices
