// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/registration/pose_track.h"

#include <algorithm>
#include <string>
#include <utility>

#include "calibration/failure.h"

namespace patina::calibration {
namespace {

// A specimen that looks unlike what was seen before for so many frames has changed; it is not
// hidden.
constexpr int kChangedAfter = 3;
// Likeness from which a jump of the specimen is believed.
constexpr double kSureZncc = 0.75;
// A jump must stand out of what the answer may be wrong by.
constexpr double kSigmas = 6;

Image<std::uint8_t> inverted(const Image<std::uint8_t>& mask) {
  Image<std::uint8_t> out = mask;
  for (std::uint8_t& value : out.texels()) value = value ? 0 : 255;
  return out;
}

void judge(const Alignment& by, const AlignOptions& options, FramePose& pose) {
  pose.verdict = by.verdict;
  pose.reason = reasonOf(by.verdict, by.agreement, options);
}

void describe(const Alignment& by, FramePose& pose) {
  const Agreement& a = by.agreement;
  pose.share = a.share;
  pose.uncertainty_px = a.uncertainty_px;
  pose.contrast = a.contrast_coarse;
  pose.sharpness = a.contrast_coarse > 0 ? a.contrast_fine / a.contrast_coarse : 0;
  pose.covered_px = a.covered_px;
}

}  // namespace

const char* name(EpochCause cause) {
  constexpr const char* kNames[] = {"start", "camera", "specimen", "camera or specimen"};
  return kNames[static_cast<int>(cause)];
}

void TrackOptions::check() const {
  keys.check();
  if (!(bump_px >= 0.1 && bump_px <= 1000))
    throw CalibrationError(Exit::kUsage, "registration: bump_px is " + std::to_string(bump_px) +
                                             "; allowed: 0.1 to 1000");
}

PoseTrack::PoseTrack(TrackOptions options) : options_(std::move(options)) {
  options_.check();
  if (options_.outside.empty()) {
    specimen_ = std::make_unique<KeyframeTrack>(options_.keys);
    return;
  }
  KeyframeOptions for_ever = options_.keys;
  for_ever.renew_share = 0;
  outside_ = std::make_unique<KeyframeTrack>(for_ever, options_.outside);
  specimen_ = std::make_unique<KeyframeTrack>(options_.keys, inverted(options_.outside));
}

int PoseTrack::keyframesMade() const { return specimen_->keyframesMade(); }

void PoseTrack::noteJump(const Motion& now, EpochCause cause, const FramePose& pose, SizePx size) {
  const Motion& before = cause == EpochCause::kSpecimen ? own_ : camera_;
  const double jump = cornersApart(now, before, size);
  if (jump <= std::max(options_.bump_px, kSigmas * pose.uncertainty_px)) return;
  if (cause == EpochCause::kSpecimen) kept_ = chained(chained(now, inverse(own_)), kept_);
  epochs_.push_back({pose.frame, cause, jump, kNoMotion});
}

FramePose PoseTrack::add(ImageView<const float> frame, Progress& progress) {
  FramePose pose;
  pose.frame = frames_++;
  if (epochs_.empty()) epochs_.emplace_back();
  const std::size_t epochs = epochs_.size();
  if (outside_) {
    addByOutside(frame, pose, progress);
  } else {
    const Alignment found = specimen_->add(frame, progress);
    describe(found, pose);
    judge(found, options_.keys.align, pose);
    pose.placed = found.verdict != Verdict::kLost;
    pose.frame_from_reference = found.frame_from_reference;
    if (isTrusted(pose.verdict)) {
      noteJump(found.frame_from_reference, EpochCause::kEither, pose, frame.size());
      camera_ = found.frame_from_reference;
    }
  }
  for (std::size_t k = epochs; k < epochs_.size(); ++k)
    epochs_[k].frame_from_reference = pose.frame_from_reference;
  pose.epoch = static_cast<int>(epochs_.size()) - 1;
  return pose;
}

void PoseTrack::settle(ImageView<const float> frame, const Motion& frame_from_reference,
                       bool changed) {
  camera_ = chained(frame_from_reference, inverse(kept_));
  if (changed) {
    specimen_->renew(frame, chained(camera_, own_));
    lost_in_a_row_ = 0;
  } else if (!outside_) {
    specimen_->correct(camera_);
  }
}

void PoseTrack::addByOutside(ImageView<const float> frame, FramePose& pose, Progress& progress) {
  const Alignment specimen = specimen_->add(frame, progress);
  // A bumped camera takes both along, and the specimen has more to hold on to.
  const Alignment camera =
      outside_->add(frame, progress,
                    isTrusted(specimen.verdict)
                        ? std::optional(chained(specimen.frame_from_reference, inverse(own_)))
                        : std::nullopt);
  describe(camera, pose);
  pose.placed = camera.verdict != Verdict::kLost;
  pose.outside_good = isTrusted(camera.verdict);
  judge(specimen.verdict > camera.verdict ? specimen : camera, options_.keys.align, pose);
  if (specimen.verdict > camera.verdict) pose.covered_px = specimen.agreement.covered_px;
  pose.frame_from_reference = chained(camera.frame_from_reference, kept_);
  if (!isTrusted(camera.verdict)) return;
  if (specimen.verdict >= Verdict::kCovered && ++lost_in_a_row_ > kChangedAfter) {
    specimen_->renew(frame, chained(camera.frame_from_reference, own_));
    judge(camera, options_.keys.align, pose);
    lost_in_a_row_ = 0;
  }
  if (specimen.verdict < Verdict::kCovered) lost_in_a_row_ = 0;
  if (!isTrusted(specimen.verdict)) return;
  noteJump(camera.frame_from_reference, EpochCause::kCamera, pose, frame.size());
  camera_ = camera.frame_from_reference;
  FramePose by_specimen = pose;
  by_specimen.uncertainty_px = std::max(pose.uncertainty_px, specimen.agreement.uncertainty_px);
  const Motion own = chained(inverse(camera_), specimen.frame_from_reference);
  const bool jumps = cornersApart(own, own_, frame.size()) > options_.bump_px;
  if (jumps && specimen.agreement.zncc < kSureZncc) {  // it has changed; that it moved is a guess
    specimen_->renew(frame, chained(camera_, own_));
    pose.frame_from_reference = chained(camera_, kept_);
    return;
  }
  noteJump(own, EpochCause::kSpecimen, by_specimen, frame.size());
  own_ = own;
  pose.frame_from_reference = chained(camera_, kept_);
}

}  // namespace patina::calibration
