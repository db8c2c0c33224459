// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/v4l2/v4l2.h"
#include "tests/devices/v4l2/attached_camera.h"

namespace patina::testing {
namespace {

using namespace patina::devices;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Pair;

using Find = V4l2Fixture;

std::string troublesOf(const FoundDevice& found) {
  std::string all;
  for (const Trouble& trouble : found.troubles) all += trouble.what + "; ";
  return all;
}

TEST_F(Find, ThereIsNothingWithoutACamera) { EXPECT_THAT(v4l2::find(), IsEmpty()); }

TEST_F(Find, TellsWhatARigFileNeeds) {
  testbed().plugIn(webcam, 2, 1);
  const auto all = v4l2::find();
  ASSERT_EQ(all.size(), 1u);
  const FoundDevice& found = all[0];
  EXPECT_EQ(found.kind, "camera");
  EXPECT_EQ(found.backend, "v4l2");
  EXPECT_EQ(found.serial, "SIM0001");
  EXPECT_EQ(found.address, "/dev/video2");
  EXPECT_EQ(found.state, "ready");
  EXPECT_THAT(found.choices, Contains(Pair("format", ElementsAre("yuyv", "mjpeg"))));
  EXPECT_THAT(found.choices, Contains(Pair("size (yuyv)", ElementsAre("32x24", "64x48"))));
  EXPECT_THAT(found.choices, Contains(Pair("focus", ElementsAre("0 to 250 in steps of 5"))));
  EXPECT_THAT(found.facts, Contains(Pair("gain", "10")));
  EXPECT_THAT(troublesOf(found), HasSubstr("automatic: White Balance"));
}

TEST_F(Find, ASickOneSaysSoAndTheOtherIsStillFound) {
  SimulatedCamera sick(clock);
  sick.serial = "SIM0002";
  testbed().plugIn(sick, 0, 1);
  testbed().plugIn(webcam, 1, 2);
  sick.fails = {{VIDIOC_QUERYCAP, EPROTO}};
  webcam.fails = {{VIDIOC_REQBUFS, EBUSY}};
  const auto all = v4l2::find();
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].state, "does not answer");
  EXPECT_TRUE(all[0].troubles.at(0).fatal);
  EXPECT_EQ(all[1].state, "busy");
}

TEST_F(Find, WithoutAControlOfTheExposureTheRigMustSayIt) {
  webcam.controls.remove(V4L2_CID_EXPOSURE_ABSOLUTE);
  testbed().plugIn(webcam, 0, 1);
  EXPECT_THAT(troublesOf(v4l2::find().at(0)), HasSubstr("no control of its exposure"));
}

TEST_F(Find, TwoOfOneSerialHaveNone) {
  SimulatedCamera twin(clock);
  testbed().plugIn(webcam, 0, 1);
  testbed().plugIn(twin, 1, 2);
  for (const FoundDevice& found : v4l2::find()) {
    EXPECT_EQ(found.serial, "");
    EXPECT_THAT(troublesOf(found), HasSubstr("same serial"));
  }
}

}  // namespace
}  // namespace patina::testing
