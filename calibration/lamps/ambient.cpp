// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/lamps/ambient.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "processing/image/parallel_rows.h"

namespace patina::calibration {
namespace {

constexpr double kSaturatedMost = 0.001;  // of the samples: lamps in the picture, not ambient light

// Sums over a row, and over all of them in their order, so that threads do not change the result.
struct Sums {
  std::array<double, 3> frame{}, off{};
  double before = 0, after = 0;  // variances
  std::int64_t saturated = 0;
};

Sums sumsOf(const std::vector<Sums>& rows) {
  Sums all;
  for (const Sums& row : rows) {
    for (std::size_t c = 0; c < 3; ++c) {
      all.frame[c] += row.frame[c];
      all.off[c] += row.off[c];
    }
    all.before += row.before;
    all.after += row.after;
    all.saturated += row.saturated;
  }
  return all;
}

}  // namespace

void AmbientOptions::check() const {
  if (!(exposure_ratio > 0) || !std::isfinite(exposure_ratio))
    throw CalibrationError(Exit::kUsage, "exposure_ratio is above 0");
  if (!(saturated > 0 && saturated <= 1) || !(share_most > 0 && share_most <= 1))
    throw CalibrationError(Exit::kUsage, "saturated and share_most lie between 0 and 1");
  if (!(noise_per_level >= 0) || !(read_noise >= 0))
    throw CalibrationError(Exit::kUsage, "noise is not below 0");
}

AmbientReport subtractAmbient(ImageView<float> frame, ImageView<const float> off,
                              const AmbientOptions& options) {
  options.check();
  if (frame.size() != off.size() || frame.channels != off.channels || frame.channels > 3)
    throw CalibrationError(Exit::kBadData,
                           "the lights-off picture is of another size than the frame");
  const double ratio = options.exposure_ratio, read2 = options.read_noise * options.read_noise;
  std::vector<Sums> rows(static_cast<std::size_t>(frame.height));
  forEachRow(frame.height, std::int64_t{frame.width} * frame.channels * 4, [&](int y) {
    Sums& sums = rows[static_cast<std::size_t>(y)];
    for (int x = 0; x < frame.width; ++x)
      for (int c = 0; c < frame.channels; ++c) {
        const double with = frame.at(x, y, c), without = off.at(x, y, c);
        sums.frame[c] += with;
        sums.off[c] += without * ratio;
        const double variance = std::max(with, 0.0) * options.noise_per_level + read2;
        sums.before += variance;
        sums.after +=
            variance + ratio * ratio * (std::max(without, 0.0) * options.noise_per_level + read2);
        sums.saturated += without >= options.saturated;
      }
  });
  const Sums all = sumsOf(rows);
  AmbientReport report;
  const double samples = static_cast<double>(frame.width) * frame.height * frame.channels;
  report.saturated_share = static_cast<double>(all.saturated) / std::max(samples, 1.0);
  if (report.saturated_share > kSaturatedMost)
    throw CalibrationError(Exit::kBadData,
                           "the lights-off picture is clipped: it says nothing of ambient light; "
                           "expose it as the frames are");
  for (int c = 0; c < frame.channels; ++c) {
    report.share[c] = all.frame[c] > 0 ? all.off[c] / all.frame[c] : 0;
    if (report.share[c] > options.share_most)
      throw CalibrationError(Exit::kBadData,
                             std::to_string(static_cast<int>(100 * report.share[c])) +
                                 " % of the frame's light is ambient: too much to be taken away; "
                                 "darken the room");
  }
  if (all.before > 0) report.noise_factor = std::sqrt(all.after / all.before);
  forEachRow(frame.height, std::int64_t{frame.width} * frame.channels, [&](int y) {
    for (int i = 0; i < frame.width * frame.channels; ++i)
      frame.row(y)[i] -= static_cast<float>(ratio) * off.row(y)[i];
  });
  return report;
}

}  // namespace patina::calibration
