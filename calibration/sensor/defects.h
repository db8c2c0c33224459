// SPDX-License-Identifier: GPL-3.0-or-later
// Pixels that do not measure light: hot ones, found in a dark by their current; dead, dim and
// bright ones, found in a flat by their response beside that of their neighbours. Values in linear
// light, share of full scale; mosaics are [h][w][1] with their filters, pictures [h][w][3].
#pragma once

#include <optional>
#include <vector>

#include "calibration/failure.h"
#include "calibration/sensor/colour_filters.h"
#include "processing/image/image.h"

namespace patina::calibration {

enum class DefectKind : std::uint8_t { kHot, kDead, kDim, kBright };
struct Defect {
  int x = 0, y = 0;
  DefectKind kind = DefectKind::kHot;
  // Hot: excess of the dark, share of full scale a second at the map's temperature. Others:
  // response over that of the neighbours.
  double strength = 0;
};
struct DefectMap {
  SizePx size;
  double temperature_c = 20;
  std::vector<Defect> defects;  // by rows; a pixel may be there twice
};
struct DefectOptions {
  double hot_sigmas = 8;           // over the spread of its colour in the dark, 3 to 100
  double hot_least = 0.0005;       // share of full scale a dark must show, 0 to 1
  double dim = 0.5, bright = 1.5;  // of the neighbours' response
  double dead = 0.05;
  void check() const;  // throws CalibrationError(kUsage)
};
struct DefectReport {
  int hot = 0, dead = 0, dim = 0, bright = 0;
  int clusters = 0, largest_cluster = 0;  // of two and more that touch within their colour
};
struct FoundDefects {
  DefectMap map;
  DefectReport report;
};
struct DarkOf {
  ImageView<const float> dark;  // a master
  Nanoseconds exposure{};
  double temperature_c = 20;
};
// Either master may be absent, not both. O(pixels), multi-threaded. Throws CalibrationError: no
// master (kUsage), unequal sizes, a dark without an exposure, a hundredth of all pixels defective
// (kBadData: that is no dark or no flat).
FoundDefects findDefects(const std::optional<DarkOf>& dark,
                         const std::optional<ImageView<const float>>& flat,
                         const ColourFilters& filters, const DefectOptions& options);

// Those that spoil a frame: hot ones by what their current gathers in its exposure at its
// temperature, doubling every `doubling_k`, and all others.
struct HotLimit {
  double least = 0.001;  // share of full scale
  double doubling_k = 6;
};
std::vector<Defect> defectsThatMatter(const DefectMap& map, Nanoseconds exposure,
                                      double temperature_c, const HotLimit& limit = {});

// What stands in for a defect: the median of these texels, the nearest of its colour that measure.
struct Repair {
  int x = 0, y = 0;
  std::vector<std::pair<int, int>> from;  // up to 8; empty: none is near, the texel is only marked
};
std::vector<Repair> repairsOf(const std::vector<Defect>& defects, SizePx size,
                              const ColourFilters& filters);
// In place, every channel of a texel. O(defects).
void repair(ImageView<float> frame, const std::vector<Repair>& repairs);

}  // namespace patina::calibration
