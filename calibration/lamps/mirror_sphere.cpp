// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/lamps/mirror_sphere.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "calibration/lamps/median.h"
#include "calibration/lamps/reduced_grey.h"
#include "calibration/lamps/vec3.h"
#include "processing/image/cv_bridge.h"
#include "processing/image/parallel_rows.h"

namespace patina::calibration {
namespace {

constexpr int kSearchSidePx = 1024;      // the sphere is looked for in pictures of this size
constexpr double kFoot = 0.25;           // of its height: where a highlight begins
constexpr double kSaturatedDisc = 0.25;  // of its texels: no highlight stands out any more

double greyAt(ImageView<const float> picture, int x, int y) {
  double sum = 0;
  for (const float v : picture.texel(x, y)) sum += v;
  return sum / picture.channels;
}

Image<float> medianOver(const std::vector<Image<float>>& shots) {
  Image<float> median(shots.front().width(), shots.front().height(), 1);
  forEachRow(median.height(), std::int64_t{median.width()} * static_cast<int>(shots.size()) * 8,
             [&](int y) {
               std::vector<float> values(shots.size());
               for (int x = 0; x < median.width(); ++x) {
                 for (std::size_t i = 0; i < shots.size(); ++i) values[i] = shots[i].at(x, y);
                 const auto middle =
                     values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
                 std::nth_element(values.begin(), middle, values.end());
                 median.at(x, y) = *middle;
               }
             });
  return median;
}

// The sphere's square of a picture: what its texels show, and the normals they show it by.
struct Square {
  int x0 = 0, y0 = 0;
  Image<float> grey;     // negative beside the sphere
  Image<float> clipped;  // 1 where a channel may be
  std::vector<float> on_sphere;
};

Square squareOf(ImageView<const float> picture, const MirrorSphere& sphere, double saturated) {
  const Disc& disc = sphere.disc();
  const double reach = disc.radius_px * 1.2 + 2;
  Square square;
  square.x0 = std::max(0, static_cast<int>(disc.x_px - reach));
  square.y0 = std::max(0, static_cast<int>(disc.y_px - reach));
  const int x1 = std::min(picture.width, static_cast<int>(disc.x_px + reach) + 1),
            y1 = std::min(picture.height, static_cast<int>(disc.y_px + reach) + 1);
  square.grey = Image<float>(std::max(x1 - square.x0, 1), std::max(y1 - square.y0, 1), 1, -1);
  square.clipped = Image<float>(square.grey.width(), square.grey.height(), 1);
  for (int y = square.y0; y < y1; ++y)
    for (int x = square.x0; x < x1; ++x) {
      if (!sphere.touchAt(x + 0.5, y + 0.5)) continue;
      const auto grey = static_cast<float>(std::max(greyAt(picture, x, y), 0.0));
      square.grey.at(x - square.x0, y - square.y0) = grey;
      square.on_sphere.push_back(grey);
      for (const float v : picture.texel(x, y))
        if (v >= saturated) square.clipped.at(x - square.x0, y - square.y0) = 1;
    }
  return square;
}

struct Foot {
  double own = 0, noise = 0;  // level of the sphere beside highlights, and its spread
  double from = 0;            // where the highlight begins
};

Foot footOf(const Square& square, const SphereOptions& options) {
  Foot foot;
  foot.own = medianOf(square.on_sphere);
  std::vector<float> off;
  for (const float v : square.on_sphere) off.push_back(std::abs(v - static_cast<float>(foot.own)));
  foot.noise = 1.4826 * medianOf(std::move(off));
  // A hot pixel is no highlight: the peak is that of medians of 3x3.
  cv::Mat calm;
  cv::medianBlur(asMat(square.grey.view()), calm, 3);
  double peak = 0;
  cv::minMaxLoc(calm, nullptr, &peak);
  if (peak - foot.own < std::max(options.least, 6 * foot.noise))
    throw CalibrationError(Exit::kBadData,
                           "the sphere shows no highlight: the lamp was dark, or stands behind it; "
                           "expose longer or leave the lamp out");
  foot.from = foot.own + kFoot * (peak - foot.own);
  return foot;
}

// Connected texels above the foot; the brightest piece is the highlight.
cv::Mat highlightOf(const Square& square, const Foot& foot, const SphereOptions& options) {
  const cv::Mat grey = asMat(square.grey.view());
  cv::Mat labels, above = grey > foot.from;
  const int count = cv::connectedComponents(above, labels, 8, CV_32S);
  std::vector<double> light(static_cast<std::size_t>(count));
  std::vector<int> texels(static_cast<std::size_t>(count));
  for (int y = 0; y < grey.rows; ++y)
    for (int x = 0; x < grey.cols; ++x) {
      const auto label = static_cast<std::size_t>(labels.at<int>(y, x));
      if (label == 0) continue;
      light[label] += grey.at<float>(y, x) - foot.from;
      ++texels[label];
    }
  const auto first = std::max_element(light.begin() + 1, light.end());
  for (auto it = light.begin() + 1; it != light.end(); ++it) {
    const auto piece = static_cast<std::size_t>(it - light.begin());
    if (it != first && *it > options.second * *first && texels[piece] >= 3)
      throw CalibrationError(Exit::kBadData,
                             "the sphere shows several highlights: light one lamp at a time, and "
                             "cover windows and what else is bright");
  }
  return labels == static_cast<int>(first - light.begin());
}

}  // namespace

void SphereOptions::check() const {
  const auto range = [](const char* field, double value) {
    if (!(value > 0 && value <= 1))
      throw CalibrationError(Exit::kUsage, std::string(field) + " is " + std::to_string(value) +
                                               "; it lies between 0 and 1");
  };
  range("saturated", saturated);
  range("second", second);
  range("least", least);
}

SphereLight lightFromHighlight(ImageView<const float> picture, const MirrorSphere& sphere,
                               const SphereOptions& options) {
  options.check();
  const Square square = squareOf(picture, sphere, options.saturated);
  double saturated = 0;
  for (const float v : square.clipped.texels()) saturated += v;
  if (square.on_sphere.empty() ||
      saturated > kSaturatedDisc * static_cast<double>(square.on_sphere.size()))
    throw CalibrationError(Exit::kBadData,
                           "the sphere is saturated all over; expose shorter or stop down");
  const Foot foot = footOf(square, options);
  const cv::Mat highlight = highlightOf(square, foot, options);

  SphereLight light;
  double sum = 0, spread = 0, clipped = 0;
  for (int y = 0; y < highlight.rows; ++y)
    for (int x = 0; x < highlight.cols; ++x) {
      if (!highlight.at<std::uint8_t>(y, x)) continue;
      const double x_px = square.x0 + x + 0.5, y_px = square.y0 + y + 0.5;
      const auto touch = sphere.touchAt(x_px, y_px);
      if (!touch) continue;
      const double weight = square.grey.at(x, y) - foot.from;
      const auto& [n, v] = *touch;
      const double cosine = n[0] * v[0] + n[1] * v[1] + n[2] * v[2];
      for (int i = 0; i < 3; ++i) {
        light.direction[i] += weight * (2 * cosine * n[i] - v[i]);
        light.normal[i] += weight * n[i];
      }
      light.x_px += weight * x_px;
      light.y_px += weight * y_px;
      sum += weight;
      ++light.texels;
      clipped += square.clipped.at(x, y);
    }
  const double along = norm(light.direction), across = norm(light.normal);
  for (int i = 0; i < 3; ++i) {
    light.direction[i] /= along;
    light.normal[i] /= across;
  }
  light.x_px /= sum;
  light.y_px /= sum;
  light.clipped_share = clipped / std::max(light.texels, 1);
  for (int y = 0; y < highlight.rows; ++y)
    for (int x = 0; x < highlight.cols; ++x)
      if (highlight.at<std::uint8_t>(y, x)) spread += std::pow(square.x0 + x + 0.5 - light.x_px, 2);
  const RimReport& rim = sphere.report();
  const double middle_px = rim.rms_px * std::sqrt(2.0 / std::max(rim.points, 1)),
               highlight_px = foot.noise * std::sqrt(spread) / sum;
  light.sigma_deg = 2 / (sphere.disc().radius_px * std::max(light.normal[2], 0.05)) *
                    std::hypot(middle_px, highlight_px) * 180 / M_PI;
  return light;
}

SphereLights lightsFromSphere(const SphereShots& shots, const SphereOptions& options,
                              Progress& progress) {
  options.check();
  if (shots.count < 1) throw CalibrationError(Exit::kBadData, "there is no picture of a sphere");
  const auto nameOf = [&](int i) {
    return shots.name ? shots.name(i) : "shot " + std::to_string(i + 1);
  };
  SizePx size;
  const auto pictureOf = [&](int i) {
    Image<float> picture = shots.picture(i);
    if (i > 0 && size.width > 0 && picture.size() != size)
      throw CalibrationError(Exit::kBadData, nameOf(i) + " is of another size than the others");
    size = picture.size();
    return picture;
  };

  progress.begin("sphere", shots.count * (options.given ? 1 : 2));
  std::optional<MirrorSphere> sphere;
  if (options.given) {
    sphere = sphereAt(*options.given, shots.picture(0).size(), options.camera);
  } else {
    std::vector<Image<float>> greys;
    int by = 1;
    for (int i = 0; i < shots.count; ++i) {
      const Image<float> picture = pictureOf(i);
      by = reductionTo(kSearchSidePx, size);
      greys.push_back(reducedGrey(picture.view(), by));
      progress.step();
    }
    SphereCamera camera = options.camera;
    camera.check(size);
    camera.centre_x_px = (camera.centre_x_px < 0 ? size.width / 2.0 : camera.centre_x_px) / by;
    camera.centre_y_px = (camera.centre_y_px < 0 ? size.height / 2.0 : camera.centre_y_px) / by;
    camera.focal_px /= by;
    const MirrorSphere small = findSphere(medianOver(greys).view(), camera);
    sphere = small.enlarged(by);
  }

  SphereLights out{*sphere, {}};
  for (int i = 0; i < shots.count; ++i) {
    const Image<float> picture = pictureOf(i);
    try {
      out.lights.push_back(lightFromHighlight(picture.view(), *sphere, options));
    } catch (const CalibrationError& error) {
      throw CalibrationError(error.exit(), nameOf(i) + ": " + error.what());
    }
    progress.step();
  }
  return out;
}

}  // namespace patina::calibration
