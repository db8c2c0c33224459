// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/sensor_rounds.h"

#include <gmock/gmock.h>

#include "tests/db/small_run.h"
#include "tests/support/temp_folder.h"

namespace patina::capture {
namespace {

using namespace std::chrono_literals;
using db::testing::kRunId;
using ::testing::ElementsAre;

class FakeSensor final : public devices::Sensor {
 public:
  FakeSensor(std::string id, devices::Quantity quantity, devices::Clock& clock) : clock_(clock) {
    caps_.id = std::move(id);
    caps_.quantity = quantity;
  }
  const devices::SensorCaps& caps() const override { return caps_; }
  devices::Result<devices::Reading> read() override {
    if (silent) return devices::fail(devices::Errc::kTimeout, "says nothing");
    return devices::Reading{value, clock_.utc(), clock_.mono(), saturated};
  }
  devices::Result<void> recover() override {
    ++recovered;
    return {};
  }

  double value = 20;
  bool silent = false, saturated = false;
  int recovered = 0;

 private:
  devices::SensorCaps caps_;
  devices::Clock& clock_;
};

class SensorRoundsTest : public ::testing::Test {
 protected:
  SensorRoundsTest() : archive_(db::testing::optionsFor(folder_ / "a")) {
    db::testing::beginRun(archive_);
    auto air = std::make_unique<FakeSensor>("air", devices::Quantity::kTemperature, clock_);
    auto lux = std::make_unique<FakeSensor>("lux", devices::Quantity::kIlluminance, clock_);
    air_ = air.get();
    lux_ = lux.get();
    rig_.sensors.push_back(std::move(air));
    rig_.sensors.push_back(std::move(lux));
  }
  SensorRounds rounds(std::optional<Nanoseconds> every) {
    return {rig_, archive_, clock_, kRunId, every, alerts_};
  }
  std::vector<db::ReadingRow> rows() { return archive_.reader().readings(kRunId); }
  // Minutes after the beginning, of one of the two sensors.
  std::vector<std::int64_t> minutes() {
    std::vector<std::int64_t> out;
    for (const db::ReadingRow& row : rows())
      if (row.device_id == "air") out.push_back((row.utc - db::testing::at(0)) / 1min);
    return out;
  }

  patina::testing::TempFolder folder_ = patina::testing::TempFolder::inMemory();
  devices::VirtualClock clock_{db::testing::at(0)};
  db::Archive archive_;
  devices::Rig rig_;
  FakeSensor *air_ = nullptr, *lux_ = nullptr;
  Alerts alerts_{defaultAlertRules(10min), [](UtcTime, const std::string&) {}, {}};
};

TEST_F(SensorRoundsTest, ARoundIsARowASensorWithUnitQualityAndStep) {
  db::StepRow step = db::testing::stepRow(0);
  step.id = archive_.beginStep(step);
  lux_->saturated = true;
  SensorRounds rounds = this->rounds({});
  rounds.round({step.id, nullptr});
  air_->silent = true;
  rounds.round({});
  const auto all = rows();
  ASSERT_EQ(all.size(), 4u);
  EXPECT_EQ(all[0].device_id + " " + all[0].quantity + " " + all[0].unit, "air temperature degC");
  EXPECT_EQ(all[0].value, 20);
  EXPECT_EQ(all[0].step_id, step.id);
  EXPECT_EQ(all[2].step_id, std::nullopt);
  EXPECT_EQ(all[0].quality + " " + all[1].quality + " " + all[2].quality, "ok saturated silent");
  EXPECT_TRUE(alerts_.raised(AlertKind::kSensorSilent, "air"));
  EXPECT_EQ(air_->recovered, 1);
}

TEST_F(SensorRoundsTest, ItsPeriodCountsFromTheLastRoundAndLeavesTheEndToWhoComesThere) {
  SensorRounds rounds = this->rounds(3min);
  rounds.round({});
  EXPECT_EQ(rounds.sleepUntil(clock_.mono() + 6min, {}, {}), devices::Wake::kDue);
  EXPECT_THAT(minutes(), ElementsAre(0, 3));
  clock_.advance(1min);
  rounds.round({});  // a step, late
  rounds.sleepUntil(clock_.mono() + 5min, {}, {});
  EXPECT_THAT(minutes(), ElementsAre(0, 3, 7, 10));
}

TEST_F(SensorRoundsTest, WithoutAPeriodWaitingReadsNothing) {
  SensorRounds rounds = this->rounds({});
  rounds.round({});
  rounds.sleepUntil(clock_.mono() + 24h, {}, {});
  EXPECT_THAT(minutes(), ElementsAre(0));
}

TEST_F(SensorRoundsTest, ReadsWhileAPictureIsAwaitedAndNoLongerThanThat) {
  SensorRounds rounds = this->rounds(3min);
  rounds.round({});
  Doorbell bell;
  const MonoTime there = clock_.mono() + 7min;
  EXPECT_TRUE(rounds.wait(bell, clock_.mono() + 10min, {}, [&] { return clock_.mono() >= there; }));
  EXPECT_FALSE(rounds.wait(bell, clock_.mono() + 1min, {}, [] { return false; }));
  EXPECT_THAT(minutes(), ::testing::AllOf(::testing::Contains(3), ::testing::Contains(6)));
}

TEST_F(SensorRoundsTest, OnlyLampsAtRestAreWhatALampIsComparedWith) {
  SensorRounds rounds = this->rounds({});
  const std::vector<std::string> dark, key{"key"};
  for (int step = 0; step < 3; ++step) {
    rounds.round({{}, &dark});
    lux_->value = 800;
    rounds.round({});  // while the lamp settles
    for (const SensorSample& sample : rounds.lux()) rounds.duringShot(sample, "key", key, true);
    EXPECT_FALSE(alerts_.raised(AlertKind::kSensorDoubtful, "lux"));
    lux_->value = 3;
  }
  for (int step = 0; step < 3; ++step) {
    rounds.round({{}, &dark});
    for (const SensorSample& sample : rounds.lux()) rounds.duringShot(sample, "key", key, true);
  }
  EXPECT_TRUE(alerts_.raised(AlertKind::kSensorDoubtful, "lux"));
}

TEST_F(SensorRoundsTest, TellsLuxAndAmbientApart) {
  const SensorRounds rounds = this->rounds({});
  ASSERT_EQ(rounds.lux().size(), 1u);
  ASSERT_EQ(rounds.ambient().size(), 1u);
  EXPECT_EQ(rounds.lux()[0].id, "lux");
  EXPECT_EQ(rounds.ambient()[0].id, "air");
}

}  // namespace
}  // namespace patina::capture
