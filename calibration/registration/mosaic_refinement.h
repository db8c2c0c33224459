// SPDX-License-Identifier: GPL-3.0-or-later
// A shift made exact where a few specks, finer than the mosaic that samples them, are all there is.
#pragma once

#include "calibration/registration/agreement.h"
#include "calibration/registration/motion.h"
#include "calibration/registration/prepared_picture.h"

namespace patina::calibration {

struct MosaicShift {
  Motion frame_from_reference = kNoMotion;
  double uncertainty_px = 0;  // by the jackknife over blocks of 16 px; infinite: nothing was found
};

// No colour is interpolated before it is compared: each picture's photosites, over the mean of
// their colour around, are predicted from those of the other by simple kriging (Rasmussen and
// Williams, "Gaussian Processes for Machine Learning", 2006, equations 2.25 and 2.26), and the
// shift is what makes the sum of squares over the predicted variance least, both ways. The prior is
// the covariance that the colours have where something stands out, falling off by exp(-d / 1.4 px),
// so a red speck is told by green as well, however faint, and counts where it was sampled. `start`
// must be a translation and right to half a pixel. Pixels of blocks that disagree are left out.
// Nothing is found where what stands out varies by less than 20 times the noise. O(pixels);
// deterministic; single-threaded.
MosaicShift refineByPhotosites(const PreparedPicture& reference, const PreparedPicture& frame,
                               const Motion& start, const Agreement& agreement);

}  // namespace patina::calibration
