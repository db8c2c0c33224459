// SPDX-License-Identifier: GPL-3.0-or-later
// The backend gpio on gpio-sim. $PATINA_GPIO_SIM is the chip's folder in sysfs, where each line's
// far end can be read; its label is "patina-lamps".
#include "devices/gpio/gpio.h"

#include <gmock/gmock.h>

#include <cstdlib>
#include <thread>

#include "tests/support/matchers.h"
#include "tests/support/temp_folder.h"

namespace patina::testing {
namespace {

using namespace patina::devices;
using namespace std::chrono_literals;
using ::testing::HasSubstr;

class SimulatedChip : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* folder = std::getenv("PATINA_GPIO_SIM");
    if (!folder) GTEST_SKIP() << "PATINA_GPIO_SIM names no chip";
    chip_ = folder;
  }
  std::unique_ptr<Light> lampOn(int line, const std::string& active = "high") {
    LightSpec spec;
    spec.id = "key";
    spec.backend = "gpio";
    spec.address = "patina-lamps:" + std::to_string(line);
    spec.settings = {{"active", active}};
    return gpio::makeLight(spec, "rig.toml", clock_);
  }
  int pin(int line) const {
    return readFile(chip_ + "/sim_gpio" + std::to_string(line) + "/value").at(0) - '0';
  }

  RealClock clock_;
  std::string chip_;
};

TEST_F(SimulatedChip, ALampDrivesItsPinAndLetsGoDark) {
  {
    const auto lamp = lampOn(2);
    ASSERT_THAT(lamp->recover(), IsOk());
    EXPECT_EQ(pin(2), 0);
    ASSERT_THAT(lamp->set(1), IsOk());
    EXPECT_EQ(pin(2), 1);
    EXPECT_EQ(pin(3), 0);
  }
  EXPECT_EQ(pin(2), 0);
}

TEST_F(SimulatedChip, AnActiveLowLampIsDarkWithItsPinHigh) {
  const auto lamp = lampOn(4, "low");
  ASSERT_THAT(lamp->recover(), IsOk());
  EXPECT_EQ(pin(4), 1);
  ASSERT_THAT(lamp->set(1), IsOk());
  EXPECT_EQ(pin(4), 0);
}

TEST_F(SimulatedChip, ALineInUseIsBusyAndAChipThatIsNotThereIsLost) {
  const auto first = lampOn(1), second = lampOn(1);
  ASSERT_THAT(first->recover(), IsOk());
  EXPECT_THAT(second->recover(), Fails(Errc::kBusy));
  LightSpec spec;
  spec.id = "key";
  spec.address = "no-such-chip:1";
  const auto lost = gpio::makeLight(spec, "rig.toml", clock_)->recover();
  ASSERT_THAT(lost, Fails(Errc::kLost));
  EXPECT_THAT(lost.error().what, HasSubstr("patina-lamps"));
}

TEST_F(SimulatedChip, AShutterLineIsPressedAndLetGo) {
  TriggerSpec spec;
  spec.id = "release";
  spec.backend = "gpio";
  spec.address = "patina-lamps:6";
  spec.settings = {{"pulse", "2s"}};
  const auto trigger = gpio::makeTrigger(spec, "rig.toml", clock_);
  ASSERT_THAT(trigger->recover(), IsOk());
  EXPECT_EQ(pin(6), 0);
  bool pressed = false;
  std::jthread watcher([&](std::stop_token stop) {
    while (!stop.stop_requested() && !pressed) pressed = pin(6) == 1;
  });
  ASSERT_THAT(trigger->fire(), IsOk());
  watcher.request_stop();
  watcher.join();
  EXPECT_TRUE(pressed);
  EXPECT_EQ(pin(6), 0);
}

TEST_F(SimulatedChip, IsFoundByItsLabel) {
  const auto all = gpio::find();
  ASSERT_FALSE(all.empty());
  std::string seen;
  for (const FoundDevice& found : all)
    seen += found.model + " " + found.serial + " " + found.address + "\n";
  EXPECT_THAT(seen, HasSubstr("patina-lamps"));
}

}  // namespace
}  // namespace patina::testing
