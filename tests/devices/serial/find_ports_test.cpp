// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include "devices/serial/serial.h"
#include "tests/support/temp_folder.h"

namespace patina::devices::serial {
namespace {

TEST(FindPorts, NamesEachPortByWhatStaysAndWhereItIsNow) {
  const patina::testing::TempFolder root;
  std::filesystem::create_directories(root / "dev/serial/by-id");
  patina::testing::writeFile(root / "dev/ttyUSB3", "");
  std::filesystem::create_symlink("../../ttyUSB3", root / "dev/serial/by-id/usb-FTDI_A1");
  const auto found = find(root.path());
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].kind, "port");
  EXPECT_EQ(found[0].serial, "/dev/serial/by-id/usb-FTDI_A1");
  EXPECT_EQ(found[0].address, "/dev/ttyUSB3");
  EXPECT_EQ(found[0].state, "ready");
}

TEST(FindPorts, IsEmptyWhereThereAreNone) {
  const patina::testing::TempFolder root;
  EXPECT_TRUE(find(root.path()).empty());
}

TEST(FindPorts, SaysWhatToDoAboutAPortThatCannotBeOpened) {
  const patina::testing::TempFolder root;
  std::filesystem::create_directories(root / "dev/serial/by-id");
  std::filesystem::create_symlink("../../ttyUSB9", root / "dev/serial/by-id/usb-gone");
  const auto found = find(root.path());
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].address, "");
  ASSERT_EQ(found[0].troubles.size(), 1u);
  EXPECT_TRUE(found[0].troubles[0].fatal);
}

}  // namespace
}  // namespace patina::devices::serial
