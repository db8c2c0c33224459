// SPDX-License-Identifier: GPL-3.0-or-later
#include "db/catalogue_write.h"

#include <gtest/gtest.h>

#include "db/failure.h"
#include "db/schema.h"
#include "tests/db/small_run.h"

namespace patina::db::testing {
namespace {

class CatalogueWriteTest : public ::testing::Test {
 protected:
  CatalogueWriteTest() {
    createTables(database_);
    step_.id = 3;
    shot_ = shotRow(step_);
    shot_.id = 5;
    writer_.insert(step_);
    writer_.insert(shot_);
  }
  struct Ready : Database {
    Ready() : Database(Scratch{}) { createTables(*this); }
  };
  Ready database_;
  CatalogueWriter writer_{database_};
  StepRow step_ = stepRow(0);
  ShotRow shot_;
};

TEST_F(CatalogueWriteTest, AShotIsSettledOnce) {
  shot_.state = ShotState::kCaptured;
  writer_.settleShot(shot_);
  EXPECT_THROW(writer_.settleShot(shot_), ArchiveError);
}

TEST_F(CatalogueWriteTest, OnlyTheVeryShotThatWasArmedIsSettled) {
  ShotRow other = shot_;
  other.state = ShotState::kCaptured;
  other.light_state = "fill";
  EXPECT_THROW(writer_.settleShot(other), ArchiveError);
  other = shot_;
  other.attempt = 7;
  EXPECT_THROW(writer_.settleShot(other), ArchiveError);
}

TEST_F(CatalogueWriteTest, AStepThatWasNeverBegunCannotEnd) {
  step_.decision = Decision::kCaptured;
  writer_.finishStep(step_);
  step_.id = 4;
  EXPECT_THROW(writer_.finishStep(step_), ArchiveError);
}

TEST_F(CatalogueWriteTest, AReplayedRowReplacesItself) {
  step_.reason = "light key+0.051";
  writer_.replay(step_);
  writer_.replay(step_);
  EXPECT_EQ(database_.number("SELECT count(*) FROM step"), 1);
  Statement reason(database_, "SELECT reason FROM step");
  ASSERT_TRUE(reason.step());
  EXPECT_EQ(reason.text(0), "light key+0.051");
}

TEST_F(CatalogueWriteTest, MarksAndIdsGoOn) {
  EXPECT_EQ(writer_.markOf("run"), 0);
  writer_.mark("run", 10);
  writer_.mark("run", 25);
  EXPECT_EQ(writer_.markOf("run"), 25);
  EXPECT_EQ(writer_.nextId("shot"), 6);
  EXPECT_EQ(writer_.nextId("frame"), 1);
}

}  // namespace
}  // namespace patina::db::testing
