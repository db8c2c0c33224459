// SPDX-License-Identifier: GPL-3.0-or-later
// How a surface warps over a run in which it changes its looks as well: each frame against a recent
// one that still looks like it.
#pragma once

#include "calibration/registration/deformation.h"

namespace patina::calibration {

struct DeformationTrackOptions {
  DeformationOptions field;
  double renew_zncc = 0.75;  // below it the picture that is held on to has aged; 0: never renewed
  // What shrinks or warps, [h][w] of the first frame, others 0: a patch or fiducials beside it stay
  // where they are and would hold it back. Empty: all of it.
  Image<std::uint8_t> specimen;
  void check() const;  // CalibrationError(kUsage): field, value, range
};

// Fields are against the first frame: what is held on to is that frame, or a later one laid over
// it, so fields are not chained and do not grow. Errors add up from one such picture to the next,
// not from frame to frame; and the first is returned to as soon as it fits again. Single-threaded
// use.
class DeformationTrack {
 public:
  explicit DeformationTrack(DeformationTrackOptions options);
  // The next frame, all of one size, and where the camera stood.
  Deformation add(ImageView<const float> frame, const Motion& frame_from_reference,
                  Progress& progress);
  int keyframesMade() const { return made_; }

 private:
  PreparedPicture prepared(ImageView<const float> frame, const Motion& frame_from_reference) const;
  bool hasAged(const Deformation& found) const;
  void renew(ImageView<const float> frame, const Deformation& found);

  DeformationTrackOptions options_;
  PreparedPicture first_, recent_;  // recent_ has no levels while the first is held on to
  int made_ = 0;
};

}  // namespace patina::calibration
