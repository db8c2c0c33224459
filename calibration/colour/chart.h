// SPDX-License-Identifier: GPL-3.0-or-later
// What a camera saw of each field of a chart.
//
// A chart is where the middles of its four corner fields are; its fields lie on a grid between
// them, whatever the gaps. Places in a picture: pixel centres at whole numbers, y down.
#pragma once

#include "calibration/colour/reference_chart.h"
#include "calibration/place.h"
#include "processing/image/image.h"

namespace patina::calibration {

// The middles of dark skin, bluish green, black and white, as the chart's maker lays it out.
using ChartCorners = std::array<PlacePx, 4>;

struct FieldSample {
  Rgb mean{};    // share of full scale; the upper and lower tenth of the texels left out
  Rgb spread{};  // standard deviation of all texels
  // How much the worst ninth of the field differs from the whole beyond what noise explains; share
  // of the field's level, but not of less than a twentieth of the white field's.
  double unevenness = 0;
  double saturated = 0;  // share of the texels with a sample at the top
  int texels = 0;
  PlacePx middle_px;
};
struct ChartSamples {
  ChartCorners corners;
  std::array<FieldSample, kChartFields> fields;
  double pitch_px = 0;  // from field to field, the shorter way
  double tilt_deg = 0;  // of its plane to the picture's, from how unlike its two pitches are
};

struct SampleOptions {
  double inner_share = 0.4;  // side of what is taken, share of the pitch, in [0.05, 0.6]
  double saturation = 0.98;  // a sample from here on is saturated, share of full scale, in (0, 1]
  void check() const;
};
// `linear` is [h][w][3], linear light. Throws CalibrationError(kBadData): not three channels, a
// field that is cut off by the frame, fields of fewer than 36 texels, corners that are no chart's.
// O(texels of the fields).
ChartSamples sampleChart(ImageView<const float> linear, const ChartCorners& corners,
                         const SampleOptions& options);

// How the four corners lie on the chart.
enum class ChartSense { kUpright, kTurned, kMirrored };
struct ChartOrientation {
  ChartSense sense = ChartSense::kUpright;
  // RMS of what the best 3x3 matrix leaves of the colours in that sense, share of their Y; beyond
  // 0.4 it is no such chart.
  double misfit = 0;
};
// Tries the chart upright, turned by half a turn, and both mirrored.
ChartOrientation orientationOf(const ChartSamples& samples, const ChartColours& expected);
// The same samples with the fields in the maker's order.
ChartSamples turnedRound(const ChartSamples& samples);

}  // namespace patina::calibration
