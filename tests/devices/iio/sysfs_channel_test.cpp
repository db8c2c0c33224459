// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/iio/sysfs_channel.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>

#include "devices/descriptor.h"
#include "tests/devices/iio/sysfs_tree.h"
#include "tests/support/matchers.h"

namespace patina::devices::iio {
namespace {

using namespace std::chrono_literals;
using patina::testing::Fails;
using patina::testing::IsOk;
using patina::testing::SysfsTree;
using ::testing::DoubleNear;

class SysfsChannel : public ::testing::Test {
 protected:
  Result<double> read(Kernel kernel, Quantity quantity, std::size_t index = 0) {
    return readChannel(channels(kernel, quantity, tree_.root()).at(index), kernel, quantity, clock_,
                       clock_.mono() + 1s);
  }
  SysfsTree tree_;
  VirtualClock clock_{utcFromNs(0)};
};

TEST_F(SysfsChannel, ReadsWhatTheKernelGivesReady) {
  tree_.addIio(0, "i2c-1/1-0039", {{"name", "tsl2591\n"}, {"in_illuminance_input", "431.25\n"}});
  EXPECT_EQ(*read(Kernel::kIio, Quantity::kIlluminance), 431.25);
}

TEST_F(SysfsChannel, AppliesOffsetThenScaleToRawNumbers) {
  tree_.addIio(0, "i2c-1/1-0040",
               {{"name", "sht\n"},
                {"in_temp_raw", "6000\n"},
                {"in_temp_offset", "-4368\n"},
                {"in_temp_scale", "10.725553\n"},
                {"in_humidityrelative0_raw", "100\n"},
                {"in_humidityrelative_scale", "500\n"}});
  EXPECT_THAT(*read(Kernel::kIio, Quantity::kTemperature), DoubleNear(17.504102, 1e-6));
  EXPECT_THAT(*read(Kernel::kIio, Quantity::kHumidity), DoubleNear(50, 1e-9));
}

TEST_F(SysfsChannel, HwmonSpeaksInThousandths) {
  tree_.addHwmon(3, "i2c-1/1-0048",
                 {{"name", "lm75\n"},
                  {"temp1_input", "-1500\n"},
                  {"humidity1_input", "45250\n"},
                  {"temp1_max", "80000\n"}});
  EXPECT_EQ(*read(Kernel::kHwmon, Quantity::kTemperature), -1.5);
  EXPECT_EQ(*read(Kernel::kHwmon, Quantity::kHumidity), 45.25);
  EXPECT_TRUE(channels(Kernel::kHwmon, Quantity::kIlluminance, tree_.root()).empty());
}

TEST_F(SysfsChannel, IsDescribedByWhatStaysTheSame) {
  tree_.addHwmon(7, "i2c-1/1-0048",
                 {{"name", "lm75\n"}, {"temp2_input", "1\n"}, {"temp2_label", "specimen\n"}});
  tree_.addIio(
      4, "i2c-1/1-0039",
      {{"name", "tsl2591\n"}, {"in_illuminance_raw", "1\n"}, {"in_illuminance_input", "1\n"}});
  const auto air = channels(Kernel::kHwmon, Quantity::kTemperature, tree_.root());
  ASSERT_EQ(air.size(), 1u);
  EXPECT_EQ(air[0].describe(), "lm75 temp2 \"specimen\" (i2c-1/1-0048)");
  const auto light = channels(Kernel::kIio, Quantity::kIlluminance, tree_.root());
  ASSERT_EQ(light.size(), 1u);  // raw and input are one channel
  EXPECT_EQ(light[0].describe(), "tsl2591 in_illuminance (i2c-1/1-0039)");
}

TEST_F(SysfsChannel, TellsGoneFromNonsense) {
  tree_.addIio(0, "i2c-1/1-0039", {{"name", "x\n"}, {"in_illuminance_input", "dark\n"}});
  EXPECT_THAT(read(Kernel::kIio, Quantity::kIlluminance), Fails(Errc::kCorrupt));
  const auto channel = channels(Kernel::kIio, Quantity::kIlluminance, tree_.root()).at(0);
  tree_.remove("iio:device0");
  EXPECT_THAT(readChannel(channel, Kernel::kIio, Quantity::kIlluminance, clock_, clock_.mono()),
              Fails(Errc::kLost));
}

TEST_F(SysfsChannel, GivesUpAtItsDeadlineWhenNothingComes) {
  tree_.addIio(0, "i2c-1/1-0039", {{"name", "x\n"}});
  const auto file = tree_.root() / "sys/bus/iio/devices/iio:device0/in_illuminance_input";
  ASSERT_EQ(mkfifo(file.c_str(), 0600), 0);
  const Descriptor silent(open(file.c_str(), O_RDWR | O_CLOEXEC));
  RealClock clock;
  const auto channel = channels(Kernel::kIio, Quantity::kIlluminance, tree_.root()).at(0);
  EXPECT_THAT(readChannel(channel, Kernel::kIio, Quantity::kIlluminance, clock, clock.mono() + 5ms),
              Fails(Errc::kTimeout));
  ASSERT_EQ(write(silent.fd(), "17\n", 3), 3);
  EXPECT_EQ(*readChannel(channel, Kernel::kIio, Quantity::kIlluminance, clock, clock.mono() + 10s),
            17);
}

}  // namespace
}  // namespace patina::devices::iio
