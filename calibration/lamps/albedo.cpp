// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/lamps/albedo.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "processing/image/parallel_rows.h"

namespace patina::calibration {
namespace {

struct Level {
  double mean = 0, spread = 0;  // of frame / field; relative RMS
  double highest = 0;           // of the frame
  double lit = 0;               // mean of the frame
  double texels = 0;
};

Level levelOf(ImageView<const float> frame, const std::optional<ImageView<const float>>& field,
              const RectPx& r, int channel) {
  Level level;
  double square = 0;
  for (int y = r.y; y < r.y + r.height; ++y)
    for (int x = r.x; x < r.x + r.width; ++x) {
      const double seen = frame.at(x, y, channel),
                   even = field ? seen / std::max(field->at(x, y, channel), 1e-9f) : seen;
      level.mean += even;
      square += even * even;
      level.lit += seen;
      level.highest = std::max(level.highest, seen);
      ++level.texels;
    }
  level.mean /= level.texels;
  level.lit /= level.texels;
  level.spread = std::sqrt(std::max(square / level.texels - level.mean * level.mean, 0.0)) /
                 std::max(level.mean, 1e-12);
  return level;
}

void checkLevel(const Level& level, const AlbedoOptions& options) {
  if (!(level.lit >= options.level_least))
    throw CalibrationError(Exit::kBadData, "the target is too dark; expose longer");
  if (level.highest > options.level_most)
    throw CalibrationError(Exit::kBadData, "the target is clipped; expose shorter");
  if (!(level.spread <= options.spread_most))
    throw CalibrationError(
        Exit::kBadData, "the target is uneven by " + std::to_string(100 * level.spread) +
                            " %: soiled, partly in shade, or not all of the rectangle is target");
}

void checkField(ImageView<const float> frame, const std::optional<ImageView<const float>>& field) {
  if (field && (field->size() != frame.size() || field->channels != frame.channels))
    throw CalibrationError(Exit::kBadData, "the lamp's field is of another size than the frame");
}

}  // namespace

void AlbedoOptions::check() const {
  for (const double share : {level_least, level_most, spread_most, deviance_most})
    if (!(share > 0 && share <= 1))
      throw CalibrationError(Exit::kUsage, "limits of a target lie between 0 and 1");
}

AlbedoScale solveAlbedo(ImageView<const float> frame, std::optional<ImageView<const float>> field,
                        std::span<const AlbedoTarget> targets, const AlbedoOptions& options) {
  options.check();
  checkField(frame, field);
  if (targets.empty()) throw CalibrationError(Exit::kUsage, "which target? Give its rectangle");
  AlbedoScale out;
  out.channels = std::min(frame.channels, 3);
  for (const AlbedoTarget& target : targets) {
    const RectPx& r = target.rect_px;
    if (r.width < 4 || r.height < 4 || r.x < 0 || r.y < 0 || r.x + r.width > frame.width ||
        r.y + r.height > frame.height)
      throw CalibrationError(Exit::kBadData, "the target's rectangle does not lie in the picture");
    for (const double rho : target.reflectance)
      if (!(rho > 0 && rho <= 1))
        throw CalibrationError(Exit::kUsage, "a reflectance lies between 0 and 1");
  }
  for (int c = 0; c < out.channels; ++c) {
    // Least squares of the relative error: every target counts alike, bright or dark.
    double sum = 0, square = 0, noise = 0;
    std::vector<double> ratios;
    for (const AlbedoTarget& target : targets) {
      const Level level = levelOf(frame, field, target.rect_px, c);
      checkLevel(level, options);
      const double ratio = level.mean / target.reflectance[c];
      ratios.push_back(ratio);
      sum += ratio;
      square += ratio * ratio;
      noise += level.spread * level.spread / level.texels;
    }
    out.scale[c] = sum / square;
    out.sigma[c] = std::sqrt(noise) / static_cast<double>(targets.size());
    for (const double ratio : ratios)
      out.deviance[c] = std::max(out.deviance[c], std::abs(ratio * out.scale[c] - 1));
    if (out.deviance[c] > options.deviance_most)
      throw CalibrationError(Exit::kBadData,
                             "the targets contradict one another by " +
                                 std::to_string(100 * out.deviance[c]) +
                                 " %: one is tilted, shaded, soiled or not of that reflectance");
  }
  return out;
}

void toAlbedo(ImageView<float> frame, std::optional<ImageView<const float>> field,
              const AlbedoScale& scale) {
  checkField(frame, field);
  if (scale.channels != frame.channels)
    throw CalibrationError(Exit::kBadData, "the scale is of another number of channels");
  forEachRow(frame.height, std::int64_t{frame.width} * frame.channels, [&](int y) {
    for (int x = 0; x < frame.width; ++x)
      for (int c = 0; c < frame.channels; ++c) {
        const double light = field ? std::max(field->at(x, y, c), 1e-9f) : 1.0f;
        frame.at(x, y, c) = static_cast<float>(frame.at(x, y, c) * scale.scale[c] / light);
      }
  });
}

}  // namespace patina::calibration
