// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/registration/prepared_picture.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "calibration/failure.h"
#include "processing/image/cv_bridge.h"
#include "processing/image/parallel_rows.h"

namespace patina::calibration {
namespace {

constexpr int kLeastSidePx = 32;
constexpr float kFloor = 0.05f;  // of the mean luma: the dark does not become all noise

std::string sizeText(int width, int height) {
  return std::to_string(width) + "x" + std::to_string(height);
}

// OpenCV's filters use one core: bands of rows, of which each sees the rows beside it. Their size
// does not depend on the number of threads, so neither does the result.
template <class Body>
void forEachBand(int height, const Body& body) {
  constexpr int kBandRows = 64;
  tbb::parallel_for(0, (height + kBandRows - 1) / kBandRows, [&](int band) {
    body(cv::Range(band * kBandRows, std::min((band + 1) * kBandRows, height)));
  });
}

// Mostly green, of which a mosaic has the most: what is finer than red's and blue's own pixels
// moves from one of them to the next by whole steps. What is no number counts as dark.
Image<float> lumaOf(ImageView<const float> in) {
  Image<float> luma(in.width, in.height, 1);
  const ImageView<float> out = luma.view();
  forEachRow(in.height, std::int64_t{2} * in.width * in.channels, [&](int y) {
    const float* from = in.row(y);
    float* to = out.row(y);
    for (int x = 0; x < in.width; ++x) {
      const float value =
          in.channels == 1 ? from[x] : (from[3 * x] + 4 * from[3 * x + 1] + from[3 * x + 2]) / 6;
      to[x] = value > 0 ? value : 0;
    }
  });
  return luma;
}

Image<float> halved(const Image<float>& in) {
  Image<float> out((in.width() + 1) / 2, (in.height() + 1) / 2, 1);
  const ImageView<const float> from = in.view();
  const ImageView<float> to = out.view();
  forEachRow(out.height(), std::int64_t{4} * out.width(), [&](int y) {
    const float *a = from.row(2 * y), *b = from.row(std::min(2 * y + 1, in.height() - 1));
    float* row = to.row(y);
    const int whole = in.width() / 2;
    for (int x = 0; x < whole; ++x)
      row[x] = 0.25f * (a[2 * x] + a[2 * x + 1] + b[2 * x] + b[2 * x + 1]);
    if (whole < out.width()) row[whole] = 0.5f * (a[2 * whole] + b[2 * whole]);
  });
  return out;
}

// Usable is what is made of usable pixels alone.
Image<std::uint8_t> halved(const Image<std::uint8_t>& in) {
  Image<std::uint8_t> out((in.width() + 1) / 2, (in.height() + 1) / 2, 1);
  for (int y = 0; y < out.height(); ++y)
    for (int x = 0; x < out.width(); ++x) {
      const int right = std::min(2 * x + 1, in.width() - 1),
                low = std::min(2 * y + 1, in.height() - 1);
      const bool all = in.at(2 * x, 2 * y) != 0 && in.at(right, 2 * y) != 0 &&
                       in.at(2 * x, low) != 0 && in.at(right, low) != 0;
      out.at(x, y) = all ? 255 : 0;
    }
  return out;
}

// Smoothing and gradients look this far beyond a pixel.
Image<std::uint8_t> withoutMargin(ImageView<const std::uint8_t> usable) {
  constexpr int kMarginPx = 3;
  Image<std::uint8_t> out(usable.width, usable.height, 1);
  const cv::Mat square(2 * kMarginPx + 1, 2 * kMarginPx + 1, CV_8U, cv::Scalar(1));
  cv::Mat to = asMat(out.view());
  cv::erode(asMat(usable), to, square);
  return out;
}

// Means over a window; of usable pixels alone where there is a mask.
class WindowMean {
 public:
  explicit WindowMean(const Image<std::uint8_t>& usable) {
    if (usable.empty()) return;
    asMat(usable.view()).convertTo(weight_, CV_32F, 1 / 255.0);
    share_.create(weight_.size(), CV_32F);
    forEachBand(weight_.rows, [&](const cv::Range& rows) { blur(weight_, share_, rows); });
    share_ = cv::max(share_, 1e-6);
  }
  // Which of `in` counts.
  cv::Mat weighted(const cv::Mat& in) const { return weight_.empty() ? in : in.mul(weight_); }
  // Some rows of the mean of a weighted picture.
  void operator()(const cv::Mat& weighted, cv::Mat& out, const cv::Range& rows) const {
    blur(weighted, out, rows);
    if (weight_.empty()) return;
    cv::Mat to = out.rowRange(rows);
    cv::divide(to, share_.rowRange(rows), to);
  }

 private:
  static void blur(const cv::Mat& in, cv::Mat& out, const cv::Range& rows) {
    cv::Mat to = out.rowRange(rows);
    cv::boxFilter(in.rowRange(rows), to, CV_32F, {kWindowPx, kWindowPx}, {-1, -1}, true,
                  cv::BORDER_REFLECT_101);
  }
  cv::Mat weight_, share_;
};

void normalise(PictureLevel& level) {
  const SizePx size = level.log_light.size();
  level.local = Image<float>(size.width, size.height, 1);
  const WindowMean mean(level.usable);
  const cv::Mat light = asMat(std::as_const(level.log_light).view());
  const cv::Mat weighted = mean.weighted(light);
  cv::Mat detail(light.size(), CV_32F), power(light.size(), CV_32F);
  forEachBand(size.height, [&](const cv::Range& rows) {
    mean(weighted, power, rows);
    cv::Mat to = detail.rowRange(rows), squares = power.rowRange(rows);
    cv::subtract(light.rowRange(rows), squares, to);
    cv::multiply(to, to, squares);
  });
  const cv::Mat squares = mean.weighted(power);
  cv::Mat variance(light.size(), CV_32F);
  const ImageView<float> out = level.local.view();
  forEachBand(size.height, [&](const cv::Range& rows) {
    mean(squares, variance, rows);
    for (int y = rows.start; y < rows.end; ++y) {
      const auto *from = detail.ptr<float>(y), *v = variance.ptr<float>(y);
      float* to = out.row(y);
      for (int x = 0; x < size.width; ++x) to[x] = from[x] / std::sqrt(v[x] + kFlat * kFlat);
    }
  });
}

Image<float> logLight(ImageView<const float> linear) {
  Image<float> luma = lumaOf(linear);
  cv::Mat light = asMat(luma.view());
  const double floor = std::max(kFloor * cv::mean(light)[0], 1e-12);
  forEachBand(light.rows, [&](const cv::Range& rows) {
    cv::Mat band = light.rowRange(rows);
    band += cv::Scalar(floor);
    cv::log(band, band);
  });
  Image<float> out(luma.width(), luma.height(), 1);
  cv::Mat soft = asMat(out.view());
  // Bilinear interpolation shifts the phase of the finest detail; a mosaic makes up some of it.
  forEachBand(light.rows, [&](const cv::Range& rows) {
    cv::Mat band = soft.rowRange(rows);
    cv::GaussianBlur(light.rowRange(rows), band, {5, 5}, 1.0, 1.0, cv::BORDER_REFLECT_101);
  });
  return out;
}

}  // namespace

PreparedPicture preparePicture(ImageView<const float> linear,
                               std::optional<ImageView<const std::uint8_t>> usable, int levels) {
  if (linear.channels != 1 && linear.channels != 3)
    throw CalibrationError(Exit::kBadData, "registration takes pictures of 1 or 3 channels, not " +
                                               std::to_string(linear.channels));
  if (std::min(linear.width, linear.height) < kLeastSidePx)
    throw CalibrationError(Exit::kBadData, "a picture of " + sizeText(linear.width, linear.height) +
                                               " is too small to be registered; from 32x32 on");
  if (usable && usable->size() != linear.size())
    throw CalibrationError(Exit::kBadData,
                           "the mask is " + sizeText(usable->width, usable->height) +
                               ", the picture " + sizeText(linear.width, linear.height));
  PreparedPicture out;
  out.photosites = photositesOf(linear);
  PictureLevel level;
  level.log_light = logLight(linear);
  if (usable) out.mask = copyOf<std::uint8_t>(*usable);
  if (usable) level.usable = withoutMargin(*usable);
  while (true) {
    normalise(level);
    const SizePx size = level.size();
    out.levels.push_back(std::move(level));
    const auto made = static_cast<int>(out.levels.size());
    if (made == levels || std::min(size.width, size.height) / 2 < kLeastSidePx) return out;
    level = {};
    level.log_light = halved(out.levels.back().log_light);
    if (usable) level.usable = halved(out.levels.back().usable);
  }
}

}  // namespace patina::calibration
