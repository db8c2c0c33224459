// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/usb/node_holders.h"

#include <gmock/gmock.h>

#include "tests/support/temp_folder.h"

namespace patina::devices::usb {
namespace {

using patina::testing::TempFolder;

TEST(NodeHolders, AreTheProcessesWithTheNodeOpen) {
  const TempFolder proc;
  const std::string node = "/dev/bus/usb/001/014";
  const auto add = [&](const std::string& pid, const std::string& comm, const std::string& target) {
    std::filesystem::create_directories(proc / pid / "fd");
    patina::testing::writeFile(proc / pid / "comm", comm + "\n");
    std::filesystem::create_symlink(target, proc / pid / "fd/7");
  };
  add("900101", "gvfsd-gphoto2", node);
  add("900102", "bash", "/dev/null");
  std::filesystem::create_directories(proc / "sys");
  const auto holders = holdersOf(node, proc.path());
  ASSERT_EQ(holders.size(), 1u);
  EXPECT_EQ(holders[0].pid, 900101);
  EXPECT_EQ(holders[0].command, "gvfsd-gphoto2");
}

}  // namespace
}  // namespace patina::devices::usb
