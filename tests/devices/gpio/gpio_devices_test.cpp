// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include <algorithm>

#include "devices/config_file.h"
#include "devices/gpio/gpio.h"
#include "tests/support/matchers.h"

namespace patina::devices::gpio {
namespace {

using namespace std::chrono_literals;
using patina::testing::Fails;
using patina::testing::IsOk;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

using Values = std::map<std::string, std::string>;

// A chip that writes down what its lines do, in ms since it was made.
struct FakeChip {
  const Clock& clock;
  MonoTime start = clock.mono();
  std::vector<std::string> did{};
  bool shorted = false, gone = false;

  void write(const std::string& what) {
    const auto at = std::chrono::duration_cast<std::chrono::milliseconds>(clock.mono() - start);
    did.push_back(what + " " + std::to_string(at.count()));
  }
  RequestLine request() {
    return [this](const LineName& name) -> Result<std::unique_ptr<OutputLine>> {
      if (gone) return fail(Errc::kLost, "no GPIO chip " + name.chip);
      return std::unique_ptr<OutputLine>(std::make_unique<Line>(*this, name));
    };
  }
  class Line final : public OutputLine {
   public:
    Line(FakeChip& chip, const LineName& name)
        : chip_(chip), name_(name.chip + ":" + name.line + (name.active_low ? "/low" : "")) {
      chip_.write("take " + name_);
    }
    ~Line() override { chip_.write("release " + name_); }
    Result<void> set(bool active) override {
      if (chip_.gone) return fail(Errc::kLost, "gone");
      if (chip_.shorted && active) return fail(Errc::kRefused, "does not follow");
      chip_.write(name_ + (active ? " on" : " off"));
      return {};
    }

   private:
    FakeChip& chip_;
    const std::string name_;
  };
};

class GpioDevices : public ::testing::Test {
 protected:
  std::unique_ptr<Light> light(const std::string& address, Values settings = {}) {
    LightSpec spec;
    spec.id = "key";
    spec.address = address;
    spec.settings = std::move(settings);
    return makeLight(spec, "rig.toml", clock_, chip_.request());
  }
  std::unique_ptr<Trigger> trigger(Values settings) {
    TriggerSpec spec;
    spec.id = "shutter";
    spec.address = "pins:17";
    spec.settings = std::move(settings);
    return makeTrigger(spec, "rig.toml", clock_, chip_.request());
  }
  VirtualClock clock_{utcFromNs(0)};
  FakeChip chip_{clock_};
};

TEST_F(GpioDevices, ALampHoldsItsLineAndLetsGoWhenItGoes) {
  auto lamp = light("pins:17", {{"active", "low"}});
  EXPECT_TRUE(chip_.did.empty());
  EXPECT_THAT(lamp->set(1), Fails(Errc::kLost));
  ASSERT_THAT(lamp->recover(), IsOk());
  ASSERT_THAT(lamp->set(1), IsOk());
  EXPECT_EQ(*lamp->isOn(), std::nullopt);
  ASSERT_THAT(lamp->set(0), IsOk());
  ASSERT_THAT(lamp->set(0.3), IsOk());
  lamp.reset();
  EXPECT_THAT(chip_.did,
              ElementsAre("take pins:17/low 0", "pins:17/low off 0", "pins:17/low on 0",
                          "pins:17/low off 0", "pins:17/low on 0", "release pins:17/low 0"));
}

TEST_F(GpioDevices, RecoverKeepsALineThatAnswersAndTakesALostOneAnew) {
  const auto lamp = light("pins:17");
  ASSERT_THAT(lamp->recover(), IsOk());
  ASSERT_THAT(lamp->recover(), IsOk());
  EXPECT_EQ(std::ranges::count(chip_.did, "take pins:17 0"), 1);
  chip_.gone = true;
  EXPECT_THAT(lamp->set(1), Fails(Errc::kLost));
  const auto lost = lamp->recover();
  ASSERT_THAT(lost, Fails(Errc::kLost));
  EXPECT_THAT(lost.error().what, HasSubstr("gpio 'key': recover: no GPIO chip pins"));
  chip_.gone = false;
  ASSERT_THAT(lamp->recover(), IsOk());
  EXPECT_EQ(std::ranges::count(chip_.did, "take pins:17 0"), 2);
}

TEST_F(GpioDevices, APinThatDoesNotFollowIsRefused) {
  const auto lamp = light("pins:17");
  ASSERT_THAT(lamp->recover(), IsOk());
  chip_.shorted = true;
  EXPECT_THAT(lamp->set(1), Fails(Errc::kRefused));
}

TEST_F(GpioDevices, ATriggerPressesHalfwayThenFires) {
  const auto shutter = trigger({{"half_line", "27"}, {"half", "200ms"}, {"pulse", "50ms"}});
  ASSERT_THAT(shutter->recover(), IsOk());
  chip_.did.clear();
  const MonoTime before = clock_.mono();
  const auto fired = shutter->fire();
  ASSERT_THAT(fired, IsOk());
  EXPECT_EQ(*fired, before + 200ms);
  EXPECT_THAT(chip_.did,
              ElementsAre("pins:27 on 0", "pins:17 on 200", "pins:17 off 250", "pins:27 off 250"));
}

TEST_F(GpioDevices, RefuseAddressesAndSettingsThatAreNone) {
  for (const char* address : {"", "17", ":17", "pins:"})
    EXPECT_THROW(light(address), ConfigError) << address;
  EXPECT_THROW(light("pins:17", {{"active", "maybe"}}), ConfigError);
  EXPECT_THROW(trigger({{"half_line", "17"}}), ConfigError);
}

}  // namespace
}  // namespace patina::devices::gpio
