// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/trigger_pulse.h"

#include <gmock/gmock.h>

#include <string>
#include <vector>

#include "tests/support/matchers.h"

namespace patina::devices {
namespace {

using namespace std::chrono_literals;
using patina::testing::Fails;
using patina::testing::IsOk;
using ::testing::ElementsAre;

constexpr UtcTime kStart = utcFromNs(1'714'564'800'000'000'000);

class Press : public ::testing::Test {
 protected:
  LineDrive drive(const std::string& name) {
    return [this, name](bool active) -> Result<void> {
      const auto at = std::chrono::duration_cast<std::chrono::milliseconds>(clock_.mono() - start_);
      did_.push_back(name + (active ? " on " : " off ") + std::to_string(at.count()));
      if (active && name == fails_) return fail(Errc::kLost, name + " is gone");
      return {};
    };
  }
  VirtualClock clock_{kStart};
  const MonoTime start_ = clock_.mono();
  std::string fails_;
  std::vector<std::string> did_;
};

TEST_F(Press, HoldsTheLineForThePulseAndSaysWhenItWentActive) {
  const auto at = press({100ms, 0ms}, drive("full"), {}, clock_);
  ASSERT_THAT(at, IsOk());
  EXPECT_EQ(*at, start_);
  EXPECT_THAT(did_, ElementsAre("full on 0", "full off 100"));
}

TEST_F(Press, PressesHalfwayFirst) {
  const auto at = press({100ms, 300ms}, drive("full"), drive("half"), clock_);
  ASSERT_THAT(at, IsOk());
  EXPECT_EQ(*at, start_ + 300ms);
  EXPECT_THAT(did_, ElementsAre("half on 0", "full on 300", "full off 400", "half off 400"));
}

TEST_F(Press, LetsGoOfBothWhicheverFails) {
  fails_ = "full";
  EXPECT_THAT(press({100ms, 300ms}, drive("full"), drive("half"), clock_), Fails(Errc::kLost));
  EXPECT_THAT(did_, ElementsAre("half on 0", "full on 300", "full off 300", "half off 300"));
  did_.clear();
  fails_ = "half";
  EXPECT_THAT(press({100ms, 300ms}, drive("full"), drive("half"), clock_), Fails(Errc::kLost));
  EXPECT_THAT(did_, ElementsAre("half on 300", "full off 300", "half off 300"));
}

TEST(TriggerPulse, IsATenthOfASecondWithoutAHalfPressUnlessTold) {
  const std::map<std::string, std::string> values{{"half", "250ms"}};
  Settings settings(values, "trigger 'line'", "rig.toml");
  const TriggerPulse pulse = takeTriggerPulse(settings);
  EXPECT_EQ(pulse.pulse, 100ms);
  EXPECT_EQ(pulse.half, 250ms);
}

}  // namespace
}  // namespace patina::devices
