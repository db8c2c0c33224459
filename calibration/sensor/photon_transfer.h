// SPDX-License-Identifier: GPL-3.0-or-later
// Photon transfer: gain, read noise, full well and linearity of a sensor, from pairs of pictures.
//
//   variance(mean) = read^2 + 1/12 + mean / K              [numbers^2], mean above the dark
//
// The variance is half that of the difference of two pictures of one light, so that what is the
// same in both (spread of the pixels' response, vignetting, dark offsets) cancels.
// Papers: J. R. Janesick, "Photon Transfer", 2007, chapter 5; EMVA Standard 1288, release 4.0,
// sections 2.2 and 6.6. Departures: statistics are taken in tiles, so that one uneven picture gives
// many levels, the lamp's change between the two is divided out, and read noise below one step of
// the converter is solved from the rounding itself, not by the law of 1/12.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "calibration/failure.h"
#include "calibration/sensor/noise_model.h"
#include "processing/image/dng_file.h"
#include "processing/image/progress.h"

namespace patina::calibration {

struct RawPair {
  RawMosaic first, second;  // of one light and exposure
};
using PairSource = std::function<std::optional<RawPair>()>;  // nothing at the end

struct PhotonTransferOptions {
  int tile_px = 32;           // side of a tile, 8 to 1024, even
  double unequal_max = 0.05;  // share by which the two of a pair may differ in level, to 0.5
  void check() const;         // throws CalibrationError(kUsage)
};

// A pair of flats, of one colour.
struct TransferLevel {
  double mean = 0, variance = 0;       // in numbers above dark, and squared
  std::optional<double> exposure_s{};  // as the files say
};
struct PhotonTransfer {
  NoiseModels noise;
  struct Channel {
    std::vector<TransferLevel> levels;  // those without saturated pixels
    double residual = 0;                // RMS of measured over fitted variance - 1, over levels
    double gain_error = 0;              // one standard error, share of the gain
    // Largest departure from a line through the dark, share of the level; nothing where all pairs
    // have one exposure or fewer than three levels count.
    std::optional<double> nonlinearity{};
    bool well_filled = false;  // some flat reached the top; else full_well_e is a lower bound
  };
  std::array<Channel, 3> channels;
  int dark_pairs = 0, flat_pairs = 0;
  std::int64_t hot_left_out = 0;  // pixels far above their colour's dark
};

// At least one dark pair and two levels of flats, some of them dim; at most 10 % of white apart
// from each other they give no gain. One thread, O(pixels); memory: one pair and a byte a pixel.
// Throws CalibrationError(kBadData): no pairs, unequal sizes or filters, a pair of two lights,
// everything saturated, a range of levels under 10 % of white.
PhotonTransfer measurePhotonTransfer(const PairSource& darks, const PairSource& flats,
                                     const PhotonTransferOptions& options, Progress& progress);

}  // namespace patina::calibration
