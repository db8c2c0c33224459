// SPDX-License-Identifier: GPL-3.0-or-later
// What every trigger owes its session.
#include <gmock/gmock.h>

#include "devices/trigger.h"
#include "tests/contract/backends.h"
#include "tests/support/matchers.h"

namespace patina::testing {
namespace {

using namespace patina::devices;
using namespace std::chrono_literals;

class TriggerContract : public ::testing::TestWithParam<Backend> {
 protected:
  void SetUp() override {
    made_ = GetParam().make();
    ASSERT_FALSE(made_.rig.triggers.empty());
  }
  Trigger& trigger() { return *made_.rig.triggers.at(0); }
  VirtualClock& clock() { return *made_.clock; }

 private:
  RigUnderTest made_;
};

TEST_P(TriggerContract, KnowsItsIdBeforeItIsOpened) { EXPECT_EQ(trigger().id(), "shutter"); }

TEST_P(TriggerContract, RecoverIsIdempotent) {
  EXPECT_THAT(trigger().recover(), IsOk());
  EXPECT_THAT(trigger().recover(), IsOk());
  EXPECT_THAT(trigger().fire(), IsOk());
  EXPECT_THAT(trigger().recover(), IsOk());
}

TEST_P(TriggerContract, SaysWhenItsLineWentActiveAndIsSoonFreeAgain) {
  ASSERT_THAT(trigger().recover(), IsOk());
  MonoTime last{};
  for (int i = 0; i < 5; ++i) {
    const MonoTime before = clock().mono();
    const auto fired = trigger().fire();
    ASSERT_THAT(fired, IsOk());
    EXPECT_GE(*fired, before);
    EXPECT_LE(*fired, clock().mono());
    EXPECT_LE(clock().mono() - before, 10s);  // five for each of half-press and pulse
    EXPECT_GT(*fired, last);
    last = *fired;
    clock().advance(1s);
  }
}

INSTANTIATE_TEST_SUITE_P(Lines, TriggerContract,
                         ::testing::ValuesIn(lineBackendsWith(&Rig::triggers)), backendName);
INSTANTIATE_TEST_SUITE_P(Twin, TriggerContract, ::testing::Values(bareBackends().at(1)),
                         backendName);

}  // namespace
}  // namespace patina::testing
