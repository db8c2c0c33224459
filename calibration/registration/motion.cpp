// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/registration/motion.h"

#include <algorithm>
#include <cmath>

#include "calibration/failure.h"

namespace patina::calibration {
namespace {

constexpr std::array<const char*, 4> kModels{"translation", "euclidean", "affine", "homography"};

// Pixels of a picture, from those of the one 2^level times smaller.
Motion fineFromCoarse(int level) {
  const double scale = std::ldexp(1.0, level), middle = (scale - 1) / 2;
  return {scale, 0, middle, 0, scale, middle, 0, 0, 1};
}

std::array<PlacePx, 4> cornersOf(SizePx size) {
  const double right = size.width - 1, low = size.height - 1;
  return {PlacePx{0, 0}, {right, 0}, {right, low}, {0, low}};
}

}  // namespace

const char* name(MotionModel model) { return kModels[static_cast<std::size_t>(model)]; }

MotionModel parseMotionModel(const std::string& name) {
  const auto at = std::ranges::find(kModels, name);
  if (at == kModels.end())
    throw CalibrationError(Exit::kUsage,
                           "there is no motion model '" + name +
                               "'; there are: translation, euclidean, affine, homography");
  return static_cast<MotionModel>(at - kModels.begin());
}

PlacePx moved(const Motion& m, PlacePx p) {
  const double w = m[6] * p.x + m[7] * p.y + m[8];
  return {(m[0] * p.x + m[1] * p.y + m[2]) / w, (m[3] * p.x + m[4] * p.y + m[5]) / w};
}

Motion chained(const Motion& second, const Motion& first) {
  Motion out{};
  for (std::size_t row = 0; row < 3; ++row)
    for (std::size_t column = 0; column < 3; ++column)
      for (std::size_t k = 0; k < 3; ++k)
        out[3 * row + column] += second[3 * row + k] * first[3 * k + column];
  const double last = out[8];
  for (double& value : out) value /= last;
  return out;
}

Motion inverse(const Motion& m) {
  Motion out{m[4] * m[8] - m[5] * m[7], m[2] * m[7] - m[1] * m[8], m[1] * m[5] - m[2] * m[4],
             m[5] * m[6] - m[3] * m[8], m[0] * m[8] - m[2] * m[6], m[2] * m[3] - m[0] * m[5],
             m[3] * m[7] - m[4] * m[6], m[1] * m[6] - m[0] * m[7], m[0] * m[4] - m[1] * m[3]};
  const double determinant = m[0] * out[0] + m[1] * out[3] + m[2] * out[6];
  PATINA_CHECK(determinant != 0 && out[8] != 0);
  const double last = out[8];
  for (double& value : out) value /= last;
  return out;
}

Motion shift(double x_px, double y_px) { return {1, 0, x_px, 0, 1, y_px, 0, 0, 1}; }

Motion atLevel(const Motion& motion, int level) {
  const Motion up = fineFromCoarse(level);
  return chained(inverse(up), chained(motion, up));
}

Motion fromLevel(const Motion& motion, int level) {
  const Motion up = fineFromCoarse(level);
  return chained(up, chained(motion, inverse(up)));
}

double cornersApart(const Motion& a, const Motion& b, SizePx size) {
  double most = 0;
  for (const PlacePx corner : cornersOf(size)) {
    const PlacePx p = moved(a, corner), q = moved(b, corner);
    most = std::max(most, std::hypot(p.x - q.x, p.y - q.y));
  }
  return most;
}

bool isPlausible(const Motion& motion, SizePx size) {
  const std::array<PlacePx, 4> corners = cornersOf(size);
  std::array<PlacePx, 4> seen;
  for (std::size_t k = 0; k < 4; ++k) {
    const double w = motion[6] * corners[k].x + motion[7] * corners[k].y + motion[8];
    if (!(w > 0.1 && w < 10)) return false;
    seen[k] = moved(motion, corners[k]);
  }
  for (std::size_t k = 0; k < 4; ++k) {
    const PlacePx &a = seen[k], &b = seen[(k + 1) % 4], &c = seen[(k + 2) % 4];
    const double turn = (b.x - a.x) * (c.y - b.y) - (b.y - a.y) * (c.x - b.x);
    const double before =
        std::hypot(corners[k].x - corners[(k + 1) % 4].x, corners[k].y - corners[(k + 1) % 4].y);
    const double side = std::hypot(b.x - a.x, b.y - a.y);
    if (!(turn > 0) || !(side > before / 3 && side < before * 3)) return false;
  }
  return true;
}

}  // namespace patina::calibration
