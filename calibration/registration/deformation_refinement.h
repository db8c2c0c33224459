// SPDX-License-Identifier: GPL-3.0-or-later
// A field of displacements made finer where a surface changes its looks as well: ripens, dries,
// cracks.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "calibration/registration/deformation.h"

namespace patina::calibration {

// log(light + floor) of each channel, [h][w], slightly smoothed; a picture of one channel counts as
// three alike.
struct ColourPicture {
  std::array<Image<float>, 3> log_light;
  Image<float> usable;  // 1, or 0: leave out
  SizePx size() const { return usable.size(); }
};

// `linear`: [h][w] or [h][w][3]; `mask` 0: leave out, 3 px around it as well.
ColourPicture colourPicture(ImageView<const float> linear,
                            std::optional<ImageView<const std::uint8_t>> mask = {});
// As the reference of `field` would show it; 0 in `usable` where it is beyond the picture.
ColourPicture laidOver(const ColourPicture& picture, const Deformation& field);

// Finds `field` anew, from what it is, against all `references` at once; all of one size. Returns
// how well each agrees: zncc of green, over what has not changed.
//
// Per reference, e = what the frame shows there - the reference, less the local mean, weighed by
// the inverse of e's own covariance over the colours: a spot that comes or a halo ahead of it has a
// colour of its own, motion that of the surface. Residuals far out (Tukey's biweight) count
// nothing. The place of sharp detail is known no better than the mosaic samples it, red and blue
// worse than green. Slopes that only one of the two shows, as those of noise, tell nothing, however
// steep (displacement_grid.h). The field is bilinear between its points; it leaves the field it had
// by as little bending as fits (second differences). Gauss-Newton and conjugate gradients. Follows
// a pixel or two. O(pixels x references); multi-threaded; the same for any number of threads.
std::vector<double> refineDeformation(const std::vector<const ColourPicture*>& references,
                                      const ColourPicture& frame, Deformation& field,
                                      Progress& progress);

}  // namespace patina::calibration
