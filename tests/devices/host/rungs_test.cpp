// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/host/rungs.h"

#include <gtest/gtest.h>

#include "tests/contract/stub_devices.h"
#include "tests/support/matchers.h"

namespace patina::devices::host {
namespace {

using patina::testing::IsOk;

TEST(Rungs, ResetAndPowerCycleAreDoneBeforeTheCameraIsOpened) {
  VirtualClock clock(UtcTime{});
  std::string done;
  Rungs rungs;
  rungs.reset = [&]() -> Result<void> {
    done += "reset ";
    return {};
  };
  rungs.power_cycle = [&]() -> Result<void> {
    done += "power ";
    return fail(Errc::kLost, "the hub is gone");
  };
  const auto camera = withRungs(patina::testing::makeStubCamera("cam0", clock), rungs);
  ASSERT_THAT(camera->recover(Rung::kReopen), IsOk());
  EXPECT_EQ(done, "");
  ASSERT_THAT(camera->recover(Rung::kReset), IsOk());
  EXPECT_THAT(camera->recover(Rung::kPowerCycle), IsOk());  // it had come back by itself
  EXPECT_EQ(done, "reset power ");
}

TEST(Rungs, ARungThatIsNotThereIsTheDriversOwn) {
  VirtualClock clock(UtcTime{});
  const auto camera = withRungs(patina::testing::makeStubCamera("cam0", clock), {});
  EXPECT_THAT(camera->recover(Rung::kPowerCycle), IsOk());
  EXPECT_THAT(camera->poll(), IsOk());
}

}  // namespace
}  // namespace patina::devices::host
