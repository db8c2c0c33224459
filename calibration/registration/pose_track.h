// SPDX-License-Identifier: GPL-3.0-or-later
// A run's poses and what befell them: which frames cannot be trusted, and where a bump begins a
// new epoch.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "calibration/registration/keyframe_track.h"

namespace patina::calibration {

struct TrackOptions {
  KeyframeOptions keys;
  double bump_px = 1.0;  // a corner's jump against the last trusted frame (0.1 .. 1000)
  // What is NOT the specimen and does not age, [h][w] of the first frame, others 0: fiducials,
  // patch, background. Empty: recent frames are held on to.
  Image<std::uint8_t> outside;
  void check() const;  // CalibrationError(kUsage): field, value, range
};

enum class EpochCause { kStart, kCamera, kSpecimen, kEither };
const char* name(EpochCause cause);

// Frames from `first_frame` on lie otherwise than those before. With an outside, what moved is
// known: the camera (all of the picture) or the specimen (all but the outside). Without, either.
struct PoseEpoch {
  std::int64_t first_frame = 0;
  EpochCause cause = EpochCause::kStart;
  double jump_px = 0;                       // of the corner that went farthest
  Motion frame_from_reference = kNoMotion;  // of its first frame
};

struct FramePose {
  std::int64_t frame = 0;                   // count of add()
  Motion frame_from_reference = kNoMotion;  // of the specimen
  Verdict verdict = Verdict::kGood;
  std::string reason;         // why it is not good, with numbers: reasonOf()
  bool placed = false;        // where it lies was found, whatever else is the matter
  bool outside_good = false;  // the outside can be trusted: nothing is the matter with the lens
  double share = 0, uncertainty_px = 0;  // of what was held on to
  double contrast = 1, sharpness = 1;    // coarse; fine over coarse
  RectPx covered_px;                     // px of the keyframe: what is in the way or walks through
  int epoch = 0;
};

// Frames in order of time. With an outside its pose is the camera's, against the first frame for
// ever: the specimen may change completely. The specimen's own jumps are found between frames
// that still look alike and are kept, its slow changes are not followed. Single-threaded use.
class PoseTrack {
 public:
  explicit PoseTrack(TrackOptions options);
  FramePose add(ImageView<const float> frame, Progress& progress);
  // The frame added last lies there, as others of the same moment tell. `changed`: it can be
  // trusted against its verdict; what comes is compared with it.
  void settle(ImageView<const float> frame, const Motion& frame_from_reference, bool changed);
  const std::vector<PoseEpoch>& epochs() const { return epochs_; }
  int keyframesMade() const;

 private:
  // The camera's pose from the outside; `pose` is filled from what the specimen shows.
  void addByOutside(ImageView<const float> frame, FramePose& pose, Progress& progress);
  void noteJump(const Motion& now, EpochCause cause, const FramePose& pose, SizePx size);

  TrackOptions options_;
  std::unique_ptr<KeyframeTrack> outside_, specimen_;  // without an outside: specimen_ is all
  std::vector<PoseEpoch> epochs_;
  std::int64_t frames_ = 0;
  int lost_in_a_row_ = 0;
  Motion camera_ = kNoMotion;                  // of the last trusted frame
  Motion own_ = kNoMotion, kept_ = kNoMotion;  // the specimen's own: as tracked; its jumps alone
};

}  // namespace patina::calibration
