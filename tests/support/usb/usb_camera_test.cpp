// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/usb/usb_camera.h"

#include <gtest/gtest.h>

#include "tests/devices/twin/dslr/dslr_bench.h"
#include "tests/support/child.h"

namespace patina::testing {
namespace {

using namespace devices::twin::dslr;

class UsbCameraTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(kProgram)) GTEST_SKIP() << "gphoto2 is not installed";
  }
  Finished gphoto2(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), kProgram);
    return run(arguments, {"HOME=" + home_.path().string(), "LC_ALL=C", "TZ=UTC"});
  }
  static constexpr const char* kProgram = "/usr/bin/gphoto2";
  TempFolder home_ = TempFolder::inMemory();
  devices::RealClock clock_;
  Dslr body_{dslrWorld(clock_), {}};
  UsbBus bus_;
  UsbCamera usb_{bus_, body_, 1};
};

TEST_F(UsbCameraTest, IsDetected) {
  const auto done = gphoto2({"--auto-detect"});
  std::puts(done.out.c_str());
  std::puts(done.err.c_str());
  const auto more = gphoto2({"--summary"});
  std::puts(more.out.c_str());
  std::puts(more.err.c_str());
}

TEST_F(UsbCameraTest, TakesAPicture) {
  const auto done = gphoto2(
      {"--capture-image-and-download", "--filename", (home_.path() / "a.%C").string()});
  std::puts(done.out.c_str());
  std::puts(done.err.c_str());
  EXPECT_EQ(done.exit, 0);
}

}  // namespace
}  // namespace patina::testing
