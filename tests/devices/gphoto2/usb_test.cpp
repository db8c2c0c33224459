// SPDX-License-Identifier: GPL-3.0-or-later
// The driver on USB: real libusb and libgphoto2 below it, a simulated bus below those.
#include "tests/devices/gphoto2/bench.h"
#include "tests/support/usb/usb_camera.h"

namespace patina::devices::gphoto2 {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;
using testing::UsbBus;
using testing::UsbCamera;

// One a process: programs look at it from the first call on.
UsbBus& bus() {
  static UsbBus* const kBus = new UsbBus;
  return *kBus;
}

class OnUsb : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!UsbBus::isThere()) GTEST_SKIP() << "not run by umockdev-wrapper";
    bus();
  }
  std::unique_ptr<Camera> driverFor(const std::string& number) {
    CameraSpec spec;
    spec.id = "cam0";
    spec.backend = "gphoto2";
    spec.serial = number;
    spec.settings = {{"format", "jpeg"}, {"cycle", "0.2s"}};
    return makeCamera(spec, "rig.toml", clock_);
  }
  Result<std::vector<RawFrame>> shoot(Camera& driver, Nanoseconds deadline = 5s) {
    const auto ticket = driver.trigger({"shot", ++sequence_});
    if (!ticket) return tl::make_unexpected(ticket.error());
    return driver.collect(*ticket, clock_.mono() + deadline);
  }
  static bool took(const Dslr& camera, const std::vector<RawFrame>& frames) {
    for (const TruePicture& taken : camera.truth().pictures)
      for (const auto& file : taken.files)
        if (file.hash == sha256(frames.front().bytes)) return true;
    return false;
  }

  RealClock clock_;
  std::uint64_t sequence_ = 0;
};

TEST_F(OnUsb, ShootsAndDeletes) {
  Dslr camera(twin::dslr::dslrWorld(clock_), serial("1001"));
  const UsbCamera usb(bus(), camera, 1);
  const auto driver = driverFor("1001");
  ASSERT_THAT(driver->recover(Rung::kReopen), IsOk());
  ASSERT_THAT(driver->configure({}), IsOk());
  const auto frames = shoot(*driver);
  ASSERT_THAT(frames, IsOk());
  EXPECT_TRUE(took(camera, *frames));
  ASSERT_THAT(driver->release(frames->front()), IsOk());
  EXPECT_TRUE(camera.truth().pictures.at(0).files.at(0).deleted_utc);
}

// Each comes back where the other was.
TEST_F(OnUsb, SwappedCablesChangeNoFramesOwner) {
  Dslr a(twin::dslr::dslrWorld(clock_), serial("1001")),
      b(twin::dslr::dslrWorld(clock_), serial("1002"));
  UsbCamera usb_a(bus(), a, 1), usb_b(bus(), b, 2);
  const auto first = driverFor("1001"), second = driverFor("1002");
  ASSERT_THAT(first->recover(Rung::kReopen), IsOk());
  ASSERT_THAT(second->recover(Rung::kReopen), IsOk());
  usb_a.unplug();
  usb_b.unplug();
  usb_b.plugIn(1);
  usb_a.plugIn(2);
  EXPECT_THAT(shoot(*first), Fails(Errc::kLost));
  EXPECT_THAT(shoot(*second), Fails(Errc::kLost));
  ASSERT_THAT(first->recover(Rung::kReopen), IsOk());
  ASSERT_THAT(second->recover(Rung::kReopen), IsOk());
  const auto of_first = shoot(*first), of_second = shoot(*second);
  ASSERT_THAT(of_first, IsOk());
  ASSERT_THAT(of_second, IsOk());
  EXPECT_TRUE(took(a, *of_first));
  EXPECT_TRUE(took(b, *of_second));
}

TEST_F(OnUsb, WithoutASerialSeveralAreRefusedAndListed) {
  Dslr a(twin::dslr::dslrWorld(clock_), serial("1001")),
      b(twin::dslr::dslrWorld(clock_), serial("1002"));
  const UsbCamera usb_a(bus(), a, 1), usb_b(bus(), b, 2);
  const auto up = driverFor("")->recover(Rung::kReopen);
  ASSERT_THAT(up, Fails(Errc::kRefused));
  EXPECT_THAT(up.error().what, HasSubstr("1001"));
  EXPECT_THAT(up.error().what, HasSubstr("1002"));
}

TEST_F(OnUsb, NothingAttachedSaysWhatToLookAt) {
  const auto up = driverFor("1001")->recover(Rung::kReopen);
  ASSERT_THAT(up, Fails(Errc::kLost));
  EXPECT_THAT(up.error().what, HasSubstr("is it on, is its cable in?"));
}

TEST_F(OnUsb, IsFoundWithItsSerial) {
  Dslr camera(twin::dslr::dslrWorld(clock_), serial("1001"));
  const UsbCamera usb(bus(), camera, 1);
  const auto found = find(clock_);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].serial, "1001");
  EXPECT_EQ(found[0].address, usb.gphotoPort());
  EXPECT_EQ(found[0].state, "ready");
}

}  // namespace
}  // namespace patina::devices::gphoto2
