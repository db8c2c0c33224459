// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/daemon/ack_log.h"

#include <gtest/gtest.h>

#include "capture/failure.h"
#include "tests/support/temp_folder.h"

namespace patina::daemon {
namespace {

TEST(AckLog, WritesALineAFrame) {
  const testing::TempFolder folder = testing::TempFolder::inMemory();
  db::FrameRow frame;
  frame.shot_id = 7;
  frame.bytes = 12;
  {
    const AckLog log(folder / "acks");
    log.take("run", frame);
    log.take("run", frame);
  }
  const std::string line = "ack run 7 0 " + std::string(64, '0') + " 12\n";
  EXPECT_EQ(testing::readFile(folder / "acks"), line + line);
}

TEST(AckLog, WithoutAPlaceItSaysNothing) { AckLog("").take("run", {}); }

TEST(AckLog, APlaceThatCannotBeWrittenIsRefusedAtOnce) {
  EXPECT_THROW(AckLog("/no/such/folder/acks"), capture::CaptureError);
}

}  // namespace
}  // namespace patina::daemon
