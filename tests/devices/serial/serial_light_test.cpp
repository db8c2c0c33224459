// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include "devices/config_file.h"
#include "devices/serial/serial.h"
#include "tests/devices/serial/fake_port.h"
#include "tests/devices/serial/pty.h"
#include "tests/support/matchers.h"

namespace patina::devices::serial {
namespace {

using namespace std::chrono_literals;
using patina::testing::Fails;
using patina::testing::FakePort;
using patina::testing::IsOk;
using patina::testing::Pty;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

using Values = std::map<std::string, std::string>;

LightSpec lamp(Values settings, const std::string& address = "/dev/fake") {
  LightSpec spec;
  spec.id = "key";
  spec.backend = "serial";
  spec.address = address;
  spec.settings = std::move(settings);
  return spec;
}

class SerialLight : public ::testing::Test {
 protected:
  std::unique_ptr<Light> make(Values settings) {
    return makeLightOn(port_, lamp(std::move(settings)), "rig.toml", clock_);
  }
  std::string refusalOf(Values settings) {
    try {
      make(std::move(settings));
    } catch (const ConfigError& e) {
      return e.what();
    }
    return "no error";
  }
  VirtualClock clock_{utcFromNs(0)};
  std::shared_ptr<FakePort> port_ = std::make_shared<FakePort>(clock_);
};

TEST_F(SerialLight, SendsItsCommandsAndOffWhenItGoes) {
  auto light = make({{"on", "L1\\n"}, {"off", "L0\\n"}});
  EXPECT_THAT(light->set(1), Fails(Errc::kLost));  // not recovered
  ASSERT_THAT(light->recover(), IsOk());
  ASSERT_THAT(light->set(1), IsOk());
  EXPECT_EQ(*light->isOn(), std::nullopt);
  light.reset();
  EXPECT_THAT(port_->did, ElementsAre("send L0\n", "send L1\n", "send L0\n"));
}

TEST_F(SerialLight, PutsTheLevelIntoTheCommand) {
  const auto light = make({{"on", "DIM {level}\\n"}, {"off", "DIM 0\\n"}, {"levels", "255"}});
  ASSERT_THAT(light->recover(), IsOk());
  ASSERT_THAT(light->set(1), IsOk());
  ASSERT_THAT(light->set(0.5), IsOk());
  ASSERT_THAT(light->set(0.0001), IsOk());
  EXPECT_THAT(port_->did,
              ElementsAre("send DIM 0\n", "send DIM 255\n", "send DIM 128\n", "send DIM 1\n"));
}

TEST_F(SerialLight, AControlLineFollowsAndFallsWhenItGoes) {
  auto light = make({{"line", "rts"}});
  ASSERT_THAT(light->recover(), IsOk());
  ASSERT_THAT(light->set(1), IsOk());
  EXPECT_FALSE(light->caps().confirms);
  EXPECT_EQ(*light->isOn(), std::nullopt);
  light.reset();
  EXPECT_THAT(port_->did, ElementsAre("rts 0 0", "rts 1 0", "rts 0 0"));
}

TEST_F(SerialLight, ConfirmsByTheReplyToItsCommand) {
  const auto light = make({{"on", "1"}, {"off", "0"}, {"on_reply", "ON"}, {"off_reply", "OFF"}});
  EXPECT_TRUE(light->caps().confirms);
  port_->lines = {"OFF", "ON", "ERROR 5"};
  ASSERT_THAT(light->recover(), IsOk());
  EXPECT_EQ(*light->isOn(), std::optional<bool>(false));
  ASSERT_THAT(light->set(1), IsOk());
  EXPECT_EQ(*light->isOn(), std::optional<bool>(true));
  const auto wrong = light->set(0);
  ASSERT_THAT(wrong, Fails(Errc::kCorrupt));
  EXPECT_THAT(wrong.error().what, HasSubstr("it says 'ERROR 5' instead of 'OFF'"));
  EXPECT_THAT(light->set(0), Fails(Errc::kTimeout));
}

TEST_F(SerialLight, AsksForItsStateWhenItCan) {
  const auto light =
      make({{"on", "1"}, {"off", "0"}, {"ask", "?"}, {"ask_on", "ON"}, {"ask_off", "OFF"}});
  EXPECT_TRUE(light->caps().confirms);
  ASSERT_THAT(light->recover(), IsOk());
  port_->lines = {"is OFF", "is ON", "eh"};
  EXPECT_EQ(*light->isOn(), std::optional<bool>(false));
  EXPECT_EQ(*light->isOn(), std::optional<bool>(true));
  EXPECT_THAT(light->isOn(), Fails(Errc::kCorrupt));
}

TEST_F(SerialLight, RefusesSettingsThatDoNotBelongTogether) {
  EXPECT_THAT(refusalOf({}), HasSubstr("give on and off, or line"));
  EXPECT_THAT(refusalOf({{"on", "1"}}), HasSubstr("give on and off"));
  EXPECT_THAT(refusalOf({{"on", "1"}, {"off", "0"}, {"line", "rts"}}), HasSubstr("or line"));
  EXPECT_THAT(refusalOf({{"on", "1"}, {"off", "0"}, {"on_reply", "x"}}),
              HasSubstr("belong together"));
  EXPECT_THAT(refusalOf({{"on", "1"}, {"off", "0"}, {"ask", "?"}}),
              HasSubstr("ask_on and ask_off"));
  EXPECT_THAT(refusalOf({{"on", "1"}, {"off", "0"}, {"colour", "red"}}),
              HasSubstr("unknown; there are"));
}

TEST(SerialLightOnAPort, TalksToABoardAndNoticesWhenItIsUnplugged) {
  bool lit = false;
  Pty board([&lit](const std::string& line) -> std::string {
    if (line == "?") return lit ? "1\n" : "0\n";
    lit = line == "ON";
    return "";
  });
  RealClock clock;
  const auto light = makeLight(lamp({{"on", "ON\\n"},
                                     {"off", "OFF\\n"},
                                     {"ask", "?\\n"},
                                     {"ask_on", "1"},
                                     {"ask_off", "0"},
                                     {"timeout", "10s"}},
                                    board.path()),
                               "rig.toml", clock);
  ASSERT_THAT(light->recover(), IsOk());
  ASSERT_THAT(light->set(1), IsOk());
  EXPECT_EQ(*light->isOn(), std::optional<bool>(true));
  ASSERT_THAT(light->set(0), IsOk());
  EXPECT_EQ(*light->isOn(), std::optional<bool>(false));
  board.unplug();
  EXPECT_THAT(light->isOn(), Fails(Errc::kLost));
  EXPECT_THAT(light->set(1), Fails(Errc::kLost));
  EXPECT_THAT(light->recover(), Fails(Errc::kLost));
}

}  // namespace
}  // namespace patina::devices::serial
