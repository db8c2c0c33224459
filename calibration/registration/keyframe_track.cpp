// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/registration/keyframe_track.h"

#include <algorithm>
#include <string>
#include <utility>

#include "calibration/failure.h"

namespace patina::calibration {
namespace {

constexpr double kLeastContrast = 0.05;

}  // namespace

void KeyframeOptions::check() const {
  align.check();
  if (!(renew_share >= 0 && renew_share <= 1))
    throw CalibrationError(Exit::kUsage, "registration: renew_share is " +
                                             std::to_string(renew_share) + "; allowed: 0 to 1");
  if (keyframes < 1 || keyframes > 64)
    throw CalibrationError(Exit::kUsage, "registration: keyframes is " + std::to_string(keyframes) +
                                             "; allowed: 1 to 64");
}

KeyframeTrack::KeyframeTrack(const KeyframeOptions& options, Image<std::uint8_t> usable)
    : options_(options), usable_(std::move(usable)) {
  options_.check();
}

void KeyframeTrack::renew(ImageView<const float> frame, const Motion& frame_from_reference) {
  Keyframe key;
  key.from_reference = frame_from_reference;
  if (usable_.empty()) {
    key.picture = preparePicture(frame);
  } else if (keys_.empty()) {
    key.picture = preparePicture(frame, std::as_const(usable_).view());
  } else {
    const Image<std::uint8_t> mask =
        maskInFrame(keys_.front().picture, frame_from_reference, frame.size());
    key.picture = preparePicture(frame, mask.view());
  }
  if (static_cast<int>(keys_.size()) == options_.keyframes && keys_.size() > 1)
    keys_.erase(keys_.begin() + 1);
  keys_.push_back(std::move(key));
  current_ = keys_.size() - 1;
  is_last_ = true;
  ++made_;
  last_ = frame_from_reference;
  last_agreement_.reset();
}

void KeyframeTrack::correct(const Motion& frame_from_reference) {
  last_ = frame_from_reference;
  if (is_last_) keys_[current_].from_reference = frame_from_reference;
}

Alignment KeyframeTrack::against(const Keyframe& key, ImageView<const float> frame,
                                 const Motion& start, bool search, Progress& progress) const {
  AlignOptions options = options_.align;
  options.start = chained(start, inverse(key.from_reference));
  options.search = search;
  Alignment found = align(frame, key.picture, options, progress);
  found.frame_from_reference = chained(found.frame_from_reference, key.from_reference);
  return found;
}

Alignment KeyframeTrack::add(ImageView<const float> frame, Progress& progress,
                             std::optional<Motion> instead) {
  if (keys_.empty()) {
    renew(frame, kNoMotion);
    Alignment first;
    first.agreement = agreementOf(keys_[0].picture, keys_[0].picture, kNoMotion);
    first.verdict = verdictOf(first.agreement, options_.align);
    return first;
  }
  is_last_ = false;
  const Keyframe& key = keys_[current_];
  Alignment found = against(key, frame, last_, options_.align.search && !instead, progress);
  if (instead && found.verdict == Verdict::kLost)
    found = against(key, frame, *instead, options_.align.search, progress);
  const Agreement whole = found.agreement;
  if (options_.renew_share > 0 && last_agreement_ && found.verdict != Verdict::kLost) {
    findCovered(found.agreement, last_agreement_->blocks);
    found.agreement.contrast_fine /= std::max(last_agreement_->contrast_fine, kLeastContrast);
    found.agreement.contrast_coarse /= std::max(last_agreement_->contrast_coarse, kLeastContrast);
    found.verdict = verdictOf(found.agreement, options_.align);
  }
  if (!isTrusted(found.verdict)) return found;
  last_ = found.frame_from_reference;
  last_agreement_ = whole;
  if (hasAged(whole)) comeBackOrRenew(frame, found, progress);
  return found;
}

bool KeyframeTrack::hasAged(const Agreement& agreement) const {
  return agreement.share < options_.renew_share || agreement.contrast_fine < options_.renew_share;
}

void KeyframeTrack::comeBackOrRenew(ImageView<const float> frame, Alignment& found,
                                    Progress& progress) {
  for (std::size_t k = 0; k < keys_.size(); ++k) {
    if (k == current_) continue;
    const Alignment other = against(keys_[k], frame, last_, false, progress);
    if (!isTrusted(other.verdict) || hasAged(other.agreement)) continue;
    current_ = k;
    last_ = other.frame_from_reference;
    last_agreement_ = other.agreement;
    found.frame_from_reference = other.frame_from_reference;
    return;
  }
  renew(frame, found.frame_from_reference);
}

}  // namespace patina::calibration
