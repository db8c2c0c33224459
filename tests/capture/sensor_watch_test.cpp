// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/sensor_watch.h"

#include <gmock/gmock.h>

namespace patina::capture {
namespace {

using ::testing::HasSubstr;

SensorSample lux(double value, bool saturated = false) {
  SensorSample sample{"lux0", devices::Quantity::kIlluminance, {}};
  sample.reading.value = value;
  sample.reading.saturated = saturated;
  return sample;
}

TEST(SensorWatch, DoubtsALuxSensorThatDoesNotMoveWhenALampIsLit) {
  SensorWatch watch;
  for (int step = 0; step < 3; ++step) {
    EXPECT_EQ(watch.doubt("lux0"), "") << step;
    watch.atRest(lux(812.5), {});
    watch.duringShot(lux(812.5), "key", {"key"}, true);
  }
  EXPECT_EQ(watch.doubt("lux0"),
            "it says 812.5 lx under key, and the same before that is lit: stuck, or it does not "
            "see the lamp");
  watch.atRest(lux(3), {});
  watch.duringShot(lux(812.5), "key", {"key"}, true);
  EXPECT_EQ(watch.doubt("lux0"), "");
}

TEST(SensorWatch, DoesNotDoubtWhatMayWellBeTheSame) {
  SensorWatch watch;
  for (int step = 0; step < 10; ++step) {
    watch.atRest(lux(0), {});
    watch.duringShot(lux(0), "key", {"key"}, false);  // the lamp is dead
    watch.atRest(lux(800), {"key"});
    watch.duringShot(lux(800), "key", {"key"}, true);    // nothing was switched
    watch.duringShot(lux(800), "fill", {"fill"}, true);  // another of the same power
  }
  EXPECT_EQ(watch.doubt("lux0"), "");
}

TEST(SensorWatch, DoubtsASensorAtTheEndOfItsRangeUntilNoStateTakesItThere) {
  SensorWatch watch;
  watch.atRest(lux(2), {});
  watch.duringShot(lux(120'000, true), "key", {"key"}, true);
  watch.duringShot(lux(9'000), "fill", {"fill"}, true);
  watch.atRest(lux(2), {});
  EXPECT_THAT(watch.doubt("lux0"), HasSubstr("120000 lx under key, the end of its range"));
  watch.duringShot(lux(50'000), "key", {"key"}, true);
  EXPECT_EQ(watch.doubt("lux0"), "");
}

TEST(SensorWatch, DoubtsAThermometerAtTheEndOfItsRange) {
  SensorWatch watch;
  SensorSample air{"air", devices::Quantity::kTemperature, {}};
  air.reading.value = 85;
  air.reading.saturated = true;
  watch.atRest(air, {"key"});
  EXPECT_THAT(watch.doubt("air"), HasSubstr("it says 85 degC, the end of its range"));
  air.reading.saturated = false;
  watch.atRest(air, {"key"});
  EXPECT_EQ(watch.doubt("air"), "");
}

}  // namespace
}  // namespace patina::capture
