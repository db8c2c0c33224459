// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/rig/camera_rungs.h"

#include <gtest/gtest.h>

namespace patina::rig {
namespace {

devices::host::Rungs rungsIn(const std::string& camera) {
  static devices::RealClock clock;
  const devices::RigSpec rig = devices::parseRig(
      "[[camera]]\nid = \"cam0\"\n" + camera +
          "[[power]]\nid = \"plug\"\nbackend = \"serial\"\naddress = \"/dev/serial/by-id/plug\"\n"
          "settings = { on = \"1\", off = \"0\" }\n",
      "rig.toml");
  return rungsOf(rig.cameras[0], rig, clock);
}

TEST(CameraRungs, ACameraOnUsbCanBeResetWhenItIsKnownBySerial) {
  EXPECT_TRUE(rungsIn("backend = \"gphoto2\"\nserial = \"77\"\n").reset);
  EXPECT_FALSE(rungsIn("backend = \"gphoto2\"\n").reset);
  EXPECT_FALSE(
      rungsIn("backend = \"gphoto2\"\nserial = \"77\"\nsettings = { host = \"10.0.0.2\" }\n")
          .reset);
  EXPECT_FALSE(rungsIn("backend = \"network\"\nserial = \"77\"\n").reset);
}

TEST(CameraRungs, PowerIsCycledOnlyWhereTheRigSaysHow) {
  EXPECT_FALSE(rungsIn("backend = \"gphoto2\"\nserial = \"77\"\n").power_cycle);
  EXPECT_TRUE(rungsIn("backend = \"gphoto2\"\nserial = \"77\"\npower = \"hub\"\n").power_cycle);
  EXPECT_TRUE(rungsIn("backend = \"network\"\npower = \"plug\"\n").power_cycle);
}

TEST(CameraRungs, AResetOfACameraThatIsGoneIsALoss) {
  const auto done = rungsIn("backend = \"gphoto2\"\nserial = \"no such serial\"\n").reset();
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().code, devices::Errc::kLost);
}

}  // namespace
}  // namespace patina::rig
