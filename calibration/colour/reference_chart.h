// SPDX-License-Identifier: GPL-3.0-or-later
// The classic chart of 24 fields: what its fields are called and which colours they have.
#pragma once

#include <array>
#include <string>

#include "calibration/colour/colour_space.h"

namespace patina::calibration {

constexpr int kChartColumns = 6, kChartRows = 4, kChartFields = 24;
constexpr int kWhiteField = 18, kBlackField = 23;  // the greys are all from white to black

// Fields row by row from dark skin; the last row goes from white to black.
using ChartColours = std::array<Lab, kChartFields>;  // under D50, 2 degrees

// The maker changed the pigments in November 2014: the date stands on the back of the chart.
enum class ChartEdition { kBefore2014, kSince2014 };

// X-Rite, "ColorChecker Classic: new color specifications", 2016: means of many charts.
const ChartColours& chartColours(ChartEdition edition);
// Measured values of one's own chart: 24 lines "L a b", more columns before them allowed, '#' and
// lines without numbers are left out. Throws CalibrationError(kBadData).
ChartColours parseChartColours(const std::string& text);

const std::string& fieldName(int field);

}  // namespace patina::calibration
