// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/registered_sweeps.h"

#include <algorithm>
#include <cmath>
#include <list>
#include <utility>

#include "calibration/failure.h"
#include "capture/workflow/failure.h"

namespace patina::workflow {

using calibration::SweepFramePose;
using calibration::SweepPoses;

namespace {

constexpr double kStillPx = 0.1;  // to resample it costs more than it mends

bool isUnknown(float level) { return std::isnan(level); }

// Levels that were clipped are as bright as the picture's brightest: poses are found on whole
// pictures.
Image<float> filledWhite(Image<float> picture) {
  float most = 0;
  for (const float level : picture.texels())
    if (level > most) most = level;
  std::ranges::replace_if(picture.texels(), isUnknown, most);
  return picture;
}

}  // namespace

RegisteredSweeps::RegisteredSweeps(const RegistrationRequest& request,
                                   std::vector<std::string> states, std::optional<PixelMap> map,
                                   Progress& progress)
    : request_(request), states_(std::move(states)), map_(std::move(map)), progress_(progress) {
  if (request.deform)
    throw WorkflowError(Exit::kUsage,
                        "a field of displacements is found for one lamp's frames, not for sweeps");
}

// Some lamps leave markers in the dark.
void RegisteredSweeps::begin(const std::vector<SweepPicture>& first) {
  calibration::TrackOptions options;
  options.keys.align.model = request_.model;
  options.keys.keyframes = 2;  // of every lamp
  for (std::size_t k = 0; k < first.size(); ++k) {
    try {
      options.outside = outsideOf(request_, first[k].linear);
      break;
    } catch (const calibration::CalibrationError&) {
      if (k + 1 == first.size()) throw;
    }
  }
  track_ = std::make_unique<calibration::SweepTrack>(std::move(options));
}

void RegisteredSweeps::lay(std::int64_t step, std::vector<SweepPicture>& pictures, bool resampled) {
  if (pictures.empty()) return;
  if (!track_) begin(pictures);
  std::vector<calibration::SweepFrame> frames;
  std::list<Image<float>> filled;
  for (const SweepPicture& one : pictures) {
    ImageView<const float> picture = one.linear.view();
    if (std::ranges::any_of(one.linear.texels(), isUnknown))
      picture = std::as_const(filled.emplace_back(filledWhite(one.linear))).view();
    frames.push_back({one.state, picture});
  }
  const SweepPoses poses = track_->add(frames, progress_);
  note(step, pictures, poses);
  std::vector<SweepPicture> laid;
  for (std::size_t k = 0; k < pictures.size(); ++k) {
    if (!poses.frames[k].used) continue;
    laid.push_back(std::move(pictures[k]));
    const calibration::Motion& pose = poses.frames[k].pose.frame_from_reference;
    Image<float>& linear = laid.back().linear;
    const bool still =
        !map_ && calibration::cornersApart(pose, calibration::kNoMotion, linear.size()) <= kStillPx;
    if (!resampled || still) continue;
    laid.back().resampled = true;
    const PixelMap whole = map_ ? *map_ : identityMap({0, 0, linear.width(), linear.height()});
    linear = resample(std::as_const(linear).view(), composed(whole, pose), std::nanf(""));
  }
  pictures = std::move(laid);
}

void RegisteredSweeps::note(std::int64_t step, const std::vector<SweepPicture>& pictures,
                            const SweepPoses& poses) {
  constexpr int kNamed = 10;
  const std::string of = "step " + std::to_string(step);
  int changed = 0, apart = 0;
  for (std::size_t k = 0; k < pictures.size(); ++k) {
    const SweepFramePose& one = poses.frames[k];
    ++frames_;
    changed += one.changed ? 1 : 0;
    apart += one.apart ? 1 : 0;
    if (one.used || ++refused_ > kNamed + 1) continue;
    if (refused_ > 1) refused_named_ += ", ";
    refused_named_ += refused_ > kNamed ? "..."
                                        : of + " " + states_[pictures[k].state] + " (" +
                                              name(one.pose.verdict) + ": " + one.pose.reason + ")";
  }
  if (changed > 0) aged_steps_.append(aged_steps_.empty() ? "" : ", ").append(std::to_string(step));
  if (apart > 0)
    bumps_.push_back(of + ": the camera moved within the sweep; " + std::to_string(apart) + " of " +
                     std::to_string(pictures.size()) + " frames lie otherwise");
}

std::vector<std::string> RegisteredSweeps::notes() const {
  std::vector<std::string> notes = bumps_;
  if (refused_ > 0)
    notes.push_back(std::to_string(refused_) + " of " + std::to_string(frames_) +
                    " frames refused: " + refused_named_);
  if (!aged_steps_.empty())
    notes.push_back("the specimen looks otherwise than a step before, taken for ageing: steps " +
                    aged_steps_);
  return notes;
}

}  // namespace patina::workflow
