// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include "devices/config_file.h"
#include "devices/serial/serial.h"
#include "tests/devices/serial/fake_port.h"
#include "tests/support/matchers.h"

namespace patina::devices::serial {
namespace {

using namespace std::chrono_literals;
using patina::testing::Fails;
using patina::testing::FakePort;
using patina::testing::IsOk;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

using Values = std::map<std::string, std::string>;

class SerialTrigger : public ::testing::Test {
 protected:
  std::unique_ptr<Trigger> make(Values settings) {
    TriggerSpec spec;
    spec.id = "shutter";
    spec.backend = "serial";
    spec.address = "/dev/fake";
    spec.settings = std::move(settings);
    return makeTriggerOn(port_, spec, "rig.toml", clock_);
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

TEST_F(SerialTrigger, PressesHalfwayThenFiresThenLetsGo) {
  const auto trigger =
      make({{"line", "rts"}, {"half_line", "dtr"}, {"half", "200ms"}, {"pulse", "50ms"}});
  ASSERT_THAT(trigger->recover(), IsOk());
  port_->did.clear();
  const MonoTime before = clock_.mono();
  const auto fired = trigger->fire();
  ASSERT_THAT(fired, IsOk());
  EXPECT_EQ(*fired, before + 200ms);
  EXPECT_THAT(port_->did, ElementsAre("dtr 1 0", "rts 1 200", "rts 0 250", "dtr 0 250"));
}

TEST_F(SerialTrigger, IsLostUntilItIsRecovered) {
  const auto trigger = make({{"line", "rts"}});
  const auto fired = trigger->fire();
  ASSERT_THAT(fired, Fails(Errc::kLost));
  EXPECT_THAT(fired.error().what, HasSubstr("serial 'shutter': fire"));
  ASSERT_THAT(trigger->recover(), IsOk());
  EXPECT_THAT(trigger->fire(), IsOk());
}

TEST_F(SerialTrigger, SendsACommandAndHoldsTheBoardToItsReply) {
  const auto trigger = make({{"fire", "FIRE\\n"}, {"reply", "OK"}});
  ASSERT_THAT(trigger->recover(), IsOk());
  port_->lines = {"OK 12", "BUSY"};
  EXPECT_THAT(trigger->fire(), IsOk());
  EXPECT_THAT(trigger->fire(), Fails(Errc::kCorrupt));
  EXPECT_THAT(trigger->fire(), Fails(Errc::kTimeout));
  EXPECT_EQ(port_->did.at(0), "send FIRE\n");
}

TEST_F(SerialTrigger, LetsGoWhenItGoes) {
  make({{"line", "dtr"}}).reset();
  EXPECT_TRUE(port_->did.empty());  // never opened
  auto trigger = make({{"line", "dtr"}});
  ASSERT_THAT(trigger->recover(), IsOk());
  trigger.reset();
  EXPECT_THAT(port_->did, ElementsAre("dtr 0 0", "dtr 0 0"));
}

TEST_F(SerialTrigger, LetsGoOfBothLinesWhenItIsRecovered) {
  const auto trigger = make({{"line", "rts"}, {"half_line", "dtr"}});
  ASSERT_THAT(trigger->recover(), IsOk());
  EXPECT_THAT(port_->did, ElementsAre("rts 0 0", "dtr 0 0"));
}

TEST_F(SerialTrigger, RefusesSettingsThatDoNotBelongTogether) {
  EXPECT_THAT(refusalOf({}), HasSubstr("give line or fire"));
  EXPECT_THAT(refusalOf({{"line", "rts"}, {"fire", "x"}}), HasSubstr("give line or fire"));
  EXPECT_THAT(refusalOf({{"line", "rts"}, {"half_line", "rts"}}), HasSubstr("the other one"));
  EXPECT_THAT(refusalOf({{"line", "rts"}, {"reply", "x"}}), HasSubstr("needs fire"));
  EXPECT_THAT(refusalOf({{"line", "rts"}, {"pulse", "10s"}}), HasSubstr("out of range"));
}

}  // namespace
}  // namespace patina::devices::serial
