// SPDX-License-Identifier: GPL-3.0-or-later
// Poses of sweeps: pictures of one moment under one lamp after the other, all taken from where the
// camera stood then.
//
// Each lamp's pictures are tracked by themselves, because light from one side is alike from sweep
// to sweep; what they find is one pose. Together they also tell ageing, which most lamps see, from
// what is in the way, which is gone a few shots on: a lamp alone cannot.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "calibration/registration/pose_track.h"

namespace patina::calibration {

struct SweepFrame {
  std::size_t lamp = 0;
  ImageView<const float> picture;
};

struct SweepFramePose {
  FramePose pose;  // verdict and reason are its own track's, the motion is where it is taken to lie
  bool used = false;
  bool changed = false;  // used against its verdict: the specimen looks otherwise than before
  bool apart = false;    // it lies where it says itself: on the other side of a bump
};
struct SweepPoses {
  std::vector<SweepFramePose> frames;          // as the sweep's
  std::optional<Motion> frame_from_reference;  // shared; nothing: too few lamps tell one
  double uncertainty_px = 0;                   // of the shared one
};

// The reference is the first sweep, all of which is used. Later ones share the weighted mean of
// what their lamps found, without those that stand aside. Where two trusted frames or more, the
// sweep's first or its last, lie in another place together, farther away than a bump, they keep it;
// a frame that says so alone is mistaken and not trusted. One that is not trusted is used all the
// same, and held on to, where that is ageing:
// - at once where something else is seen under most lamps of at least four; not where most show
//   fog or blur, unless the outside is clear;
// - where its lamp's frame of the sweep before was not trusted either: nothing is in the way of one
//   lamp twice, and what stays as it is has changed.
// Never where fewer than a quarter of the lamps tell one pose, nor in a sweep with a bump within.
// Memory: a PoseTrack a lamp. Single-threaded use.
class SweepTrack {
 public:
  // `options.outside`: of the first sweep's frames.
  explicit SweepTrack(TrackOptions options) : options_(std::move(options)) {}
  // Frames of one size in order of time, at most one a lamp. Throws as PoseTrack.
  SweepPoses add(std::span<const SweepFrame> frames, Progress& progress);

 private:
  struct Lamp {
    std::unique_ptr<PoseTrack> track;
    Motion first_from_reference = kNoMotion;
    bool doubted_before = false;
  };
  Lamp& lampOf(std::size_t number);
  bool findBump(SizePx size, const std::vector<bool>& tracked, SweepPoses& out) const;
  void begin(Lamp& lamp, const SweepFrame& frame, const std::optional<Motion>& shared, bool first,
             SweepFramePose& out, Progress& progress) const;

  TrackOptions options_;
  std::vector<Lamp> lamps_;
  bool begun_ = false;
};

}  // namespace patina::calibration
