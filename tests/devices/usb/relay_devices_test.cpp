// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include "devices/config_file.h"
#include "devices/usb/usb.h"
#include "tests/devices/usb/fake_board.h"
#include "tests/devices/usb/usb_tree.h"
#include "tests/support/matchers.h"

namespace patina::devices::usb {
namespace {

using namespace std::chrono_literals;
using patina::testing::Fails;
using patina::testing::FakeBoard;
using patina::testing::FakeBoards;
using patina::testing::IsOk;
using patina::testing::UsbTree;
using ::testing::HasSubstr;

using Values = std::map<std::string, std::string>;

class RelayDevices : public ::testing::Test {
 protected:
  RelayDevices() { tree_.addHidraw(0); }
  std::unique_ptr<Light> light(Values settings) {
    LightSpec spec;
    spec.id = "key";
    spec.settings = std::move(settings);
    return makeLight(spec, "rig.toml", clock_, places_);
  }
  std::unique_ptr<Trigger> trigger(Values settings) {
    TriggerSpec spec;
    spec.id = "shutter";
    spec.settings = std::move(settings);
    return makeTrigger(spec, "rig.toml", clock_, places_);
  }
  UsbTree tree_;
  FakeBoards boards_;
  std::shared_ptr<FakeBoard> board_ = boards_.at("hidraw0");
  UsbPlaces places_{tree_.root(), boards_.opener()};
  VirtualClock clock_{utcFromNs(0)};
};

TEST_F(RelayDevices, ALampConfirmsAndOpensItsRelayWhenItGoes) {
  auto lamp = light({{"relay", "2"}});
  EXPECT_TRUE(lamp->caps().confirms);
  EXPECT_THAT(lamp->set(1), Fails(Errc::kLost));
  ASSERT_THAT(lamp->recover(), IsOk());
  ASSERT_THAT(lamp->set(0.3), IsOk());
  EXPECT_EQ(board_->state, 2u);
  EXPECT_EQ(*lamp->isOn(), std::optional<bool>(true));
  board_->state = 0;  // someone presses its button
  EXPECT_EQ(*lamp->isOn(), std::optional<bool>(false));
  board_->state = 3;
  lamp.reset();
  EXPECT_EQ(board_->state, 1u);
}

TEST_F(RelayDevices, ALampIsOffAfterItsRecoveryAndAfterAnOrderOfNothing) {
  const auto lamp = light({{"relay", "2"}});
  board_->state = 3;  // as a crash left it
  ASSERT_THAT(lamp->recover(), IsOk());
  EXPECT_EQ(board_->state, 1u);
  ASSERT_THAT(lamp->set(1), IsOk());
  ASSERT_THAT(lamp->set(0), IsOk());
  EXPECT_EQ(board_->state, 1u);
}

TEST_F(RelayDevices, ATriggerLetsGoOfBothRelaysWhenItIsRecoveredAndWhenItGoes) {
  auto shutter = trigger({{"relay", "1"}, {"half_relay", "2"}});
  board_->state = 7;
  ASSERT_THAT(shutter->recover(), IsOk());
  EXPECT_EQ(board_->state, 4u);
  board_->state = 7;
  shutter.reset();
  EXPECT_EQ(board_->state, 4u);
}

TEST_F(RelayDevices, ATriggerPressesAndLetsGo) {
  const auto shutter =
      trigger({{"relay", "1"}, {"half_relay", "2"}, {"half", "200ms"}, {"pulse", "50ms"}});
  ASSERT_THAT(shutter->recover(), IsOk());
  const MonoTime before = clock_.mono();
  std::vector<unsigned> seen;
  for (const auto at : {100ms, 225ms})
    clock_.at(before + at, [&] { seen.push_back(board_->state); });
  const auto fired = shutter->fire();
  ASSERT_THAT(fired, IsOk());
  EXPECT_EQ(*fired, before + 200ms);
  EXPECT_EQ(seen, (std::vector<unsigned>{2, 3}));
  EXPECT_EQ(board_->state, 0u);
}

TEST_F(RelayDevices, SayWhoTheyAreWhenTheyFail) {
  board_->gone = true;
  const auto lost = trigger({})->recover();
  ASSERT_THAT(lost, Fails(Errc::kLost));
  EXPECT_THAT(lost.error().what, HasSubstr("usb 'shutter': recover: no relay board"));
}

TEST_F(RelayDevices, RefuseSettingsThatAreNone) {
  EXPECT_THROW(light({{"relay", "9"}}), ConfigError);
  EXPECT_THROW(light({{"relais", "1"}}), ConfigError);
  EXPECT_THROW(trigger({{"relay", "3"}, {"half_relay", "3"}}), ConfigError);
}

}  // namespace
}  // namespace patina::devices::usb
