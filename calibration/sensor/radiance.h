// SPDX-License-Identifier: GPL-3.0-or-later
// The pass from a sensor's numbers to linear light:
//
//   light = ((number - black) / (white - black) - dark) / flat * gain[colour]
//
// then defects are replaced. 1.0 is full scale before flat and gain. One kernel for mosaics and for
// pictures in colour, in blocks of rows on all cores; it moves 14 bytes a mosaic pixel (number 2,
// dark 4, flat 4, light 4) and is bound by memory. Originals are never touched.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "calibration/failure.h"
#include "calibration/sensor/colour_filters.h"
#include "calibration/sensor/defects.h"
#include "calibration/sensor/noise_model.h"
#include "calibration/sensor/response.h"
#include "processing/image/dng_file.h"
#include "processing/image/image.h"

namespace patina::calibration {

// Made once by prepareCorrection, used for many frames. Immutable, thread-safe.
struct SensorCorrection {
  SizePx size;
  int channels = 1;  // 1: a mosaic
  ColourFilters filters = kOneColour;
  Image<float> offset;  // [h][w][c] the dark; empty: none
  Image<float> factor;  // [h][w][c] 1 / flat; empty: 1
  std::vector<Repair> repairs;
};
// Masters are [h][w][c] of this size and as many channels; a texel where the flat is below 0.01 (no
// light) is not divided: it belongs to the defect map. Throws CalibrationError(kBadData).
SensorCorrection prepareCorrection(SizePx size, int channels, const ColourFilters& filters,
                                   std::optional<ImageView<const float>> dark,
                                   std::optional<ImageView<const float>> flat,
                                   const std::vector<Defect>& defects);

enum Mark : std::uint8_t { kSaturated = 1, kRepaired = 2 };  // bits of a mask
using ChannelGains = std::array<float, 3>;                   // of R, G and B; grey: the first

// A mosaic to light, [h][w][1], into `light`; `marks` (may be empty) says which pixels reached
// white and which are repaired. Throws CalibrationError(kBadData) for another size or other
// filters.
void toRadiance(const RawMosaic& raw, const SensorCorrection& correction, const ChannelGains& gain,
                ImageView<float> light, ImageView<std::uint8_t> marks = {});
// The same of a picture that is linear already, in place.
void correctLinear(ImageView<float> frame, const SensorCorrection& correction,
                   const ChannelGains& gain);

// How many pictures lie behind a mean and its masters; 0: a master without noise.
struct Averaged {
  int frames = 1, dark_frames = 0, flat_frames = 0;
  // Share of full scale of the flats where the master is 1, a colour.
  std::array<double, 3> flat_levels{0.5, 0.5, 0.5};
};
// Variance of corrected light, [h][w][c], in its units squared: shot, read and rounding noise of
// the frames, and of the masters; with a `response` also that of rounding to its codes (1/12 of a
// code's step squared: holds where noise is above a third of a step). Of a repaired pixel: as if it
// measured. O(pixels).
Image<float> varianceOfLight(ImageView<const float> light, const SensorCorrection& correction,
                             const ChannelGains& gain, const NoiseModels& noise,
                             const Averaged& averaged = {},
                             const ResponseCurve* response = nullptr);

}  // namespace patina::calibration
