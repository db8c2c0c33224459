// SPDX-License-Identifier: GPL-3.0-or-later
// Poses of a run's frames, one after the other, against a frame that still looks like them.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "calibration/registration/registration.h"

namespace patina::calibration {

struct KeyframeOptions {
  AlignOptions align;  // its start is the track's own
  double renew_share =
      0.75;            // agreement below which a keyframe has aged; 0: never renewed (0 .. 1)
  int keyframes = 4;   // kept to come back to, the first always among them (1 .. 64)
  void check() const;  // CalibrationError(kUsage): field, value, range
};

// Poses are against the first frame. A frame is aligned to the current keyframe from the last
// trusted pose, so errors do not add up from frame to frame; they do from keyframe to keyframe.
// When a keyframe has aged, the oldest of those kept that still agrees takes its place, else the
// frame itself. Memory: about 20 bytes a pixel and keyframe. Single-threaded use.
class KeyframeTrack {
 public:
  // `usable`: what may be held on to, [h][w] of the first frame; empty: all of it.
  explicit KeyframeTrack(const KeyframeOptions& options, Image<std::uint8_t> usable = {});

  // The next frame. Where keyframes are renewed, its verdict goes by what is new since the last
  // trusted frame: what has aged slowly is not in the way, and slow loss of contrast is ageing.
  // `instead`: where it may lie when it is not where the last one was; tried first of all when
  // that leads nowhere.
  Alignment add(ImageView<const float> frame, Progress& progress,
                std::optional<Motion> instead = {});
  // From here on frames are compared with this one, which lies where it is said to.
  void renew(ImageView<const float> frame, const Motion& frame_from_reference);
  // The frame added last lies there, as is known better from elsewhere.
  void correct(const Motion& frame_from_reference);
  int keyframesMade() const { return made_; }

 private:
  struct Keyframe {
    PreparedPicture picture;
    Motion from_reference = kNoMotion;
  };
  Alignment against(const Keyframe& key, ImageView<const float> frame, const Motion& start,
                    bool search, Progress& progress) const;
  bool hasAged(const Agreement& agreement) const;
  void comeBackOrRenew(ImageView<const float> frame, Alignment& found, Progress& progress);

  KeyframeOptions options_;
  Image<std::uint8_t> usable_;
  std::vector<Keyframe> keys_;
  std::size_t current_ = 0;
  bool is_last_ = false;  // the current one is the frame added last
  int made_ = 0;
  Motion last_ = kNoMotion;                  // of the last trusted frame
  std::optional<Agreement> last_agreement_;  // of the same, with the current keyframe
};

}  // namespace patina::calibration
