// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/registration/fiducials.h"

#include <opencv2/aruco.hpp>
#include <opencv2/imgproc.hpp>
#include <string>

#include "calibration/failure.h"
#include "processing/image/cv_bridge.h"
#include "processing/image/encoding.h"

namespace patina::calibration {
namespace {

using Corners = std::vector<std::vector<cv::Point2f>>;

Corners cornersOf(ImageView<const float> linear) {
  const Image<std::uint8_t> shown = encodeSrgb8(linear);
  cv::Mat grey = asMat(shown.view());
  if (linear.channels == 3) cv::cvtColor(grey, grey, cv::COLOR_RGB2GRAY);
  Corners corners;
  std::vector<int> ids;
  cv::aruco::detectMarkers(grey, cv::aruco::getPredefinedDictionary(cv::aruco::DICT_4X4_50),
                           corners, ids);
  return corners;
}

}  // namespace

int countMarkers(ImageView<const float> linear) {
  return static_cast<int>(cornersOf(linear).size());
}

Image<std::uint8_t> markersIn(ImageView<const float> linear) {
  const Corners found = cornersOf(linear);
  if (found.size() < 2)
    throw CalibrationError(Exit::kBadData,
                           std::to_string(found.size()) +
                               " ArUco markers (4x4_50) found in the first frame; at least two are "
                               "needed: name their rectangles instead, or lay more of them");
  Image<std::uint8_t> mask(linear.width, linear.height, 1);
  cv::Mat to = asMat(mask.view());
  for (const std::vector<cv::Point2f>& marker : found) {
    const cv::Point2f middle = 0.25f * (marker[0] + marker[1] + marker[2] + marker[3]);
    std::vector<cv::Point> grown;
    for (const cv::Point2f& corner : marker) grown.emplace_back(middle + 2.0f * (corner - middle));
    cv::fillConvexPoly(to, grown, cv::Scalar(255));
  }
  return mask;
}

Image<std::uint8_t> maskOf(std::span<const RectPx> rectangles, SizePx size) {
  Image<std::uint8_t> mask(size.width, size.height, 1);
  for (const RectPx& r : rectangles) {
    if (r.x < 0 || r.y < 0 || r.width < 1 || r.height < 1 || r.x + r.width > size.width ||
        r.y + r.height > size.height)
      throw CalibrationError(
          Exit::kUsage, "the fiducial " + std::to_string(r.x) + "," + std::to_string(r.y) + "," +
                            std::to_string(r.width) + "," + std::to_string(r.height) +
                            " does not lie within the frames of " + std::to_string(size.width) +
                            "x" + std::to_string(size.height));
    for (int y = r.y; y < r.y + r.height; ++y)
      for (int x = r.x; x < r.x + r.width; ++x) mask.at(x, y) = 255;
  }
  return mask;
}

}  // namespace patina::calibration
