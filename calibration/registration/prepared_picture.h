// SPDX-License-Identifier: GPL-3.0-or-later
// A picture made ready for registration: what is left of it when the light is taken out.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "calibration/registration/photosites.h"
#include "processing/image/image.h"

namespace patina::calibration {

// [h][w]; l = log(luma + floor), slightly smoothed, so that light becomes something added.
struct PictureLevel {
  Image<float> log_light;      // l
  Image<float> local;          // d / sqrt(mean of d^2 + kFlat^2), d = l - mean of l, over kWindowPx
  Image<std::uint8_t> usable;  // 0: leave out. Empty: all of it is used

  SizePx size() const { return local.size(); }
};
constexpr int kWindowPx = 17;
constexpr float kFlat = 0.03f;  // a relative contrast below which a surface counts as flat

// levels[k] is 2^k times smaller. A gain takes nothing from `local`, a gradient or the inside of a
// shadow next to nothing. Immutable once made.
struct PreparedPicture {
  std::vector<PictureLevel> levels;
  Image<std::uint8_t> mask;  // as it was given
  Photosites photosites;     // of the mosaic that the picture was made of
  SizePx size() const { return levels.front().size(); }
};

// `linear`: [h][w] or [h][w][3], any unit. `usable`: [h][w]; nothing beyond it is looked at, so
// 3 px along its edges are lost.
// `levels` 0: down to a shorter side of 32 px. Throws CalibrationError(kBadData) for a picture
// under 32 px or another size of the mask. O(pixels), multi-threaded; the same for any number.
PreparedPicture preparePicture(ImageView<const float> linear,
                               std::optional<ImageView<const std::uint8_t>> usable = {},
                               int levels = 0);

}  // namespace patina::calibration
