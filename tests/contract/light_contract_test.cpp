// SPDX-License-Identifier: GPL-3.0-or-later
// What every lamp owes its session.
#include <gmock/gmock.h>

#include <limits>

#include "devices/light.h"
#include "tests/contract/backends.h"
#include "tests/support/matchers.h"

namespace patina::testing {
namespace {

using namespace patina::devices;

class LightContract : public ::testing::TestWithParam<Backend> {
 protected:
  void SetUp() override {
    made_ = GetParam().make();
    light_ = made_.rig.lights.at(0).get();
    ASSERT_THAT(light().recover(), IsOk());
  }
  Light& light() { return *light_; }
  // A lamp that cannot tell is believed; one that can is held to its word.
  void expectState(bool on) {
    const auto state = light().isOn();
    ASSERT_THAT(state, IsOk());
    EXPECT_EQ(state->has_value(), light().caps().confirms);
    if (state->has_value()) {
      EXPECT_EQ(**state, on);
    }
  }

 private:
  RigUnderTest made_;
  Light* light_ = nullptr;
};

TEST_P(LightContract, KnowsWhatItIs) {
  EXPECT_EQ(light().caps().id, "key");
  EXPECT_GE(light().caps().warm_up, Nanoseconds{0});
  if (light().caps().incandescent) {
    EXPECT_GT(light().caps().mains_hz, 0);
  }
}

TEST_P(LightContract, RecoverLeavesItOff) {
  expectState(false);
  ASSERT_THAT(light().set(1), IsOk());
  ASSERT_THAT(light().recover(), IsOk());
  expectState(false);
}

TEST_P(LightContract, DoesWhatItIsToldAnyNumberOfTimes) {
  for (const double level : {1.0, 1.0, 0.5, 0.0, 0.0, 1.0}) {
    ASSERT_THAT(light().set(level), IsOk());
    expectState(level > 0);
  }
}

TEST_P(LightContract, RefusesLevelsThatAreNoneAndStaysAsItWas) {
  ASSERT_THAT(light().set(1), IsOk());
  for (const double level : {-0.1, 1.1, std::numeric_limits<double>::quiet_NaN(),
                             std::numeric_limits<double>::infinity()}) {
    EXPECT_THAT(light().set(level), Fails(Errc::kRefused)) << level;
    expectState(true);
  }
}

INSTANTIATE_TEST_SUITE_P(Backends, LightContract, ::testing::ValuesIn(bareAndWrappedBackends()),
                         backendName);
INSTANTIATE_TEST_SUITE_P(Lines, LightContract, ::testing::ValuesIn(lineBackendsWith(&Rig::lights)),
                         backendName);

}  // namespace
}  // namespace patina::testing
