// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/libcamera/found_camera.h"

#include <gmock/gmock.h>

namespace patina::devices::libcamera {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Pair;

AttachedCamera module() {
  return {"/base/soc/i2c0mux/i2c@1/imx477@1a",
          "imx477",
          "v0.0.3",
          "ready",
          {{"processed", {{"BGR888", {{640, 480}}, {}, {}}}},
           {"raw", {{"SRGGB12_CSI2P", {{4056, 3040}}, {}, {}}}}},
          {{"analogue gain", "1 to 22"}},
          true};
}

TEST(FoundCamera, IsToldWithItsIdItsFilesAndItsControls) {
  const FoundDevice found = describe(module());
  EXPECT_EQ(found.kind, "camera");
  EXPECT_EQ(found.backend, "libcamera");
  EXPECT_EQ(found.serial, "/base/soc/i2c0mux/i2c@1/imx477@1a");
  EXPECT_EQ(found.state, "ready");
  EXPECT_THAT(found.choices, ElementsAre(Pair("format", ElementsAre("png", "jpg", "dng"))));
  EXPECT_THAT(found.facts, Contains(Pair("raw", "SRGGB12_CSI2P 4056x3040")));
  EXPECT_THAT(found.facts, Contains(Pair("analogue gain", "1 to 22")));
  EXPECT_THAT(found.troubles, IsEmpty());
}

TEST(FoundCamera, WithoutControlOfTheExposureItSaysWhatToWrite) {
  AttachedCamera camera = module();
  camera.has_exposure = false;
  const FoundDevice found = describe(camera);
  ASSERT_EQ(found.troubles.size(), 1u);
  EXPECT_FALSE(found.troubles[0].fatal);
  EXPECT_THAT(found.troubles[0].do_this, HasSubstr("fixed_exposure"));
}

TEST(FoundCamera, OnUsbItIsForAnotherBackend) {
  AttachedCamera camera = module();
  camera.id = "\\_SB_.PCI0.XHC_.RHUB.HS03-3:1.0-046d:0825";
  const FoundDevice found = describe(camera);
  ASSERT_EQ(found.troubles.size(), 1u);
  EXPECT_TRUE(found.troubles[0].fatal);
  EXPECT_THAT(found.troubles[0].do_this, HasSubstr("v4l2"));
}

TEST(FoundCamera, BusyItSaysHowToFindWhoHasIt) {
  AttachedCamera camera = module();
  camera.state = "busy";
  const FoundDevice found = describe(camera);
  ASSERT_EQ(found.troubles.size(), 1u);
  EXPECT_THAT(found.troubles[0].do_this, HasSubstr("fuser"));
}

TEST(FoundCamera, ALibraryThatDoesNotStartIsTold) {
  const FoundDevice found = libraryThatDoesNotStart("Permission denied");
  EXPECT_THAT(found.state, HasSubstr("Permission denied"));
  EXPECT_EQ(found.troubles.size(), 1u);
}

}  // namespace
}  // namespace patina::devices::libcamera
