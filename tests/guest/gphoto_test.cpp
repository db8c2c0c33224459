// SPDX-License-Identifier: GPL-3.0-or-later
// The backend gphoto2 on the virtual DSLR behind the kernel's own USB stack.
#include <gmock/gmock.h>

#include "devices/gphoto2/gphoto2.h"
#include "processing/image/sha256.h"
#include "tests/devices/twin/dslr/dslr_bench.h"
#include "tests/guest/dslr_gadget.h"
#include "tests/support/matchers.h"

namespace patina::testing {
namespace {

using namespace patina::devices;
using namespace patina::devices::twin::dslr;
using namespace std::chrono_literals;

DslrOptions serial(const std::string& number) {
  DslrOptions options;
  options.serial = number;
  return options;
}

class DslrInTheKernel : public ::testing::Test {
 protected:
  void SetUp() override {
    gadget_.usb().plugIn();
    CameraSpec spec;
    spec.id = "cam0";
    spec.backend = "gphoto2";
    spec.serial = "1001";
    spec.settings = {{"format", "jpeg"}};
    driver_ = gphoto2::makeCamera(spec, "rig.toml", clock_);
    ASSERT_THAT(comesUp(Rung::kReopen), IsOk());
  }
  // The kernel and the library take their time over a new device.
  Result<void> comesUp(Rung rung) {
    Result<void> up = driver_->recover(rung);
    for (const MonoTime end = clock_.mono() + 120s; !up && clock_.mono() < end;) {
      clock_.sleepUntil(clock_.mono() + 500ms, {});
      up = driver_->recover(Rung::kReopen);
    }
    if (!up) return up;
    const auto applied = driver_->configure({});
    if (!applied) return tl::make_unexpected(applied.error());
    return {};
  }
  Result<std::vector<RawFrame>> shoot(std::uint64_t sequence, Nanoseconds patience = 60s) {
    told_ = clock_.mono();
    const auto ticket = driver_->trigger({"shot " + std::to_string(sequence), sequence});
    if (!ticket) return tl::make_unexpected(ticket.error());
    return driver_->collect(*ticket, clock_.mono() + patience);
  }
  // Its file is of a picture that was really exposed after the trigger.
  void expectOurs(const std::vector<RawFrame>& frames) {
    ASSERT_EQ(frames.size(), 1u);
    const Truth truth = camera_.truth();
    const auto hash = sha256(frames[0].bytes);
    for (const TruePicture& picture : truth.pictures) {
      if (picture.files.empty() || picture.files[0].hash != hash) continue;
      EXPECT_FALSE(picture.stale);
      EXPECT_GE(picture.begin_mono, told_);
      return;
    }
    ADD_FAILURE() << "no picture of the camera has these bytes";
  }
  void expectGoodShot(std::uint64_t sequence) {
    const auto frames = shoot(sequence);
    ASSERT_THAT(frames, IsOk());
    expectOurs(*frames);
    for (const RawFrame& frame : *frames) EXPECT_THAT(driver_->release(frame), IsOk());
  }

  RealClock clock_;
  Dslr camera_{dslrWorld(clock_), serial("1001")};
  DslrGadget gadget_{camera_};
  std::unique_ptr<Camera> driver_;
  MonoTime told_;
};

TEST_F(DslrInTheKernel, TenShotsAreTenPicturesByteForByte) {
  for (std::uint64_t i = 1; i <= 10; ++i) {
    SCOPED_TRACE(i);
    expectGoodShot(i);
  }
  EXPECT_EQ(camera_.truth().pictures.size(), 10u);
}

TEST_F(DslrInTheKernel, AStallInATransferEndsAtTheDeadlineAndNothingIsTakenForAPicture) {
  expectGoodShot(1);
  camera_.order({.kind = DslrFaultKind::kStall,
                 .operation = Operation::kGetObject,
                 .duration = 30s,
                 .amount = 0.5});
  EXPECT_THAT(shoot(2, 10s), ::testing::Not(IsOk()));
  ASSERT_THAT(comesUp(Rung::kReset), IsOk());
  expectGoodShot(3);
}

TEST_F(DslrInTheKernel, UnpluggedItIsLostAndComesBackByItsSerial) {
  expectGoodShot(1);
  gadget_.usb().unplug();
  EXPECT_THAT(shoot(2, 10s), ::testing::Not(IsOk()));
  EXPECT_THAT(driver_->recover(Rung::kReopen), Fails(Errc::kLost));
  gadget_.usb().plugIn();
  ASSERT_THAT(comesUp(Rung::kReopen), IsOk());
  expectGoodShot(3);
}

}  // namespace
}  // namespace patina::testing
