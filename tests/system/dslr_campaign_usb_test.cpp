// SPDX-License-Identifier: GPL-3.0-or-later
// Over a simulated USB cable. PATINA_DSLR_SHOTS, PATINA_DSLR_SEED: see dslr_campaign.h.
#include "tests/support/usb/usb_camera.h"
#include "tests/system/dslr_campaign.h"

namespace patina::testing {
namespace {

TEST_P(DslrCampaign, NoPictureIsLostDoubledOrMisplacedOnUsbEither) {
  if (!UsbBus::isThere()) GTEST_SKIP() << "not run by umockdev-wrapper";
  misbehaveThroughout(true);
}

INSTANTIATE_TEST_SUITE_P(Seeds, DslrCampaign, ::testing::Range(0, 2));

}  // namespace
}  // namespace patina::testing
