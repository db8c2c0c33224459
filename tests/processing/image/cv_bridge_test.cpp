// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/image/cv_bridge.h"

#include <gtest/gtest.h>

namespace patina {
namespace {

TEST(CvBridge, SharesTexelsBothWaysWithoutACopy) {
  Image<float> image(8, 6, 3, 0.5f);
  cv::Mat mat = asMat(image.view());
  EXPECT_EQ(mat.data, reinterpret_cast<unsigned char*>(image.texels().data()));
  EXPECT_EQ(mat.size(), cv::Size(8, 6));
  EXPECT_EQ(mat.type(), CV_32FC3);
  mat.at<cv::Vec3f>(2, 5)[1] = 7;
  EXPECT_EQ(image.at(5, 2, 1), 7);
  const ImageView<float> back = viewOf<float>(mat);
  EXPECT_EQ(back.data, image.texels().data());
  EXPECT_EQ(back.row_stride, 24);
}

TEST(CvBridge, KeepsTheStrideOfACrop) {
  Image<std::uint16_t> image(8, 6, 1);
  image.at(3, 4) = 9;
  const cv::Mat mat = asMat(image.view().crop({2, 3, 4, 2}));
  EXPECT_EQ(mat.at<std::uint16_t>(1, 1), 9);
  EXPECT_FALSE(mat.isContinuous());
}

TEST(CvBridgeDeathTest, RefusesTheWrongType) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  cv::Mat mat(2, 2, CV_8UC1);
  EXPECT_DEATH(viewOf<float>(mat), "depth");
}

}  // namespace
}  // namespace patina
