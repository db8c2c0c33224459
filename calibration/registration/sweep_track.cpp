// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/registration/sweep_track.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace patina::calibration {
namespace {

constexpr std::size_t kLampsThatOutvote = 4;  // fewer can be covered by one hand
// Of a lamp's pose beside its standard error: what ageing pulls it by.
constexpr double kOwnPx = 0.03;
constexpr double kAsidePx = 0.25, kAsideSigmas = 3;  // from the middle of all: it takes no part
constexpr double kBumpSigmas = 6;
constexpr double kQuorum = 0.25;  // of the sweep's lamps: so many must tell one pose

struct Vote {
  Motion motion = kNoMotion;
  double weight = 0, error_px = 0;
};

double quorumOf(const std::vector<SweepFramePose>& frames) {
  return kQuorum * static_cast<double>(frames.size());
}

// Where those that are trusted suffice, the others are not asked.
std::vector<Vote> votesOf(const std::vector<SweepFramePose>& frames,
                          const std::vector<bool>& tracked) {
  const auto collect = [&](auto counts) {
    std::vector<Vote> votes;
    for (std::size_t k = 0; k < frames.size(); ++k) {
      if (!tracked[k] || !counts(frames[k].pose)) continue;
      const double error_px = std::hypot(frames[k].pose.uncertainty_px, kOwnPx);
      votes.push_back({frames[k].pose.frame_from_reference, 1 / (error_px * error_px), error_px});
    }
    return votes;
  };
  std::vector<Vote> trusted =
      collect([](const FramePose& pose) { return isTrusted(pose.verdict); });
  if (trusted.size() > 2 && static_cast<double>(trusted.size()) >= quorumOf(frames)) return trusted;
  return collect([](const FramePose& pose) { return pose.placed; });
}

// The vote that the others are nearest to; those farther away than a bump count as that.
const Vote& middleOf(const std::vector<Vote>& votes, double bump_px, SizePx size) {
  const auto apart = [&](const Vote& of) {
    double sum = 0;
    for (const Vote& other : votes)
      sum += other.weight * std::min(cornersApart(of.motion, other.motion, size), bump_px);
    return sum;
  };
  const Vote* best = &votes.front();
  double least = std::numeric_limits<double>::infinity();
  for (const Vote& vote : votes)
    if (const double sum = apart(vote); sum < least) least = sum, best = &vote;
  return *best;
}

void share(const std::vector<Vote>& votes, double bump_px, SizePx size, SweepPoses& out) {
  if (votes.empty()) return;
  const Vote& middle = middleOf(votes, bump_px, size);
  Motion mean = middle.motion;
  double weight = 0;
  int agreed = 0;
  for (const Vote& vote : votes) {
    const double aside_px = cornersApart(vote.motion, middle.motion, size);
    if (aside_px > std::max(kAsidePx, kAsideSigmas * vote.error_px)) continue;
    weight += vote.weight;
    ++agreed;
    // So that what is 1 or 0 in all of them stays exactly that.
    for (std::size_t i = 0; i < mean.size(); ++i)
      mean[i] += (vote.motion[i] - mean[i]) * vote.weight / weight;
  }
  if (agreed < quorumOf(out.frames)) return;
  out.frame_from_reference = mean;
  out.uncertainty_px = 1 / std::sqrt(weight);
}

// Fog and blur are the lens's, unless the outside is as clear as ever.
bool seesSomethingElse(const FramePose& pose) {
  if (pose.verdict == Verdict::kFogged || pose.verdict == Verdict::kBlurred)
    return pose.outside_good;
  return !isTrusted(pose.verdict);
}

bool mostHaveChanged(const std::vector<SweepFramePose>& frames) {
  const auto changed = static_cast<std::size_t>(std::ranges::count_if(
      frames, [](const SweepFramePose& one) { return seesSomethingElse(one.pose); }));
  return frames.size() >= kLampsThatOutvote && 2 * changed > frames.size();
}

void nobodyTells(FramePose& pose) {
  pose.verdict = Verdict::kLost;
  pose.reason = "too few lamps tell where the sweep lies";
}

}  // namespace

SweepTrack::Lamp& SweepTrack::lampOf(std::size_t number) {
  if (number >= lamps_.size()) lamps_.resize(number + 1);
  return lamps_[number];
}

// A lamp's first frame lies as its sweep does.
void SweepTrack::begin(Lamp& lamp, const SweepFrame& frame, const std::optional<Motion>& shared,
                       bool first, SweepFramePose& out, Progress& progress) const {
  if (!first && !shared) {
    nobodyTells(out.pose);
    return;
  }
  lamp.first_from_reference = shared.value_or(kNoMotion);
  TrackOptions options = options_;
  if (!options.outside.empty() && shared)
    options.outside = maskMoved(std::as_const(options_.outside).view(), *shared,
                                {frame.picture.width, frame.picture.height});
  lamp.track = std::make_unique<PoseTrack>(std::move(options));
  out.pose = lamp.track->add(frame.picture, progress);
  out.pose.frame_from_reference = lamp.first_from_reference;
  out.used = true;
  lamp.doubted_before = !isTrusted(out.pose.verdict);
}

// Marks the frames beyond a bump; those that stand apart without one are lost.
bool SweepTrack::findBump(SizePx size, const std::vector<bool>& tracked, SweepPoses& out) const {
  std::vector<std::size_t> trusted, apart;  // places in the sweep
  for (std::size_t k = 0; k < out.frames.size(); ++k) {
    const FramePose& pose = out.frames[k].pose;
    if (!tracked[k] || !isTrusted(pose.verdict)) continue;
    const double jump_px = cornersApart(pose.frame_from_reference, *out.frame_from_reference, size);
    if (jump_px > std::max(options_.bump_px, kBumpSigmas * pose.uncertainty_px))
      apart.push_back(trusted.size());
    trusted.push_back(k);
  }
  const auto poseOf = [&](std::size_t at) -> FramePose& { return out.frames[trusted[at]].pose; };
  const bool in_a_row = apart.size() > 1 && apart.back() - apart.front() + 1 == apart.size() &&
                        (apart.front() == 0 || apart.back() + 1 == trusted.size());
  const bool bump =
      in_a_row && std::ranges::all_of(apart, [&](std::size_t at) {
        return cornersApart(poseOf(at).frame_from_reference,
                            poseOf(apart.front()).frame_from_reference, size) < options_.bump_px;
      });
  for (const std::size_t at : apart) {
    out.frames[trusted[at]].apart = bump;
    if (bump) continue;
    poseOf(at).verdict = Verdict::kLost;
    poseOf(at).reason = "it says it lies elsewhere than under the other lamps";
  }
  return bump;
}

SweepPoses SweepTrack::add(std::span<const SweepFrame> frames, Progress& progress) {
  SweepPoses out;
  out.frames.resize(frames.size());
  if (frames.empty()) return out;
  const SizePx size = frames.front().picture.size();
  std::vector<bool> tracked(frames.size());
  for (std::size_t k = 0; k < frames.size(); ++k) {
    const Lamp& lamp = lampOf(frames[k].lamp);
    tracked[k] = lamp.track != nullptr;
    if (!tracked[k]) continue;
    FramePose& pose = out.frames[k].pose = lamp.track->add(frames[k].picture, progress);
    pose.frame_from_reference = chained(pose.frame_from_reference, lamp.first_from_reference);
  }
  share(votesOf(out.frames, tracked), options_.bump_px, size, out);
  if (!begun_) out.frame_from_reference = kNoMotion;

  const bool bumped = out.frame_from_reference && findBump(size, tracked, out);
  const bool most_changed = mostHaveChanged(out.frames);
  for (std::size_t k = 0; k < frames.size(); ++k) {
    Lamp& lamp = lamps_[frames[k].lamp];
    SweepFramePose& one = out.frames[k];
    if (!tracked[k]) {
      begin(lamp, frames[k], out.frame_from_reference, !begun_, one, progress);
      continue;
    }
    const bool trusted = isTrusted(one.pose.verdict);
    if (trusted && !out.frame_from_reference) nobodyTells(one.pose);
    one.changed =
        !trusted && out.frame_from_reference && !bumped && (most_changed || lamp.doubted_before);
    one.used = (trusted && out.frame_from_reference) || one.changed;
    lamp.doubted_before = !trusted;
    if (!one.used) continue;
    if (!one.apart) one.pose.frame_from_reference = *out.frame_from_reference;
    lamp.track->settle(frames[k].picture,
                       chained(one.pose.frame_from_reference, inverse(lamp.first_from_reference)),
                       one.changed);
  }
  begun_ = true;
  return out;
}

}  // namespace patina::calibration
