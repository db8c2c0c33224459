// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/v4l2/frame_format.h"

#include "tests/devices/v4l2/attached_camera.h"

namespace patina::testing {
namespace {

using namespace patina::devices;
using namespace std::chrono_literals;
using ::testing::HasSubstr;

class FrameFormat : public V4l2Fixture {
 protected:
  Result<v4l2::FrameFormat> agreed(std::map<std::string, std::string> settings) {
    if (!plugged_) testbed().plugIn(webcam, 0, 1);
    plugged_ = true;
    const auto node = v4l2::Node::open("/dev/video0", "v4l2 'cam0'");
    return v4l2::setFrameFormat(*node,
                                v4l2::readCameraSettings(spec(std::move(settings)), "rig.toml"));
  }
  bool plugged_ = false;
};

TEST_F(FrameFormat, WithoutASizeIsTheLargest) {
  const auto format = agreed({});
  ASSERT_THAT(format, IsOk());
  EXPECT_EQ(format->size, (SizePx{64, 48}));
  EXPECT_EQ(format->image_bytes, 64u * 48 * 2);
  EXPECT_EQ(format->interval, 10ms);
}

TEST_F(FrameFormat, WhatTheCameraHasNotIsRefusedWithWhatItHas) {
  const auto format = agreed({{"format", "y16"}});
  ASSERT_THAT(format, Fails(Errc::kRefused));
  EXPECT_THAT(format.error().what, HasSubstr("yuyv, mjpeg"));
  const auto size = agreed({{"size", "640x480"}});
  ASSERT_THAT(size, Fails(Errc::kRefused));
  EXPECT_THAT(size.error().what, HasSubstr("32x24, 64x48"));
}

TEST_F(FrameFormat, TheFrameRateIsReadBack) {
  EXPECT_EQ(agreed({{"frames_per_second", "50"}})->interval, 20ms);
  webcam.fails = {{VIDIOC_S_PARM, EINVAL}};
  EXPECT_THAT(agreed({{"frames_per_second", "25"}}), Fails(Errc::kRefused));
}

TEST_F(FrameFormat, ADriverWithoutAFrameRateIsToldIt) {
  webcam.tells_rate = false;
  const auto unknown = agreed({});
  ASSERT_THAT(unknown, Fails(Errc::kRefused));
  EXPECT_THAT(unknown.error().what, HasSubstr("frames_per_second"));
  EXPECT_EQ(agreed({{"frames_per_second", "4"}})->interval, 250ms);
}

TEST_F(FrameFormat, ColoursAreCodedAsTheDriverSays) {
  EXPECT_FALSE(agreed({})->coding.full_range);
  EXPECT_EQ(agreed({})->coding.red_weight, kBt601.red_weight);
  webcam.quantization = V4L2_QUANTIZATION_FULL_RANGE;
  webcam.ycbcr_enc = V4L2_YCBCR_ENC_709;
  EXPECT_TRUE(agreed({})->coding.full_range);
  EXPECT_EQ(agreed({})->coding.red_weight, kBt709.red_weight);
  webcam.quantization = V4L2_QUANTIZATION_DEFAULT;
  webcam.colorspace = V4L2_COLORSPACE_JPEG;
  EXPECT_TRUE(agreed({})->coding.full_range);
}

TEST_F(FrameFormat, GreySamplesAreLinearWhereDriverOrRigSaySo) {
  EXPECT_FALSE(agreed({})->linear);
  EXPECT_TRUE(agreed({{"transfer", "linear"}})->linear);
  webcam.xfer_func = V4L2_XFER_FUNC_NONE;
  EXPECT_TRUE(agreed({})->linear);
  EXPECT_FALSE(agreed({{"transfer", "srgb"}})->linear);
}

}  // namespace
}  // namespace patina::testing
