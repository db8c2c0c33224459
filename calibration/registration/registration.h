// SPDX-License-Identifier: GPL-3.0-or-later
// Where a frame lies against a reference, and whether the answer can be trusted.
//
// From the pose given, by the refinement of refinement.h on pictures from which the light is taken
// out; where the answer does not agree, from SIFT (else phase correlation) once more. Blocks that
// disagree (something is in the way) are left out of a last refinement.
#pragma once

#include <optional>
#include <string>

#include "calibration/registration/agreement.h"
#include "calibration/registration/motion.h"
#include "calibration/registration/prepared_picture.h"
#include "processing/image/progress.h"

namespace patina::calibration {

struct AlignOptions {
  MotionModel model = MotionModel::kTranslation;
  Motion start = kNoMotion;        // the last frame's
  bool search = true;              // by features when the start leads nowhere
  int finest_level = 0;            // 1: half of the resolution is enough (0 .. 4)
  double least_share = 0.5;        // of blocks that agree, to be trusted (0 .. 1)
  double least_contrast = 0.8;     // of the reference's; below it is fog (0 .. 1)
  double least_sharpness = 0.7;    // fine contrast over coarse; below it is blur (0 .. 1)
  double most_uncertain_px = 0.5;  // standard error; above it nothing was found (0 .. 100)
  double most_covered = 0.04;      // largest connected part that disagrees (0 .. 1)
  double least_spot = 0.002;       // of the same, to be remarked on (0 .. 1)
  void check() const;              // CalibrationError(kUsage): field, value, range
};

enum class Verdict {
  kGood,
  kSpot,     // good, but something small is in the picture: an insect
  kBlurred,  // placed, but out of focus against the reference
  kFogged,   // condensation, fog, a lamp into the lens: contrast is gone
  kCovered,  // a large connected part disagrees: a hand
  kLost      // no pose was found: another scene, darkness
};
const char* name(Verdict verdict);
// kGood and kSpot: the frame may go into a texture. Of the others the pose may still be right.
bool isTrusted(Verdict verdict);

enum class Start { kGiven, kFeatures, kPhase };

struct Alignment {
  Motion frame_from_reference = kNoMotion;
  Agreement agreement;
  Verdict verdict = Verdict::kLost;
  Start start = Start::kGiven;
  int iterations = 0;
};

// A reference is prepared once for many frames. Its mask says what may be held on to.
// Translation from a good start: 75 ms of CPU for 1024x1024, on all cores, the frame's preparation
// included; other models 0.4 s and more (tests/bench/registration_bench.cpp). Multi-threaded; the
// same answer for any number of threads. Throws CalibrationError for what cannot be registered at
// all (preparePicture); never for a frame that does not agree.
Alignment align(ImageView<const float> frame, const PreparedPicture& reference,
                const AlignOptions& options, Progress& progress);
// The same where the frame is prepared already: as it would be from `start`.
Alignment align(const PreparedPicture& frame, const PreparedPicture& reference,
                const AlignOptions& options, Progress& progress);

Verdict verdictOf(const Agreement& agreement, const AlignOptions& options);
// Why it is not good, with numbers and what is wanted: "too little structure: 0.71 px expected,
// wanted 0.50 px". Empty for kGood.
std::string reasonOf(Verdict verdict, const Agreement& agreement, const AlignOptions& options);

// A mask of the reference as the frame has it.
Image<std::uint8_t> maskMoved(ImageView<const std::uint8_t> mask,
                              const Motion& frame_from_reference, SizePx frame);
// The reference's own.
Image<std::uint8_t> maskInFrame(const PreparedPicture& reference, const Motion& motion,
                                SizePx frame);

}  // namespace patina::calibration
