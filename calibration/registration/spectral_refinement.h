// SPDX-License-Identifier: GPL-3.0-or-later
// The last step on a surface that is nearly blank: a shift by the phases of those frequencies that
// carry a signal.
#pragma once

#include "calibration/registration/agreement.h"
#include "calibration/registration/motion.h"
#include "calibration/registration/prepared_picture.h"

namespace patina::calibration {

struct SpectralShift {
  Motion frame_from_reference = kNoMotion;
  // Standard error by the Cramer-Rao bound of the coherence that was found, sqrt(x^2 + y^2).
  // Infinite where nothing is coherent; the pose is then the start's.
  double uncertainty_px = 0;
};

// Each frequency's phase counts by C^2 / (1 - C^2), C the coherence of frame and reference in its
// ring of the spectrum: the maximum-likelihood estimate of a delay in noise (Hannan and Thomson
// 1973; Knapp and Carter, "The generalized correlation method for estimation of time delay", 1976,
// equation 21), here in two dimensions. So noise decides at which blur the pictures are matched.
// `start` is a translation, right to about a pixel of agreement.level; blocks that disagree are
// left out. log_light of agreement.level is matched: 512 px of 1024. O(n log n).
SpectralShift refineBySpectrum(const PreparedPicture& reference, const PreparedPicture& frame,
                               const Motion& start, const Agreement& agreement);

}  // namespace patina::calibration
