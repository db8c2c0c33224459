// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/config_rect.h"

#include <gmock/gmock.h>

namespace patina::devices {
namespace {

RectPx rectOf(const std::string& value) {
  ConfigTable table = ConfigFile::parse("place = " + value + "\n", "rig.toml");
  return takeRect(table, "place");
}

TEST(ConfigRect, IsFourWholeNumbers) {
  EXPECT_EQ(rectOf("[0, 8, 640, 1]"), (RectPx{0, 8, 640, 1}));
}

TEST(ConfigRect, RefusesWhatIsNone) {
  for (const char* value : {"[0, 8, 640]", "[0, -8, 640, 480]", "[0, 8, 0, 480]",
                            "[0.5, 8, 640, 480]", "[0, 8, 70000, 480]", "\"0,8,640,480\""})
    EXPECT_THROW(rectOf(value), ConfigError) << value;
}

}  // namespace
}  // namespace patina::devices
