// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/sensor/calibration_key.h"

#include <gtest/gtest.h>

namespace patina::calibration {
namespace {

CalibrationKey key(const char* kind) {
  CalibrationKey k;
  k.kind = kind;
  k.device_id = "cam0";
  k.exposure = std::chrono::milliseconds(10);
  k.iso = 100;
  k.size = {640, 480};
  k.utc = parseUtc("2024-05-01");
  return k;
}

TEST(DistanceBetween, BindsADarkByExposureButNotAFlat) {
  CalibrationKey frame = key("frame");
  frame.exposure = std::chrono::milliseconds(20);
  EXPECT_FALSE(distanceBetween(frame, key("dark")).usable);
  EXPECT_NE(distanceBetween(frame, key("dark")).why_not, "");
  EXPECT_TRUE(distanceBetween(frame, key("flat")).usable);
  EXPECT_TRUE(distanceBetween(frame, key("bias")).within_tolerance);
  EXPECT_TRUE(distanceBetween(key("frame"), key("dark")).within_tolerance);
}

TEST(DistanceBetween, RefusesAnotherCameraSizeOrIso) {
  for (int field : {0, 1, 2}) {
    CalibrationKey frame = key("frame");
    if (field == 0) frame.device_id = "cam1";
    if (field == 1) frame.size = {480, 640};
    if (field == 2) frame.iso = 200;
    const CalibrationDistance d = distanceBetween(frame, key("flat"));
    EXPECT_FALSE(d.usable);
    EXPECT_FALSE(d.within_tolerance);
    EXPECT_NE(d.why_not, "");
  }
}

TEST(DistanceBetween, MeasuresTimeAndTemperatureBothWays) {
  CalibrationKey frame = key("frame");
  frame.utc = parseUtc("2024-05-31");
  frame.temperature_c = 15;
  EXPECT_EQ(distanceBetween(frame, key("dark")).time_s, 30 * 86400.0);
  EXPECT_TRUE(distanceBetween(frame, key("dark")).within_tolerance);
  frame.temperature_c = 14.9;
  EXPECT_NEAR(distanceBetween(frame, key("dark")).temperature_k, 5.1, 1e-9);
  EXPECT_TRUE(distanceBetween(frame, key("dark")).usable);
  EXPECT_FALSE(distanceBetween(frame, key("dark")).within_tolerance);
  frame = key("frame");
  frame.utc = parseUtc("2024-03-01");
  EXPECT_FALSE(distanceBetween(frame, key("dark")).within_tolerance);
}

TEST(DistanceBetween, AFlatOfAnotherExposureIsOutOfToleranceWithWhy) {
  CalibrationKey frame = key("frame");
  frame.exposure = std::chrono::milliseconds(20);
  const CalibrationDistance d = distanceBetween(frame, key("flat"));
  EXPECT_TRUE(d.usable);
  EXPECT_FALSE(d.within_tolerance);
  EXPECT_EQ(d.why_not, "exposed for 1/100, not 1/50");
  EXPECT_TRUE(distanceBetween(key("frame"), key("flat")).within_tolerance);
}

TEST(DistanceBetween, RefusesOtherBitsButNotUnknownOnes) {
  CalibrationKey frame = key("frame"), dark = key("dark");
  frame.bits = 12;
  EXPECT_TRUE(distanceBetween(frame, dark).usable);
  dark.bits = 14;
  EXPECT_EQ(distanceBetween(frame, dark).why_not, "of 14 bits, not 12");
}

TEST(DistanceBetween, DefectsNoiseAndResponseAskForLess) {
  CalibrationKey frame = key("frame");
  frame.iso = 400;
  EXPECT_TRUE(distanceBetween(frame, key("defects")).within_tolerance);
  EXPECT_TRUE(distanceBetween(frame, key("response")).within_tolerance);
  EXPECT_FALSE(distanceBetween(frame, key("photon_transfer")).usable);
  frame = key("frame");
  frame.size = {320, 240};
  EXPECT_TRUE(distanceBetween(frame, key("photon_transfer")).usable);
  EXPECT_FALSE(distanceBetween(frame, key("defects")).usable);
}

TEST(DistanceBetween, GeometryIsOfItsZoomAndFocusWhereFilesSayThem) {
  for (const char* kind : {"lens", "view", "vignetting"}) {
    CalibrationKey frame = key("frame"), made = key(kind);
    made.focal_mm = 35;
    made.focus_m = 0.5;
    EXPECT_TRUE(distanceBetween(frame, made).within_tolerance) << "the frame does not say";
    frame.focal_mm = 35.2;
    frame.focus_m = 0.51;
    EXPECT_TRUE(distanceBetween(frame, made).within_tolerance);
    frame.focal_mm = 36;
    EXPECT_EQ(distanceBetween(frame, made).why_not, "at 35 mm, not 36 mm") << kind;
    EXPECT_FALSE(distanceBetween(frame, made).usable);
    frame.focal_mm = 35;
    frame.focus_m = 0.6;
    EXPECT_EQ(distanceBetween(frame, made).why_not, "focused at 0.5 m, not 0.6 m") << kind;
  }
}

TEST(DistanceBetween, GeometryHoldsForNinetyDaysAndALensAlways) {
  CalibrationKey frame = key("frame");
  frame.utc = parseUtc("2024-07-15");
  EXPECT_TRUE(distanceBetween(frame, key("view")).within_tolerance);
  EXPECT_TRUE(distanceBetween(frame, key("vignetting")).within_tolerance);
  frame.utc = parseUtc("2024-09-01");
  EXPECT_EQ(distanceBetween(frame, key("view")).why_not, "123 days away, at most 90");
  EXPECT_TRUE(distanceBetween(frame, key("view")).usable);
  EXPECT_TRUE(distanceBetween(frame, key("lens")).within_tolerance);
}

TEST(DistanceBetween, WhatHoldsALampsLightIsOfThatLamp) {
  for (const char* kind : {"gain_field", "albedo", "colour", "flat"}) {
    CalibrationKey frame = key("frame"), made = key(kind);
    made.light_state = frame.light_state = "key";
    EXPECT_TRUE(distanceBetween(frame, made).within_tolerance) << kind;
    frame.light_state = "fill";
    EXPECT_EQ(distanceBetween(frame, made).why_not, "lit by key, not fill");
  }
}

TEST(ShootInstead, SaysExposureIsoAndTemperature) {
  CalibrationKey frame = key("frame");
  frame.exposure = std::chrono::milliseconds(20);
  frame.temperature_c = 21;
  frame.light_state = "key";
  EXPECT_EQ(shootInstead(frame, "dark"), "shoot 16 darks at 1/50, ISO 100, within 5 K of 21 C");
  EXPECT_EQ(shootInstead(frame, "flat"),
            "shoot 16 flats at 1/50, ISO 100, lit by key: keep the exposure and dim the light");
}

}  // namespace
}  // namespace patina::calibration
