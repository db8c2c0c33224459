// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include "devices/config_file.h"
#include "devices/serial/serial.h"
#include "tests/devices/serial/fake_port.h"
#include "tests/devices/serial/pty.h"
#include "tests/support/matchers.h"

namespace patina::devices::serial {
namespace {

using namespace std::chrono_literals;
using patina::testing::Fails;
using patina::testing::FakePort;
using patina::testing::IsOk;
using patina::testing::Pty;
using ::testing::HasSubstr;

using Values = std::map<std::string, std::string>;

class SerialSensor : public ::testing::Test {
 protected:
  std::unique_ptr<Sensor> make(Values settings, Quantity quantity = Quantity::kTemperature) {
    SensorSpec spec;
    spec.id = "air0";
    spec.backend = "serial";
    spec.quantity = quantity;
    settings.emplace("port", "/dev/fake");
    spec.settings = std::move(settings);
    auto sensor = makeSensorOn(port_, spec, "rig.toml", clock_);
    EXPECT_THAT(sensor->recover(), IsOk());
    return sensor;
  }
  VirtualClock clock_{utcFromNs(0)};
  std::shared_ptr<FakePort> port_ = std::make_shared<FakePort>(clock_);
};

TEST_F(SerialSensor, AsksAndReadsTheNumberInThePattern) {
  const auto sensor = make({{"ask", "T?\\n"}, {"pattern", "T={value} C"}});
  port_->lines = {"H=40 % T= 21.5 C"};
  const auto reading = sensor->read();
  ASSERT_THAT(reading, IsOk());
  EXPECT_EQ(reading->value, 21.5);
  EXPECT_EQ(reading->mono, clock_.mono());
  EXPECT_FALSE(reading->saturated);
  EXPECT_EQ(port_->did.back(), "send T?\n");
}

TEST_F(SerialSensor, PassesOverTheLineItCameInTheMiddleOf) {
  const auto sensor = make({{"pattern", "T={value}"}});
  port_->lines = {"1.5", "T=22", "T=23"};
  EXPECT_EQ(sensor->read()->value, 22);
}

TEST_F(SerialSensor, ScalesAndHoldsAtTheEndOfItsRange) {
  const auto sensor = make({{"ask", "?"}, {"scale", "0.5"}, {"offset", "-10"}, {"maximum", "50"}});
  port_->lines = {"100", "+61", "500"};
  EXPECT_EQ(sensor->read()->value, 40);
  EXPECT_EQ(sensor->read()->value, 20.5);
  const auto reading = sensor->read();
  EXPECT_EQ(reading->value, 50);
  EXPECT_TRUE(reading->saturated);
}

TEST_F(SerialSensor, SaysWhatItHeardWhenThatIsNotOfThePattern) {
  const auto sensor = make({{"ask", "?"}, {"pattern", "T={value}"}});
  port_->lines = {"E=3", "T=high"};
  const auto reading = sensor->read();
  ASSERT_THAT(reading, Fails(Errc::kCorrupt));
  EXPECT_THAT(reading.error().what, HasSubstr("serial 'air0': read: it says 'T=high'"));
  EXPECT_THAT(sensor->read(), Fails(Errc::kTimeout));
  port_->lines = {"T=nan"};
  EXPECT_THAT(sensor->read(), Fails(Errc::kCorrupt));
}

TEST_F(SerialSensor, RefusesAPatternWithoutAValue) {
  EXPECT_THROW(make({{"pattern", "T="}}), ConfigError);
}

TEST(SerialSensorOnAPort, NeverAnswersWhatWasSaidBeforeItWasRead) {
  Pty board;
  RealClock clock;
  SensorSpec spec;
  spec.id = "lux0";
  spec.settings = {{"port", board.path()}, {"pattern", "lx={value}"}, {"max_age", "10s"}};
  const auto sensor = makeSensor(spec, "rig.toml", clock);
  ASSERT_THAT(sensor->recover(), IsOk());
  board.sayAndArrive("lx=1\nlx=2\n");
  std::jthread later([&](const std::stop_token& stop) {
    for (int lux = 100; !stop.stop_requested(); ++lux) {
      board.say("lx=" + std::to_string(lux) + "\n");
      clock.sleepUntil(clock.mono() + 2ms, stop);
    }
  });
  const MonoTime before = clock.mono();
  const auto reading = sensor->read();
  ASSERT_THAT(reading, IsOk());
  EXPECT_GE(reading->value, 100);
  EXPECT_GE(reading->mono, before);
  later.request_stop();
  later.join();
}

TEST(SerialSensorOnAPort, IsLateWhenTheSensorIsSilentAndLostWhenItIsUnplugged) {
  Pty board;
  RealClock clock;
  SensorSpec spec;
  spec.id = "lux0";
  spec.settings = {{"port", board.path()}, {"max_age", "10ms"}};
  const auto sensor = makeSensor(spec, "rig.toml", clock);
  EXPECT_THAT(sensor->read(), Fails(Errc::kLost));
  ASSERT_THAT(sensor->recover(), IsOk());
  EXPECT_THAT(sensor->read(), Fails(Errc::kTimeout));
  board.unplug();
  EXPECT_THAT(sensor->read(), Fails(Errc::kLost));
  EXPECT_THAT(sensor->recover(), Fails(Errc::kLost));
}

}  // namespace
}  // namespace patina::devices::serial
