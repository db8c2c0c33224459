// SPDX-License-Identifier: GPL-3.0-or-later
// The gphoto2 command line against the virtual DSLR over PTP/IP, as a user would run it.
#include <gtest/gtest.h>

#include "devices/twin/dslr/ptpip_server.h"
#include "tests/devices/twin/dslr/dslr_bench.h"
#include "tests/support/child.h"

namespace patina::devices::twin::dslr {
namespace {

class Gphoto2 : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(kProgram)) GTEST_SKIP() << "gphoto2 is not installed";
  }
  testing::Finished gphoto2(std::vector<std::string> arguments) {
    std::vector<std::string> command = {kProgram, "--port", server_.gphotoPort()};
    command.insert(command.end(), arguments.begin(), arguments.end());
    return testing::run(command, {"HOME=" + home_.path().string(), "LC_ALL=C", "TZ=UTC"});
  }

  static constexpr const char* kProgram = "/usr/bin/gphoto2";
  testing::TempFolder home_ = testing::TempFolder::inMemory();
  RealClock clock_;
  Dslr camera_{dslrWorld(clock_), {}};
  PtpIpServer server_{camera_};
};

TEST_F(Gphoto2, ReadsTheSummary) {
  const auto done = gphoto2({"--summary"});
  EXPECT_EQ(done.exit, 0) << done.err;
  EXPECT_NE(done.out.find("Patina DSLR"), std::string::npos) << done.out;
  EXPECT_NE(done.out.find("Serial Number: 1001"), std::string::npos) << done.out;
  std::puts(done.out.c_str());
}

TEST_F(Gphoto2, ListsItsConfiguration) {
  const auto done = gphoto2({"--list-all-config"});
  EXPECT_EQ(done.exit, 0) << done.err;
  std::puts(done.out.c_str());
}

TEST_F(Gphoto2, TakesAPicture) {
  const auto done = gphoto2({"--capture-image-and-download", "--filename", (home_.path() / "a.%C").string()});
  EXPECT_EQ(done.exit, 0) << done.err;
  std::puts(done.out.c_str());
  std::puts(done.err.c_str());
}

}  // namespace
}  // namespace patina::devices::twin::dslr
