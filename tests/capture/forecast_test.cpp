// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/forecast.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace patina::capture {
namespace {

using namespace std::chrono_literals;
using ::testing::Contains;
using ::testing::HasSubstr;

struct Case {
  Plan plan;
  devices::RigSpec rig;
  ForecastInputs inputs;

  Case() {
    plan.interval = 10min;
    plan.duration = 24h * 7;
    plan.light_check.settle = 2s;
    Sweep sweep;
    sweep.lights = {{"key"}, {"key", "fill"}, {}};
    sweep.exposures.resize(2);
    sweep.exposures[0].time = 20ms;
    sweep.exposures[1].time = 100ms;
    plan.sweeps = {sweep};
    for (const char* id : {"cam0", "cam1"}) {
      devices::CameraSpec& camera = rig.cameras.emplace_back();
      camera.id = id;
      camera.backend = "twin";
      devices::CameraCaps caps;
      caps.id = id;
      caps.cycle = 1s;
      caps.exposure_max = 30s;
      caps.bytes_a_shot = 1'000'000;
      caps.has_shutter = caps.id == "cam0";
      inputs.cameras.push_back(caps);
      rig.patches.push_back({id, {0, 0, 64, 64}});
    }
    for (const char* id : {"key", "fill"}) {
      devices::LightSpec light;
      light.id = id;
      rig.lights.push_back(light);
      devices::LightCaps caps;
      caps.id = id;
      caps.incandescent = true;
      inputs.lights.push_back(caps);
    }
    rig.lights[1].between = devices::Between::kOn;
  }
  Forecast run() const { return forecast(plan, rig, inputs); }
};

TEST(Forecast, CountsTheHoursOfAKeptLampThatEndsTheSweepAsOnBetween) {
  Case c;
  c.rig.lights[1].between = devices::Between::kKeep;
  EXPECT_NEAR(c.run().lamp_hours.at("fill"), 1008 * 4.12 / 3600, 1e-6);  // with its shots alone
  c.plan.sweeps[0].lights = {{"key"}, {}, {"key", "fill"}};
  EXPECT_NEAR(c.run().lamp_hours.at("fill"), 168 - 1008 * (4.12 + 2.12) / 3600, 1e-6);
}

TEST(Forecast, CountsStepsShotsBytesLampHoursAndActuations) {
  const Forecast f = Case().run();
  EXPECT_EQ(f.steps, 1008);
  EXPECT_EQ(f.shots, 1008 * 12);
  EXPECT_EQ(f.frame_bytes, 12'096'000'000);
  EXPECT_GT(f.catalogue_bytes, f.shots * 500);
  ASSERT_EQ(f.actuations.size(), 1u);
  EXPECT_EQ(f.actuations.at("cam0"), 1008 * 6);
  EXPECT_EQ(f.sweep, 3 * 2120ms + 2 * 2s);
  EXPECT_EQ(f.end - f.begin, 168h);
  // key: on for settle and exposures of two states; fill: on but for the two states without it.
  EXPECT_NEAR(f.lamp_hours.at("key"), 1008 * 2 * 4.12 / 3600, 1e-6);
  EXPECT_NEAR(f.lamp_hours.at("fill"), 168 - 1008 * (4.12 + 2.12) / 3600, 1e-6);
  EXPECT_TRUE(f.warnings.empty()) << f.warnings[0];
}

TEST(Forecast, WarnsOfABeatWithTheMains) {
  Case c;
  c.plan.sweeps[0].exposures[0].time = 16ms;
  EXPECT_THAT(c.run().warnings, Contains(HasSubstr("half-periods")));
  c.inputs.lights[0].incandescent = c.inputs.lights[1].incandescent = false;
  EXPECT_TRUE(c.run().warnings.empty());
}

TEST(Forecast, WarnsOfAnIntervalShorterThanTheCycle) {
  Case c;
  c.plan.interval = 500ms;
  EXPECT_THAT(c.run().warnings, Contains(HasSubstr("shorter than the cycle")));
  EXPECT_THAT(c.run().warnings, Contains(HasSubstr("longer than the interval")));
}

TEST(Forecast, WarnsOfADiskThatIsTooSmall) {
  Case c;
  c.inputs.free_bytes = 5'000'000'000;
  const Forecast f = c.run();
  EXPECT_THAT(f.warnings, Contains(HasSubstr("too small")));
  ASSERT_TRUE(f.disk_full);
  EXPECT_GT(*f.disk_full, f.begin + 48h);
  EXPECT_LT(*f.disk_full, f.begin + 84h) << "5 GB of more than 12 in seven days";
  EXPECT_THAT(f.warnings, Contains(HasSubstr(formatUtc(*f.disk_full).substr(0, 19))));
  c.inputs.free_bytes = 50'000'000'000;
  EXPECT_FALSE(c.run().disk_full);
}

TEST(Forecast, KnowsWhenTheDiskOfARunningPlanIsFull) {
  DiskUse use{2000, 1000, 100, 20, utcFromNs(0), utcFromNs(20)};
  EXPECT_EQ(stepsThatFit(use), 10);
  EXPECT_EQ(diskFullAt(use), utcFromNs(10));
  use.steps_left = 10;
  EXPECT_FALSE(diskFullAt(use)) << "all of them fit";
  use.free_bytes = 1000;
  EXPECT_EQ(diskFullAt(use), use.next_due) << "now";
  use.bytes_a_step = 0;
  EXPECT_EQ(stepsThatFit(use), 0);
  use.free_bytes = 1001;
  EXPECT_FALSE(diskFullAt(use)) << "nothing is written";
}

TEST(Forecast, WarnsOfWindowsThatNoStepFallsInto) {
  Case c;
  c.plan.interval = 24h;
  c.plan.windows = {{8h, 9h}};
  const Forecast f = c.run();
  EXPECT_EQ(f.steps, 0);
  EXPECT_THAT(f.warnings, Contains(HasSubstr("nothing will be captured")));
}

TEST(Forecast, WarnsOfALightThatNothingWatches) {
  Case c;
  c.rig.patches.clear();
  EXPECT_THAT(c.run().warnings, Contains(HasSubstr("nothing watches the light state key")));
  c.rig.sensors.emplace_back().id = "lux0";
  EXPECT_TRUE(c.run().warnings.empty());
}

TEST(Forecast, WarnsOfAnExposureTheCameraCannotMake) {
  Case c;
  c.inputs.cameras[1].exposure_max = 50ms;
  EXPECT_THAT(c.run().warnings, Contains(HasSubstr("cannot expose 1/10")));
}

TEST(Forecast, CountsReadingsAtEveryStepAndOnThePeriod) {
  Case c;
  EXPECT_EQ(c.run().readings, 0);
  const auto without = c.run().catalogue_bytes;
  c.rig.sensors.resize(2);
  EXPECT_EQ(c.run().readings, 2 * 1008);
  c.plan.read_sensors_every = 1min;
  EXPECT_EQ(c.run().readings, 2 * (1008 + 7 * 24 * 60));
  EXPECT_GT(c.run().catalogue_bytes, without + c.run().readings * 100);
}

TEST(Forecast, WarnsOfAPeriodWithoutASensor) {
  Case c;
  c.plan.read_sensors_every = 1min;
  EXPECT_THAT(c.run().warnings, Contains(HasSubstr("every 1min, but the rig has no [[sensor]]")));
  c.rig.sensors.resize(1);
  EXPECT_THAT(c.run().warnings, ::testing::Not(Contains(HasSubstr("[[sensor]]"))));
}

}  // namespace
}  // namespace patina::capture
