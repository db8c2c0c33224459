// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/driver_notes.h"

#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/support/temp_folder.h"

namespace patina::devices {
namespace {

class DriverNotes : public ::testing::Test {
 protected:
  void SetUp() override { ::setenv(kDriverNotes, folder_.path().c_str(), 1); }
  void TearDown() override { ::unsetenv(kDriverNotes); }
  testing::TempFolder folder_ = testing::TempFolder::inMemory();
};

TEST_F(DriverNotes, AreReadAsTheLastOneWasWritten) {
  EXPECT_FALSE(driverNote("clock of 1001"));
  noteForDriver("clock of 1001", "first");
  noteForDriver("clock of 1001", "second\n");
  EXPECT_EQ(driverNote("clock of 1001"), "second\n");
  EXPECT_FALSE(driverNote("clock of 1002"));
}

TEST_F(DriverNotes, StayInTheirFolderWhateverADeviceCallsItself) {
  noteForDriver("../../etc/1001", "text");
  EXPECT_EQ(driverNote("../../etc/1001"), "text");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_.path()), {}), 1);
}

TEST_F(DriverNotes, WithoutAFolderThereAreNone) {
  ::unsetenv(kDriverNotes);
  noteForDriver("clock", "text");
  EXPECT_FALSE(driverNote("clock"));
}

}  // namespace
}  // namespace patina::devices
