// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/lamp_frames.h"

#include <algorithm>
#include <set>
#include <sstream>

#include "calibration/lamps/ambient.h"
#include "calibration/lamps/lamp_gains.h"
#include "capture/workflow/failure.h"
#include "capture/workflow/light_gain.h"
#include "capture/workflow/shot_light.h"

namespace patina::workflow {

// The frames of another light state, gone through beside those that are given.
class LampFrames::Companion {
 public:
  Companion(const db::ArchiveReader& reader, const std::string& run_id,
            const FrameSelection& selection, const Correction& correction, const Places& places)
      : places_(places), frames_(reader, run_id, selection, correction) {}

  const FramesReport& report() const { return frames_.report(); }
  // That of `step`, until the next call; steps are asked for in order.
  const ttf::SourceFrame& at(std::int64_t step) {
    while (!frame_ || place_.step < step) {
      frame_ = frames_.next();
      if (!frame_) break;
      place_ = places_.at({frame_->source.hex(), frame_->time_s});
    }
    if (!frame_ || place_.step != step)
      throw WorkflowError(Exit::kBadData, "step " + std::to_string(step) + " has no frame of " +
                                              frames_.report().camera + " under " +
                                              frames_.report().light +
                                              "; build without this correction, or leave it out");
    return *frame_;
  }
  db::RowId shot() const { return place_.shot; }

 private:
  const Places& places_;
  ArchiveFrames frames_;
  std::optional<ttf::SourceFrame> frame_;
  Place place_;
};

LampFrames::LampFrames(const db::ArchiveReader& reader, const std::string& run_id,
                       ArchiveFrames& frames, const FrameSelection& selection,
                       const Correction& correction, const LampCorrection& lamps)
    : reader_(reader), frames_(frames), correction_(correction) {
  std::set<std::string> states;
  const UtcTime t0 = reader.findRun(run_id).t0_utc;
  reader.eachFrame(run_id, [&](const db::ArchiveReader::CapturedFrame& one) {
    if (one.shot.device_id != frames_.report().camera || !one.step.number) return;
    states.insert(one.shot.light_state);
    places_[{one.frame.sha256.hex(), toSeconds(one.frame.utc - t0)}] = {*one.step.number,
                                                                        one.shot.id};
  });
  const auto companion = [&](const std::string& light, const std::string& why) {
    if (!states.contains(light))
      throw WorkflowError(Exit::kUsage, run_id + " has no shots under " + light + " for " + why +
                                            "; add that state to the lights of its sweep");
    FrameSelection other = selection;
    other.camera = frames_.report().camera;
    other.light = light;
    other.every = 1;
    Correction plain = correction;
    plain.light_gain = false;
    auto made = std::make_unique<Companion>(reader, run_id, other, plain, places_);
    const std::vector<std::string>& inputs = made->report().input_sha256s;
    report_.input_sha256s.insert(report_.input_sha256s.end(), inputs.begin(), inputs.end());
    return made;
  };
  if (lamps.ambient) off_ = companion("off", "ambient light");
  std::istringstream ids(frames_.report().light);
  std::vector<std::string> of_state;
  for (std::string id; std::getline(ids, id, '+');) of_state.push_back(id);
  if (correction.light_gain) measured_ = measuredGains(run_id, frames_.report().light);
  if (!lamps.apart || of_state.size() < 2) return;
  for (const std::string& lamp : of_state) {
    alone_.push_back(companion(lamp, "lamps that drift apart"));
    measured_alone_.push_back(correction.light_gain ? measuredGains(run_id, lamp) : Gains{});
    if (measured_alone_.back().empty() && !measured_.empty()) refuseUnmeasured(lamp);
  }
}

void LampFrames::refuseUnmeasured(const std::string& lamp) const {
  throw WorkflowError(Exit::kUsage, "the light of " + frames_.report().light +
                                        " was measured after it was captured, that of " + lamp +
                                        " was not: run `patina light measure` with --light " +
                                        lamp + " too");
}

LampFrames::Gains LampFrames::measuredGains(const std::string& run_id, const std::string& light) {
  MeasuredGains measured = lightGainsOf(reader_, run_id, frames_.report().camera, light);
  if (measured.gains.empty()) return {};
  report_.gain_measured = true;
  report_.input_sha256s.push_back(measured.sha256);
  return std::move(measured.gains);
}

std::array<float, 3> LampFrames::gainOf(const Gains& measured, const ttf::SourceFrame& frame,
                                        db::RowId shot) const {
  const auto found = measured.find(frame.source.hex());
  return found != measured.end()
             ? found->second
             : lightGainOf(reader_.lightChecksOfShot(shot), frames_.report().camera);
}

LampFrames::~LampFrames() = default;

void LampFrames::takeAmbient(Image<float>& linear, Nanoseconds exposure, std::int64_t step) {
  const ttf::SourceFrame& dark = off_->at(step);
  calibration::AmbientOptions options;
  const double off_s = toSeconds(off_->report().exposure_time);
  options.exposure_ratio = off_s > 0 ? toSeconds(exposure) / off_s : 1;
  options.noise_per_level = 1;  // photons alone: the ratio of noises does not depend on their unit
  const calibration::AmbientReport report =
      calibration::subtractAmbient(linear.view(), dark.linear.view(), options);
  for (const double share : report.share)
    report_.ambient_share_most = std::max(report_.ambient_share_most, share);
  report_.noise_factor_most = std::max(report_.noise_factor_most, report.noise_factor);
}

void LampFrames::undoDriftApart(Image<float>& linear, std::int64_t step) {
  std::vector<Image<float>> shots;
  std::vector<calibration::ChannelGains> gains;
  for (std::size_t k = 0; k < alone_.size(); ++k) {
    const auto& lamp = alone_[k];
    const ttf::SourceFrame& frame = lamp->at(step);
    shots.push_back(frame.linear);
    if (off_) takeAmbient(shots.back(), lamp->report().exposure_time, step);
    const std::array<float, 3> undo = gainOf(measured_alone_[k], frame, lamp->shot());
    gains.push_back({1 / undo[0], 1 / undo[1], 1 / undo[2]});
    for (const float gain : undo) {
      report_.gain_min = std::min(report_.gain_min, static_cast<double>(gain));
      report_.gain_max = std::max(report_.gain_max, static_cast<double>(gain));
    }
    // Levels of a lamp's own shot are as long as its exposure was.
    const double own_s = toSeconds(lamp->report().exposure_time),
                 asked_s = toSeconds(frames_.report().exposure_time);
    if (own_s > 0 && own_s != asked_s)
      for (float& v : shots.back().texels()) v *= static_cast<float>(asked_s / own_s);
  }
  std::vector<ImageView<const float>> views;
  for (const Image<float>& shot : shots) views.push_back(shot.view());
  calibration::undoDriftByShots(linear.view(), views, gains);
}

void LampFrames::applyGain(Image<float>& linear, const std::array<float, 3>& gain) {
  for (const float g : gain) {
    report_.gain_min = std::min(report_.gain_min, static_cast<double>(g));
    report_.gain_max = std::max(report_.gain_max, static_cast<double>(g));
  }
  if (gain == std::array<float, 3>{1, 1, 1}) return;
  const auto channels = static_cast<std::size_t>(linear.channels());
  std::vector<float>& texels = linear.texels();
  for (std::size_t k = 0; k < texels.size(); ++k)
    texels[k] *= channels == 3 ? gain[k % 3] : gain[1];
}

std::optional<ttf::SourceFrame> LampFrames::next() {
  std::optional<ttf::SourceFrame> frame = frames_.next();
  if (!frame) return frame;
  const Place place = places_.at({frame->source.hex(), frame->time_s});
  if (off_) takeAmbient(frame->linear, frames_.report().exposure_time, place.step);
  if (!alone_.empty())
    undoDriftApart(frame->linear, place.step);
  else if (correction_.light_gain)
    applyGain(frame->linear, gainOf(measured_, *frame, place.shot));
  return frame;
}

}  // namespace patina::workflow
