// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/colour/chart_finder.h"

#include <dlfcn.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <opencv2/mcc.hpp>
#include <type_traits>
#include <vector>

#include "calibration/failure.h"
#include "processing/image/cv_bridge.h"
#include "processing/image/warp.h"

namespace patina::calibration {
namespace {

// The level that all but a two hundredth of the texels stay below.
float whiteOf(ImageView<const float> linear, int channel) {
  std::vector<float> values;
  values.reserve(static_cast<std::size_t>(linear.width) * linear.height);
  for (int y = 0; y < linear.height; ++y)
    for (int x = 0; x < linear.width; ++x) values.push_back(linear.at(x, y, channel));
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(values.size() * 199 / 200);
  std::nth_element(values.begin(), at, values.end());
  return std::max(*at, 1e-6F);
}

Image<std::uint8_t> forTheEye(ImageView<const float> linear) {
  Image<std::uint8_t> bgr(linear.width, linear.height, 3);
  for (int c = 0; c < 3; ++c) {
    const float white = whiteOf(linear, c);
    for (int y = 0; y < linear.height; ++y)
      for (int x = 0; x < linear.width; ++x) {
        const float v = std::clamp(linear.at(x, y, c) / white, 0.0F, 1.0F);
        bgr.at(x, y, 2 - c) = static_cast<std::uint8_t>(std::pow(v, 1 / 2.2F) * 255);
      }
  }
  return bgr;
}

// mcc's model of the chart: fields 2.5 wide every 2.75, a quarter from the edge of the box.
constexpr float kBoxWidth = 16.75F, kBoxHeight = 11.25F, kPitch = 2.75F, kFirst = 1.5F;

// Linked, libopencv_mcc would bring OpenCV's networks and what they need into every start of the
// program; so it is opened at the first search, by its two functions. All else are virtual calls.
struct Mcc {
  cv::Ptr<cv::mcc::CCheckerDetector> (*detector)() = nullptr;
  cv::Ptr<cv::mcc::DetectorParameters> (*parameters)() = nullptr;
};
Mcc openMcc() {
  void* library = dlopen(PATINA_MCC_LIBRARY, RTLD_NOW | RTLD_LOCAL);  // stays open
  Mcc out;
  if (library != nullptr) {
    const auto find = [&](auto& function, const char* name) {
      function =
          reinterpret_cast<std::remove_reference_t<decltype(function)>>(dlsym(library, name));
    };
    find(out.detector, "_ZN2cv3mcc16CCheckerDetector6createEv");
    find(out.parameters, "_ZN2cv3mcc18DetectorParameters6createEv");
  }
  if (out.detector == nullptr || out.parameters == nullptr)
    throw CalibrationError(Exit::kUnavailable,
                           "charts are found by " PATINA_MCC_LIBRARY
                           ", which is not there: install libopencv-contrib406, or give the "
                           "chart's corners");
  return out;
}

ChartCorners cornersOf(const std::vector<cv::Point2f>& box, double scale_x, double scale_y) {
  const std::array<cv::Point2f, 4> model{cv::Point2f(0, 0), cv::Point2f(kBoxWidth, 0),
                                         cv::Point2f(kBoxWidth, kBoxHeight),
                                         cv::Point2f(0, kBoxHeight)};
  const cv::Mat map = cv::getPerspectiveTransform(model.data(), box.data());
  const float right = kFirst + (kChartColumns - 1) * kPitch,
              below = kFirst + (kChartRows - 1) * kPitch;
  const std::vector<cv::Point2f> middles{
      {kFirst, kFirst}, {right, kFirst}, {right, below}, {kFirst, below}};
  std::vector<cv::Point2f> seen;
  cv::perspectiveTransform(middles, seen, map);
  ChartCorners out;
  for (int i = 0; i < 4; ++i)
    out[i] = {(seen[i].x + 0.5) * scale_x - 0.5, (seen[i].y + 0.5) * scale_y - 0.5};
  return out;
}

}  // namespace

void FindOptions::check() const {
  if (side_px < 400 || side_px > 8000)
    throw CalibrationError(Exit::kUsage, "side_px must lie in [400, 8000]");
}

std::optional<ChartCorners> findChart(ImageView<const float> linear, const FindOptions& options,
                                      Progress& progress) {
  options.check();
  if (linear.channels != 3)
    throw CalibrationError(Exit::kBadData, "a chart is found in pictures in colour only");
  static const Mcc mcc = openMcc();
  progress.begin("looking for the chart", 1);
  Image<float> smaller;
  ImageView<const float> seen = linear;
  if (std::max(linear.width, linear.height) > options.side_px) {
    smaller = resizeArea(linear, fitInside(linear.size(), {options.side_px, options.side_px}));
    seen = smaller.view();
  }
  const Image<std::uint8_t> bgr = forTheEye(seen);
  std::vector<cv::Point2f> box;
  try {
    const auto detector = mcc.detector();
    if (detector->process(asMat(bgr.view()), cv::mcc::MCC24, 1, false, mcc.parameters()))
      if (const auto chart = detector->getBestColorChecker()) box = chart->getBox();
  } catch (const cv::Exception&) {
    box.clear();  // of pictures in which its clustering finds nothing to hold on to
  }
  progress.step();
  if (box.size() != 4) return std::nullopt;
  return cornersOf(box, static_cast<double>(linear.width) / seen.width,
                   static_cast<double>(linear.height) / seen.height);
}

}  // namespace patina::calibration
