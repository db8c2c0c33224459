// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/matte/background.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace patina::matte {
namespace {

constexpr double kRim = 0.1;         // of the smaller side
constexpr double kHueCosine = 0.97;  // 14 degrees: of the colour asked for
constexpr double kRimShare = 1.0 / 3;
constexpr double kDarker = 0.93, kBrighter = 1.15;  // of the fit: shadow and what shines
constexpr int kRounds = 6;
constexpr int kTerms = 6;

using Terms = cv::Matx<double, kTerms, 1>;

Terms termsAt(int x, int y, SizePx size) {
  const double u = 2 * (x + 0.5) / size.width - 1, v = 2 * (y + 0.5) / size.height - 1;
  return {1, u, v, u * u, u * v, v * v};
}

using Fit = cv::Matx<double, kTerms, 3>;  // a channel a column

struct Sample {
  Terms terms;
  cv::Matx<double, 1, 3> colour;
};

std::vector<Sample> rimOf(ImageView<const float> photo, const std::array<double, 3>& hue) {
  const int wide = std::max(1, static_cast<int>(kRim * std::min(photo.width, photo.height)));
  std::vector<Sample> samples;
  std::size_t all = 0;
  for (int y = 0; y < photo.height; ++y)
    for (int x = 0; x < photo.width; ++x) {
      const bool is_rim =
          x < wide || y < wide || x >= photo.width - wide || y >= photo.height - wide;
      if (!is_rim) continue;
      ++all;
      double along = 0, square = 0;
      for (std::size_t c = 0; c < 3; ++c) {
        const double v = photo.at(x, y, static_cast<int>(c));
        along += v * hue[c];
        square += v * v;
      }
      if (along > 1e-4 && along >= kHueCosine * std::sqrt(square))
        samples.push_back({termsAt(x, y, photo.size()),
                           {photo.at(x, y, 0), photo.at(x, y, 1), photo.at(x, y, 2)}});
    }
  if (static_cast<double>(samples.size()) < kRimShare * static_cast<double>(all) ||
      samples.size() < kTerms)
    throw ProcessingError(
        Exit::kBadData,
        "only " + std::to_string(100 * samples.size() / std::max<std::size_t>(1, all)) +
            " % of the picture's rim has the background's colour: give another colour, or a "
            "picture of the empty background");
  return samples;
}

double sumOf(const cv::Matx<double, 1, 3>& colour) {
  return colour(0, 0) + colour(0, 1) + colour(0, 2);
}

// Least squares, then again without what lies far below (shadow) or above, a few times.
Fit fittedTo(const std::vector<Sample>& samples) {
  Fit fit = Fit::zeros();
  for (int round = 0; round < kRounds; ++round) {
    cv::Matx<double, kTerms, kTerms> normal = 1e-9 * cv::Matx<double, kTerms, kTerms>::eye();
    Fit right = Fit::zeros();
    for (const Sample& s : samples) {
      const double now = sumOf(s.terms.t() * fit), brightness = sumOf(s.colour);
      if (round > 0 && (brightness < kDarker * now || brightness > kBrighter * now)) continue;
      normal += s.terms * s.terms.t();
      right += s.terms * s.colour;
    }
    fit = normal.solve(right, cv::DECOMP_CHOLESKY);
  }
  return fit;
}

}  // namespace

Image<float> fittedBackground(ImageView<const float> photo, const std::array<float, 3>& colour) {
  const double length = std::hypot(colour[0], colour[1], colour[2]);
  if (!(length > 0) || !std::isfinite(length) || std::min({colour[0], colour[1], colour[2]}) < 0)
    throw ProcessingError(Exit::kUsage, "a black background has no colour to tell a shadow by");
  std::array<double, 3> hue{};
  for (std::size_t c = 0; c < 3; ++c) hue[c] = colour[c] / length;
  const Fit fit = fittedTo(rimOf(photo, hue));
  Image<float> out(photo.width, photo.height, 3);
  for (int y = 0; y < photo.height; ++y)
    for (int x = 0; x < photo.width; ++x) {
      const cv::Matx<double, 1, 3> value = termsAt(x, y, photo.size()).t() * fit;
      for (int c = 0; c < 3; ++c) out.at(x, y, c) = static_cast<float>(std::max(1e-5, value(0, c)));
    }
  return out;
}

}  // namespace patina::matte
