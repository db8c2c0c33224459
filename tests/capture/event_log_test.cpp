// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/event_log.h"

#include <gtest/gtest.h>

namespace patina::capture {
namespace {

std::string hashOf(double level, db::Decision decision, unsigned char first_byte) {
  EventLog log;
  db::LightCheckRow check;
  check.level = level;
  log.checks({&check, 1});
  db::FrameRow frame;
  frame.sha256.bytes[0] = first_byte;
  log.frame(db::ShotRow{}, frame);
  db::StepRow step;
  step.number = 7;
  step.decision = decision;
  log.step(step);
  return log.finish();
}

TEST(EventLog, HashesDecisionsVerdictsAndFrames) {
  const std::string hash = hashOf(0.4, db::Decision::kCaptured, 1);
  EXPECT_EQ(hash, hashOf(0.4, db::Decision::kCaptured, 1));
  EXPECT_NE(hash, hashOf(0.4 + 1e-16, db::Decision::kCaptured, 1));
  EXPECT_NE(hash, hashOf(0.4, db::Decision::kHeld, 1));
  EXPECT_NE(hash, hashOf(0.4, db::Decision::kCaptured, 2));
}

TEST(EventLog, LeavesWallTimeOut) {
  EventLog a, b;
  db::StepRow step;
  a.step(step);
  step.due_utc = parseUtc("2024-05-01");
  b.step(step);
  EXPECT_EQ(a.finish(), b.finish());
}

}  // namespace
}  // namespace patina::capture
