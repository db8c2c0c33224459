// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/gphoto2/usb_bus.h"

#include <gmock/gmock.h>

#include "tests/support/temp_folder.h"

namespace patina::devices::gphoto2 {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using testing::TempFolder;

TEST(UsbBus, APortNamesItsNode) {
  EXPECT_EQ(usbNode("usb:001,014"), fs::path("/dev/bus/usb/001/014"));
  for (const char* none : {"usb:", "usb:1", "ptpip:1.2.3.4:1:1", "usb:a,b", "usb:001,000"})
    EXPECT_EQ(usbNode(none), std::nullopt) << none;
}

TEST(UsbBus, TheSerialIsThatOfTheDeviceAtItsPlace) {
  const TempFolder sysfs = TempFolder::inMemory();
  const auto add = [&](const std::string& name, const std::string& bus, const std::string& device,
                       const std::string& serial) {
    fs::create_directories(sysfs.path() / name);
    testing::writeFile(sysfs.path() / name / "busnum", bus + "\n");
    testing::writeFile(sysfs.path() / name / "devnum", device + "\n");
    testing::writeFile(sysfs.path() / name / "serial", serial + "\n");
  };
  add("1-1", "1", "14", "AAA");
  add("1-2", "1", "15", "BBB");
  EXPECT_EQ(usbSerial("usb:001,015", sysfs.path()), "BBB");
  EXPECT_EQ(usbSerial("usb:001,016", sysfs.path()), "");
  EXPECT_EQ(usbSerial("usb:001,015", "/nowhere"), "");
}

// A /proc of one process that has the node open, and one that has not.
TEST(UsbBus, WhoHoldsANodeIsNamedWithWhatToDo) {
  const TempFolder proc = TempFolder::inMemory();
  const auto process = [&](const std::string& pid, const std::string& name,
                           const std::string& open) {
    fs::create_directories(proc.path() / pid / "fd");
    testing::writeFile(proc.path() / pid / "comm", name + "\n");
    fs::create_symlink(open, proc.path() / pid / "fd" / "7");
  };
  process("812", "gvfsd-gphoto2", "/dev/bus/usb/001/014");
  process("813", "bash", "/dev/null");
  process("814", "mytool", "/dev/bus/usb/001/014");
  const auto holders = holdersOf("/dev/bus/usb/001/014", proc.path());
  ASSERT_EQ(holders.size(), 2u);
  const std::string text = describe(holders);
  EXPECT_THAT(text, HasSubstr("gvfsd-gphoto2 (pid 812)"));
  EXPECT_THAT(text, HasSubstr("gio mount -s gphoto2"));
  EXPECT_THAT(text, HasSubstr("mytool (pid 814)"));
  EXPECT_TRUE(holdersOf("/dev/bus/usb/001/015", proc.path()).empty());
}

}  // namespace
}  // namespace patina::devices::gphoto2
