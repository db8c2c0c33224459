// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/dslr/camera_settings.h"

#include <gtest/gtest.h>

namespace patina::devices::twin::dslr {
namespace {

using namespace std::chrono_literals;

Bytes number(std::int64_t value, int bytes) {
  PtpWriter out;
  out.number(static_cast<std::uint64_t>(value), bytes);
  return out.take();
}

TEST(CameraSettings, DescribeTypeValuesAndChoicesByteForByte) {
  CameraSettings settings({64, 48});
  settings.set(Property::kSaveTo, kToMemory);
  const std::vector<int> expected = {0xF1, 0xDF, 2, 0, 1, 1, 2, 2, 2, 0, 1, 2};
  Bytes bytes;
  for (const int v : expected) bytes.push_back(static_cast<std::byte>(v));
  EXPECT_EQ(settings.describe(Property::kSaveTo), bytes);
}

TEST(CameraSettings, TakeEveryOneOfTheirChoices) {
  CameraSettings settings({64, 48});
  for (const std::uint16_t code : settings.codes()) {
    const Setting& setting = *settings.find(static_cast<Property>(code));
    if (!setting.writable || setting.form != Form::kChoices) continue;
    const int bytes = setting.type == DataType::kU8 ? 1 : setting.type == DataType::kU16 ? 2 : 4;
    for (const std::int64_t choice : setting.choices) {
      EXPECT_EQ(settings.write(setting.property, number(choice, bytes)), Answer::kOk);
      EXPECT_EQ(settings.value(setting.property), choice);
    }
  }
}

TEST(CameraSettings, RefuseWhatIsNoChoiceAndKeepTheirValue) {
  CameraSettings settings({64, 48});
  EXPECT_EQ(settings.write(Property::kExposureIndex, number(123, 2)),
            Answer::kInvalidDevicePropValue);
  EXPECT_EQ(settings.write(Property::kExposureIndex, number(200, 4)),
            Answer::kInvalidDevicePropFormat);
  EXPECT_EQ(settings.write(Property::kBatteryLevel, number(50, 1)), Answer::kAccessDenied);
  EXPECT_EQ(settings.write(static_cast<Property>(0x5999), number(1, 1)),
            Answer::kDevicePropNotSupported);
  EXPECT_EQ(settings.value(Property::kExposureIndex), 100);
  EXPECT_EQ(settings.value(Property::kBatteryLevel), 100);
}

TEST(CameraSettings, MoveByTheDialToANeighbouringChoice) {
  CameraSettings settings({64, 48});
  settings.set(Property::kExposureTime, 100);
  settings.turnTheDial();
  EXPECT_EQ(settings.exposure().time, 12'500us);
  settings.set(Property::kExposureTime, 300'000);
  settings.turnTheDial();
  EXPECT_EQ(settings.exposure().time, 25s);
}

TEST(CameraSettings, GoBackToWhatTheFactorySet) {
  CameraSettings settings({64, 48});
  settings.set(Property::kFNumber, 2200);
  settings.reset(Property::kFNumber);
  EXPECT_EQ(settings.exposure().f_number, FNumber{8});
}

}  // namespace
}  // namespace patina::devices::twin::dslr
