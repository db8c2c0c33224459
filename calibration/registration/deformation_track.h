// SPDX-License-Identifier: GPL-3.0-or-later
// How a surface warps over a run in which it changes its looks as well: each frame against the
// first and recent ones that still look like it.
#pragma once

#include <vector>

#include "calibration/registration/deformation.h"
#include "calibration/registration/deformation_refinement.h"

namespace patina::calibration {

struct DeformationTrackOptions {
  DeformationOptions field;
  double renew_zncc = 0.9;  // below it what is held on to has aged; 0: never renewed
  int recent = 2;           // pictures held on to beside the first (1 .. 16)
  // What shrinks or warps, [h][w] of the first frame, others 0: a patch or fiducials beside it stay
  // where they are and would hold it back. Empty: all of it.
  Image<std::uint8_t> specimen;
  void check() const;  // CalibrationError(kUsage): field, value, range
};

// Fields are against the first frame: what is held on to is that frame and later ones laid over it,
// all of which a frame is matched with at once, so fields are not chained and do not grow. Each
// starts from the field before it, or from what findDeformation finds, where that explains twice as
// much. Errors add up from one picture held on to to the next, not from frame to frame.
// Single-threaded use.
class DeformationTrack {
 public:
  explicit DeformationTrack(DeformationTrackOptions options);
  // The next frame, all of one size, and where the camera stood.
  Deformation add(ImageView<const float> frame, const Motion& frame_from_reference,
                  Progress& progress);
  int keyframesMade() const { return made_; }

 private:
  struct Held {
    PreparedPicture light;
    ColourPicture colours;
  };
  Held heldOf(ImageView<const float> frame, ImageView<const std::uint8_t> usable) const;
  Image<std::uint8_t> maskOf(SizePx size, const Motion& frame_from_reference) const;
  Deformation startOf(const PreparedPicture& held, const PreparedPicture& now,
                      const Deformation& last, Progress& progress) const;
  void renew(ImageView<const float> frame, const Deformation& found);

  DeformationTrackOptions options_;
  std::vector<Held> held_;  // the first frame, then recent ones, the latest last
  Deformation last_;
  int made_ = 0;
};

}  // namespace patina::calibration
