// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include "devices/config_file.h"
#include "devices/iio/iio.h"
#include "tests/devices/iio/sysfs_tree.h"
#include "tests/support/matchers.h"

namespace patina::devices::iio {
namespace {

using patina::testing::Fails;
using patina::testing::IsOk;
using patina::testing::SysfsTree;
using ::testing::HasSubstr;

using Values = std::map<std::string, std::string>;

class SysfsSensor : public ::testing::Test {
 protected:
  std::unique_ptr<Sensor> make(const std::string& backend, Quantity quantity,
                               Values settings = {}) {
    SensorSpec spec;
    spec.id = "s";
    spec.backend = backend;
    spec.quantity = quantity;
    spec.settings = std::move(settings);
    return makeSensor(spec, "rig.toml", clock_, tree_.root());
  }
  void addLux(int number, const std::string& bus, const std::string& lux) {
    tree_.addIio(number, bus, {{"name", "tsl2591\n"}, {"in_illuminance_input", lux + "\n"}});
  }
  SysfsTree tree_;
  VirtualClock clock_{utcFromNs(1'000'000)};
};

TEST_F(SysfsSensor, ReadsOnceItWasLookedFor) {
  addLux(0, "i2c-1/1-0039", "250");
  const auto sensor = make("iio", Quantity::kIlluminance, {{"scale", "2"}});
  EXPECT_THAT(sensor->read(), Fails(Errc::kLost));
  ASSERT_THAT(sensor->recover(), IsOk());
  const auto reading = sensor->read();
  ASSERT_THAT(reading, IsOk());
  EXPECT_EQ(reading->value, 500);
  EXPECT_EQ(reading->mono, clock_.mono());
  EXPECT_FALSE(reading->saturated);
}

TEST_F(SysfsSensor, IsFoundByItsPlaceUnderAnyNumber) {
  addLux(0, "i2c-1/1-0029", "1");
  addLux(1, "i2c-1/1-0039", "2");
  const auto sensor = make("iio", Quantity::kIlluminance, {{"path", "1-0039"}});
  ASSERT_THAT(sensor->recover(), IsOk());
  EXPECT_EQ(sensor->read()->value, 2);
  tree_.remove("iio:device1");  // and comes back as another
  EXPECT_THAT(sensor->read(), Fails(Errc::kLost));
  EXPECT_THAT(sensor->recover(), Fails(Errc::kLost));
  addLux(5, "i2c-1/1-0039", "3");
  ASSERT_THAT(sensor->recover(), IsOk());
  EXPECT_EQ(sensor->read()->value, 3);
}

TEST_F(SysfsSensor, RefusesTwoThatCannotBeToldApart) {
  addLux(0, "i2c-1/1-0029", "1");
  addLux(1, "i2c-1/1-0039", "2");
  const auto sensor = make("iio", Quantity::kIlluminance, {{"name", "tsl2591"}});
  const auto two = sensor->recover();
  ASSERT_THAT(two, Fails(Errc::kRefused));
  EXPECT_THAT(two.error().what, HasSubstr("i2c-1/1-0029"));
  EXPECT_THAT(two.error().what, HasSubstr("i2c-1/1-0039"));
}

TEST_F(SysfsSensor, NamesWhatIsThereInsteadOfAMissingOne) {
  addLux(0, "i2c-1/1-0029", "1");
  const auto none = make("iio", Quantity::kIlluminance, {{"name", "bh1750"}})->recover();
  ASSERT_THAT(none, Fails(Errc::kLost));
  EXPECT_THAT(none.error().what, HasSubstr("there are: tsl2591 in_illuminance (i2c-1/1-0029)"));
}

TEST_F(SysfsSensor, PicksAChannelOfADeviceByNameOrLabel) {
  tree_.addHwmon(0, "i2c-1/1-0048",
                 {{"name", "lm75\n"},
                  {"temp1_input", "20000\n"},
                  {"temp2_input", "30000\n"},
                  {"temp2_label", "specimen\n"}});
  for (const Values& settings : {Values{{"channel", "temp2"}}, Values{{"label", "specimen"}}}) {
    const auto sensor = make("hwmon", Quantity::kTemperature, settings);
    ASSERT_THAT(sensor->recover(), IsOk());
    EXPECT_EQ(sensor->read()->value, 30);
  }
}

TEST_F(SysfsSensor, SaturatesAtTheEndOfItsRange) {
  addLux(0, "i2c-1/1-0039", "90000");
  const auto sensor = make("iio", Quantity::kIlluminance, {{"maximum", "65535"}});
  ASSERT_THAT(sensor->recover(), IsOk());
  EXPECT_TRUE(sensor->read()->saturated);
  EXPECT_EQ(sensor->read()->value, 65535);
}

TEST_F(SysfsSensor, RefusesWhatHwmonHasNot) {
  EXPECT_THROW(make("hwmon", Quantity::kIlluminance), ConfigError);
  EXPECT_THROW(make("lmsensors", Quantity::kTemperature), ConfigError);
}

TEST_F(SysfsSensor, FindListsEveryChannelWithItsValueOrItsTrouble) {
  addLux(0, "i2c-1/1-0039", "250");
  tree_.addHwmon(2, "i2c-1/1-0048", {{"name", "lm75\n"}, {"temp1_input", "?\n"}});
  const auto found = find(tree_.root());
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].serial, "i2c-1/1-0039");
  EXPECT_EQ(found[0].state, "ready");
  EXPECT_EQ(found[1].backend, "hwmon");
  ASSERT_EQ(found[1].troubles.size(), 1u);
}

}  // namespace
}  // namespace patina::devices::iio
