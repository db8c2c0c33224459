// SPDX-License-Identifier: GPL-3.0-or-later
// What every sensor owes its session.
#include <gmock/gmock.h>

#include "devices/sensor.h"
#include "tests/contract/backends.h"
#include "tests/support/matchers.h"

namespace patina::testing {
namespace {

using namespace patina::devices;
using namespace std::chrono_literals;

class SensorContract : public ::testing::TestWithParam<Backend> {
 protected:
  void SetUp() override { made_ = GetParam().make(); }
  VirtualClock& clock() { return *made_.clock; }
  std::vector<std::unique_ptr<Sensor>>& sensors() { return made_.rig.sensors; }

 private:
  RigUnderTest made_;
};

TEST_P(SensorContract, KnowsItsRangeBeforeItIsRead) {
  for (const auto& sensor : sensors()) {
    EXPECT_FALSE(sensor->caps().id.empty());
    EXPECT_LT(sensor->caps().minimum, sensor->caps().maximum);
    EXPECT_GE(sensor->caps().integration, 0ns);
  }
}

TEST_P(SensorContract, RecoverIsIdempotent) {
  for (const auto& sensor : sensors()) {
    EXPECT_THAT(sensor->recover(), IsOk());
    EXPECT_THAT(sensor->recover(), IsOk());
  }
}

TEST_P(SensorContract, AReadingLiesInItsRangeAndWasTakenDuringTheCall) {
  for (const auto& sensor : sensors()) {
    ASSERT_THAT(sensor->recover(), IsOk());
    for (int i = 0; i < 20; ++i) {
      const MonoTime before = clock().mono();
      const auto reading = sensor->read();
      ASSERT_THAT(reading, IsOk());
      EXPECT_GE(reading->value, sensor->caps().minimum);
      EXPECT_LE(reading->value, sensor->caps().maximum);
      EXPECT_GE(reading->mono, before);
      EXPECT_LE(reading->mono, clock().mono());
      EXPECT_EQ(clock().utc() - reading->utc, clock().mono() - reading->mono);
      clock().advance(7min);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Backends, SensorContract, ::testing::ValuesIn(bareAndWrappedBackends()),
                         backendName);
INSTANTIATE_TEST_SUITE_P(Lines, SensorContract,
                         ::testing::ValuesIn(lineBackendsWith(&Rig::sensors)), backendName);

}  // namespace
}  // namespace patina::testing
