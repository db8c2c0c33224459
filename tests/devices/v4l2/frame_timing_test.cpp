// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/v4l2/frame_timing.h"

#include <gtest/gtest.h>

namespace patina::devices::v4l2 {
namespace {

using namespace std::chrono_literals;
using Verdict = FrameGate::Verdict;

ExposureWindow beganAt(Nanoseconds at) { return {at, at + 5ms}; }

TEST(ExposureWindow, OfAStampOfTheEndTakesOffReadoutAndExposure) {
  const ExposureWindow window = exposureWindow({1000ms, false}, 20ms, 40ms, 0);
  EXPECT_EQ(window.began, 940ms);
  EXPECT_EQ(window.middle, 970ms);
}

TEST(ExposureWindow, OfAStampOfTheStartIsTheExposureBeforeIt) {
  const ExposureWindow window = exposureWindow({1000ms, true}, 20ms, 40ms, 0);
  EXPECT_EQ(window.began, 980ms);
  EXPECT_EQ(window.middle, 990ms);
}

TEST(ExposureWindow, FramesThatTheCameraHoldsBackMakeItOlder) {
  EXPECT_EQ(exposureWindow({1000ms, true}, 20ms, 40ms, 2).began, 900ms);
}

TEST(FrameGate, TakesOnlyWhatBeganAfterTheTrigger) {
  FrameGate gate;
  gate.streamStarted(0);
  gate.triggered(100ms);
  EXPECT_EQ(gate.judge(0, beganAt(99ms)), Verdict::kTooEarly);
  EXPECT_EQ(gate.judge(1, beganAt(100ms)), Verdict::kTake);
}

TEST(FrameGate, TheFirstFramesOfAStreamWarmUp) {
  FrameGate gate;
  gate.streamStarted(2);
  EXPECT_EQ(gate.judge(0, beganAt(1ms)), Verdict::kWarmingUp);
  EXPECT_EQ(gate.judge(1, beganAt(2ms)), Verdict::kWarmingUp);
  EXPECT_EQ(gate.judge(2, beganAt(3ms)), Verdict::kTake);
}

TEST(FrameGate, FramesFromBeforeASettingDoNotCountAsSettled) {
  FrameGate gate;
  gate.streamStarted(0);
  gate.settingsChanged(10ms, 1);
  EXPECT_EQ(gate.judge(0, beganAt(8ms)), Verdict::kSettling);
  EXPECT_EQ(gate.judge(1, beganAt(9ms)), Verdict::kSettling);
  EXPECT_EQ(gate.judge(2, beganAt(10ms)), Verdict::kSettling);
  EXPECT_EQ(gate.judge(3, beganAt(11ms)), Verdict::kTake);
}

TEST(FrameGate, CountsGapsOnceAndNotThoseOfAPause) {
  FrameGate gate;
  gate.streamStarted(0);
  gate.judge(5, beganAt(1ms));
  gate.judge(9, beganAt(2ms));
  EXPECT_EQ(gate.takeLost(), 3u);
  EXPECT_EQ(gate.takeLost(), 0u);
  gate.pause();
  gate.judge(100, beganAt(3ms));
  EXPECT_EQ(gate.takeLost(), 0u);
}

TEST(FrameGate, ACountThatWrapsOrStartsAgainIsNoLoss) {
  FrameGate gate;
  gate.streamStarted(0);
  gate.judge(0xFFFFFFFFu, beganAt(1ms));
  gate.judge(0, beganAt(2ms));
  gate.judge(7, beganAt(3ms));
  gate.judge(0, beganAt(4ms));
  EXPECT_EQ(gate.takeLost(), 6u);
}

}  // namespace
}  // namespace patina::devices::v4l2
