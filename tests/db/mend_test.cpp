// SPDX-License-Identifier: GPL-3.0-or-later
#include "db/mend.h"

#include <gtest/gtest.h>

#include "db/schema.h"

namespace patina::db::testing {
namespace {

class Mend : public ::testing::Test {
 protected:
  Mend() {
    createTables(catalogue_);
    catalogue_.run(R"sql(
      INSERT INTO step VALUES(1, 'lost-run', 0, 100, 'captured', '', 0, 0, 0, 1, 1),
        (2, 'lost-run', 1, 300, 'captured', '', 0, 0, 0, 1, 1);
      INSERT INTO shot VALUES(1, 1, 'cam0', 'key', 0, 0, 1, 1, 1, 1, 1, 'captured'),
        (2, 99, 'cam0', 'key', 0, 0, 1, 1, 1, 1, 1, 'captured');
      INSERT INTO frame VALUES(1, 'lost-run', 1, 0, 'aa', 'jpg', 1, 1, 1, 1, 1, 1, 0, 0),
        (2, 'lost-run', 2, 0, 'bb', 'jpg', 1, 1, 1, 1, 1, 1, 0, 0);
      INSERT INTO frame_calibration VALUES(2, 7, 0, 0, 1);)sql");
    mendReferences(catalogue_);
  }
  Database catalogue_{Database::Scratch{}};
};

TEST_F(Mend, NoRowRefersToWhatIsNotThere) {
  Statement check(catalogue_, "PRAGMA foreign_key_check");
  EXPECT_FALSE(check.step());
}

TEST_F(Mend, ALostRunIsThereAgainWithItsTimesAndItsDevices) {
  EXPECT_EQ(catalogue_.number("SELECT t0_utc_ns FROM run WHERE id = 'lost-run'"), 100);
  EXPECT_EQ(catalogue_.number("SELECT duration_ns FROM run WHERE state = 'recovered'"), 200);
  EXPECT_EQ(catalogue_.number("SELECT count(*) FROM device WHERE kind = 'camera'"), 1);
}

TEST_F(Mend, AShotWithoutItsStepGoesWithItsFrameRow) {
  EXPECT_EQ(catalogue_.number("SELECT count(*) FROM frame"), 1);
  EXPECT_EQ(catalogue_.number("SELECT count(*) FROM shot"), 1);
  EXPECT_EQ(catalogue_.number("SELECT count(*) FROM frame_calibration"), 0);
}

}  // namespace
}  // namespace patina::db::testing
