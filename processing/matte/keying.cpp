// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/matte/keying.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "processing/image/cv_bridge.h"
#include "processing/matte/background.h"

namespace patina::matte {
namespace {

constexpr float kNoiseLeast = 0.002f;  // half a step of 8 bits near white
constexpr double kRayleighMedian = 1.17741;
constexpr float kShines = 1.15f;     // brighter than the background ever is
constexpr float kBlack = 0.06f;      // darker than a shadow gets: an object's black part
constexpr float kBlackHole = 0.25f;  // in the middle of an object, the median of a hole
constexpr int kBandPx = 2;           // about an object's outline, where pixels are mixed

struct Ratios {
  Image<float> scale;  // s: of the background that explains the pixel best
  Image<float> off;    // what is left, share of the background
};

Ratios ratiosOf(ImageView<const float> photo, ImageView<const float> background) {
  Ratios out{Image<float>(photo.width, photo.height, 1),
             Image<float>(photo.width, photo.height, 1)};
  for (int y = 0; y < photo.height; ++y)
    for (int x = 0; x < photo.width; ++x) {
      float along = 0, square = 1e-10f, left = 0;
      for (int c = 0; c < 3; ++c) {
        along += photo.at(x, y, c) * background.at(x, y, c);
        square += background.at(x, y, c) * background.at(x, y, c);
      }
      const float s = along / square;
      for (int c = 0; c < 3; ++c) {
        const float e = photo.at(x, y, c) - s * background.at(x, y, c);
        left += e * e;
      }
      out.scale.at(x, y) = s;
      out.off.at(x, y) = std::sqrt(left / square);
    }
  return out;
}

// Of the part of the picture that is as bright as the background.
float noiseOf(const Ratios& ratios) {
  std::vector<float> off;
  for (std::size_t i = 0; i < ratios.off.texels().size(); ++i)
    if (std::abs(ratios.scale.texels()[i] - 1) < 0.1f) off.push_back(ratios.off.texels()[i]);
  if (off.size() * 20 < ratios.off.texels().size())
    throw ProcessingError(Exit::kBadData,
                          "less than a twentieth of the photograph shows the background: is it the "
                          "right one?");
  const auto middle = off.begin() + static_cast<std::ptrdiff_t>(off.size() / 2);
  std::nth_element(off.begin(), middle, off.end());
  return std::max(kNoiseLeast, static_cast<float>(*middle / kRayleighMedian));
}

cv::Mat elementOf(int radius) {
  return cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * radius + 1, 2 * radius + 1});
}

float medianWhere(const cv::Mat& labels, int label, const Image<float>& values) {
  std::vector<float> of;
  for (int y = 0; y < labels.rows; ++y)
    for (int x = 0; x < labels.cols; ++x)
      if (labels.at<int>(y, x) == label) of.push_back(values.at(x, y));
  const auto middle = of.begin() + static_cast<std::ptrdiff_t>(of.size() / 2);
  std::nth_element(of.begin(), middle, of.end());
  return *middle;
}

void dropSpecks(cv::Mat& object, int least_px) {
  cv::Mat labels, about, middles;
  cv::connectedComponentsWithStats(object, labels, about, middles, 8);
  for (int y = 0; y < object.rows; ++y)
    for (int x = 0; x < object.cols; ++x)
      if (about.at<int>(labels.at<int>(y, x), cv::CC_STAT_AREA) < least_px)
        object.at<std::uint8_t>(y, x) = 0;
}

// Holes that are small, or as dark as no shadow is.
void fillHoles(cv::Mat& object, const Image<float>& scale, int least_px) {
  cv::Mat labels, about, middles;
  const int count = cv::connectedComponentsWithStats(object == 0, labels, about, middles, 4);
  std::vector<bool> fill(static_cast<std::size_t>(count), false);
  for (int i = 1; i < count; ++i) {
    const int left = about.at<int>(i, cv::CC_STAT_LEFT), top = about.at<int>(i, cv::CC_STAT_TOP);
    const bool is_inside = left > 0 && top > 0 &&
                           left + about.at<int>(i, cv::CC_STAT_WIDTH) < object.cols &&
                           top + about.at<int>(i, cv::CC_STAT_HEIGHT) < object.rows;
    fill[static_cast<std::size_t>(i)] =
        is_inside && (about.at<int>(i, cv::CC_STAT_AREA) < least_px ||
                      medianWhere(labels, i, scale) < kBlackHole);
  }
  for (int y = 0; y < object.rows; ++y)
    for (int x = 0; x < object.cols; ++x)
      if (fill[static_cast<std::size_t>(labels.at<int>(y, x))]) object.at<std::uint8_t>(y, x) = 255;
}

cv::Mat objectOf(const Ratios& ratios, float noise, const KeyOptions& options) {
  const int width = ratios.scale.width(), height = ratios.scale.height();
  const double least = std::max(options.threshold * noise, options.difference);
  cv::Mat object(height, width, CV_8U);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const float s = ratios.scale.at(x, y);
      const bool differs = ratios.off.at(x, y) > least;
      object.at<std::uint8_t>(y, x) = differs || s > kShines || s < kBlack ? 255 : 0;
    }
  const int least_px = static_cast<int>(options.speck_share * width * height) + 1;
  cv::morphologyEx(object, object, cv::MORPH_CLOSE, elementOf(1));
  dropSpecks(object, least_px);
  fillHoles(object, ratios.scale, least_px);
  return object;
}

// For every pixel the nearest one where `is_source` is set, as y * width + x; empty: there is none.
std::vector<int> nearestOf(const cv::Mat& is_source) {
  if (cv::countNonZero(is_source) == 0) return {};
  cv::Mat distance, labels;
  cv::distanceTransform(is_source == 0, distance, labels, cv::DIST_L2, cv::DIST_MASK_5,
                        cv::DIST_LABEL_PIXEL);
  std::vector<int> of_label(static_cast<std::size_t>(is_source.total()) + 1, 0);
  for (int y = 0; y < labels.rows; ++y)
    for (int x = 0; x < labels.cols; ++x)
      if (is_source.at<std::uint8_t>(y, x) != 0)
        of_label[static_cast<std::size_t>(labels.at<int>(y, x))] = y * labels.cols + x;
  std::vector<int> out(is_source.total());
  for (int y = 0; y < labels.rows; ++y)
    for (int x = 0; x < labels.cols; ++x)
      out[static_cast<std::size_t>(y) * labels.cols + x] =
          of_label[static_cast<std::size_t>(labels.at<int>(y, x))];
  return out;
}

// What the shadow leaves of the light, smoothed, and carried on under the object.
Image<float> shadowOf(const Image<float>& scale, const cv::Mat& is_clear, double blur_px) {
  const std::vector<int> nearest = nearestOf(is_clear);
  Image<float> shadow(scale.width(), scale.height(), 1);
  for (std::size_t i = 0; i < nearest.size(); ++i)
    shadow.texels()[i] = scale.texels()[static_cast<std::size_t>(nearest[i])];
  if (blur_px > 0) {
    cv::Mat mat = asMat(shadow.view());
    cv::GaussianBlur(mat, mat, {0, 0}, blur_px, blur_px, cv::BORDER_REPLICATE);
  }
  for (float& v : shadow.texels()) v = std::clamp(v, 0.0f, 1.0f);
  return shadow;
}

// Share of the way from the shaded background to the object's own colour, where they mix.
void mixAt(ImageView<const float> photo, ImageView<const float> background, int x, int y,
           std::span<const float> own, Keyed& out) {
  float along = 0, square = 1e-10f;
  for (int c = 0; c < 3; ++c) {
    const float behind = out.shadow.at(x, y) * background.at(x, y, c);
    const float way = own[static_cast<std::size_t>(c)] - behind;
    along += (photo.at(x, y, c) - behind) * way;
    square += way * way;
  }
  out.mask.at(x, y) = std::clamp(along / square, 0.0f, 1.0f);
  for (int c = 0; c < 3; ++c) out.object.at(x, y, c) = own[static_cast<std::size_t>(c)];
}

void fillMask(ImageView<const float> photo, ImageView<const float> background,
              const cv::Mat& object, const cv::Mat& core, const cv::Mat& is_clear, Keyed& out) {
  const std::vector<int> nearest = nearestOf(core);
  for (int y = 0; y < photo.height; ++y)
    for (int x = 0; x < photo.width; ++x) {
      if (is_clear.at<std::uint8_t>(y, x) != 0) continue;
      const bool is_core = core.at<std::uint8_t>(y, x) != 0 || nearest.empty();
      if (is_core) {
        out.mask.at(x, y) = object.at<std::uint8_t>(y, x) != 0 ? 1 : 0;
        std::copy_n(photo.texel(x, y).data(), 3, &out.object.at(x, y));
        continue;
      }
      const int from = nearest[static_cast<std::size_t>(y) * photo.width + x];
      mixAt(photo, background, x, y, photo.texel(from % photo.width, from / photo.width), out);
    }
}

void count(Keyed& out) {
  double object = 0, shadow = 0;
  for (std::size_t i = 0; i < out.mask.texels().size(); ++i) {
    object += out.mask.texels()[i];
    shadow += out.mask.texels()[i] < 0.5f && out.shadow.texels()[i] <= 0.9f;
  }
  out.object_share = object / static_cast<double>(out.mask.texels().size());
  out.shadow_share = shadow / static_cast<double>(out.mask.texels().size());
}

}  // namespace

void KeyOptions::check() const {
  if (!(threshold >= 2 && threshold <= 1000))
    throw ProcessingError(Exit::kUsage, "the threshold is 2 to 1000 times the noise");
  if (!(difference >= 0 && difference <= 1))
    throw ProcessingError(Exit::kUsage, "the least difference is 0 to 1");
  if (!(speck_share >= 0 && speck_share <= 0.5))
    throw ProcessingError(Exit::kUsage, "specks are 0 to 0.5 of the picture");
  if (!(shadow_blur_px >= 0 && shadow_blur_px <= 100))
    throw ProcessingError(Exit::kUsage, "a shadow is blurred by 0 to 100 pixels");
}

Keyed keyOut(ImageView<const float> photo, const Background& given, const KeyOptions& options) {
  options.check();
  if (photo.channels != 3 || photo.width < 16 || photo.height < 16)
    throw ProcessingError(Exit::kUsage,
                          "the photograph has three channels and at least 16x16 "
                          "pixels");
  Image<float> fitted;
  ImageView<const float> background;
  if (const auto* plain = std::get_if<PlainColour>(&given)) {
    fitted = fittedBackground(photo, plain->linear);
    background = std::as_const(fitted).view();
  } else {
    background = std::get<ImageView<const float>>(given);
  }
  if (background.size() != photo.size() || background.channels != 3)
    throw ProcessingError(Exit::kUsage, "the background is " + std::to_string(background.width) +
                                            "x" + std::to_string(background.height) +
                                            ", the photograph " + std::to_string(photo.width) +
                                            "x" + std::to_string(photo.height) +
                                            ": they must be alike, in colour");
  const Ratios ratios = ratiosOf(photo, background);
  Keyed out;
  const float noise = noiseOf(ratios);
  out.noise = noise;
  const cv::Mat object = objectOf(ratios, noise, options);
  cv::Mat core, wide;
  cv::erode(object, core, elementOf(kBandPx));
  cv::dilate(object, wide, elementOf(kBandPx));
  const cv::Mat is_clear = wide == 0;
  if (cv::countNonZero(object) == 0 || cv::countNonZero(is_clear) == 0)
    throw ProcessingError(Exit::kBadData, cv::countNonZero(object) == 0
                                              ? "nothing stands before the background"
                                              : "the object hides all of the background");
  out.shadow = shadowOf(ratios.scale, is_clear, options.shadow_blur_px);
  out.mask = Image<float>(photo.width, photo.height, 1);
  out.object = Image<float>(photo.width, photo.height, 3);
  fillMask(photo, background, object, core, is_clear, out);
  count(out);
  return out;
}

}  // namespace patina::matte
