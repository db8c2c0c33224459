// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/archive_frames.h"

#include <tbb/info.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "capture/workflow/failure.h"
#include "capture/workflow/light_gain.h"
#include "capture/workflow/sensor_chain.h"

namespace patina::workflow {
namespace {

constexpr std::int64_t kBatchBytes =
    200'000'000;  // of decoded frames; decoding needs as much again

template <class Range>
std::string listed(const Range& choices) {
  std::string text;
  for (const auto& choice : choices) text += (text.empty() ? "" : ", ") + choice;
  return text;
}

// The one asked for, or the only one there is.
std::string pick(const std::string& what, const std::string& option, const std::string& asked,
                 const std::set<std::string>& there, const std::string& run) {
  if (asked.empty() && there.size() == 1) return *there.begin();
  if (there.contains(asked)) return asked;
  throw WorkflowError(
      Exit::kUsage,
      asked.empty()
          ? run + " has several " + what + "s; choose one by " + option + ": " + listed(there)
          : run + " has no " + what + " '" + asked + "'; there are: " + listed(there));
}

}  // namespace

struct ArchiveFrames::Chosen {
  db::FrameRow frame;
  db::ShotRow shot;
  std::size_t bound = 0;  // in the chain
};
ArchiveFrames::ArchiveFrames(const db::ArchiveReader& reader, const std::string& run_id,
                             const FrameSelection& selection, const Correction& correction)
    : reader_(reader), run_id_(run_id), correction_(correction) {
  if (selection.every < 1) throw WorkflowError(Exit::kUsage, "--every must be at least 1");
  t0_ = reader.findRun(run_id).t0_utc;
  choose(reader, selection);
  if (correction.masters) bindMasters();
  if (correction.light_gain)
    measured_gains_ = lightGainsOf(reader, run_id, report_.camera, report_.light);
  report_.gain_measured = !measured_gains_.empty();
  const std::int64_t frame_bytes =
      std::int64_t{report_.largest.width} * report_.largest.height * 3 * 4 * 2;
  batch_frames_ = static_cast<std::size_t>(
      std::clamp<std::int64_t>(kBatchBytes / std::max<std::int64_t>(frame_bytes, 1), 1,
                               4 * tbb::info::default_concurrency()));
}

ArchiveFrames::~ArchiveFrames() = default;

std::array<float, 3> lightGainOf(const std::vector<db::LightCheckRow>& checks,
                                 const std::string& camera) {
  std::array<float, 3> gain{1, 1, 1};
  int best[3] = {0, 0, 0};
  for (const db::LightCheckRow& check : checks) {
    // Of a patch that was covered it is the gain before that.
    if (check.verdict != "correct" && check.verdict != "pass" && check.verdict != "covered")
      continue;
    if (!(check.gain > 0) || !std::isfinite(check.gain)) continue;
    const bool patch = check.source == "patch:" + camera;
    if (!patch && check.source.starts_with("patch:")) continue;
    for (int c = 0; c < 3; ++c) {
      const bool own = check.channel == std::string(1, "rgb"[c]);
      if (!own && (check.channel == "r" || check.channel == "g" || check.channel == "b")) continue;
      const int rank = 1 + own + 2 * patch;
      if (rank <= best[c]) continue;
      best[c] = rank;
      gain[static_cast<std::size_t>(c)] = static_cast<float>(check.gain);
    }
  }
  return gain;
}

std::int64_t ArchiveFrames::count() const { return static_cast<std::int64_t>(chosen_.size()); }

void ArchiveFrames::choose(const db::ArchiveReader& reader, const FrameSelection& selection) {
  std::set<std::string> cameras, lights, exposures;
  std::set<db::RowId> partial;
  std::vector<Chosen> all;
  reader.eachFrame(run_id_, [&](const db::ArchiveReader::CapturedFrame& one) {
    if (one.frame.file_index != selection.file_index || !one.step.number) return;
    cameras.insert(one.shot.device_id);
    lights.insert(one.shot.light_state);
    exposures.insert(std::to_string(one.shot.exposure_index));
    const bool whole = one.step.decision == db::Decision::kCaptured &&
                       one.step.shots_captured >= one.step.shots_due;
    if (!whole && !selection.partial) {
      partial.insert(one.step.id);
      return;
    }
    all.push_back({one.frame, one.shot, 0});
  });
  if (cameras.empty()) throw WorkflowError(Exit::kBadData, run_id_ + " has no frames");
  report_.camera = pick("camera", "--camera", selection.camera, cameras, run_id_);
  report_.light = pick("light state", "--light", selection.light, lights, run_id_);
  report_.exposure = std::stoi(pick("exposure", "--exposure",
                                    selection.exposure ? std::to_string(*selection.exposure) : "",
                                    exposures, run_id_));
  report_.steps_partial_left_out = static_cast<std::int64_t>(partial.size());

  std::int64_t index = 0;
  db::RowId last_step = -1;
  std::set<std::pair<int, int>> sizes;
  for (Chosen& chosen : all) {
    if (chosen.shot.device_id != report_.camera || chosen.shot.light_state != report_.light ||
        chosen.shot.exposure_index != report_.exposure)
      continue;
    if (chosen.shot.step_id == last_step) continue;  // a second attempt that came after all
    last_step = chosen.shot.step_id;
    if (index++ % selection.every != 0) continue;
    const SizePx size = chosen.frame.size;
    sizes.insert({size.width, size.height});
    const bool first = chosen_.empty();
    report_.size.width = first ? size.width : std::min(report_.size.width, size.width);
    report_.size.height = first ? size.height : std::min(report_.size.height, size.height);
    report_.largest.width = std::max(report_.largest.width, size.width);
    report_.largest.height = std::max(report_.largest.height, size.height);
    report_.exposure_time = chosen.shot.exposure;
    const std::string& ext = chosen.frame.ext;
    report_.display_referred = ext == "jpg" || ext == "jpeg" || ext == "png" || ext == "tif";
    report_.input_sha256s.push_back(chosen.frame.sha256.hex());
    chosen_.push_back(std::move(chosen));
  }
  if (chosen_.empty())
    throw WorkflowError(Exit::kBadData, run_id_ + " has no whole step with a frame of " +
                                            report_.camera + " under " + report_.light +
                                            "; --partial takes the others too");
  report_.frames = count();
  report_.sizes = static_cast<int>(sizes.size());
}

std::optional<ttf::SourceFrame> ArchiveFrames::next() {
  if (batch_at_ == batch_.size()) fill();
  if (batch_.empty()) return std::nullopt;
  return std::move(batch_[batch_at_++]);
}

Image<float> ArchiveFrames::linearOf(const Bytes& file, std::size_t bound,
                                     const std::array<float, 3>& gain) const {
  if (chain_) return chain_->apply(bound, file, gain);
  Image<float> linear = decodePicture(file).linear;
  if (gain == std::array<float, 3>{1, 1, 1}) return linear;
  const int channels = linear.channels();
  std::vector<float>& texels = linear.texels();
  for (std::size_t i = 0; i < texels.size(); ++i)
    texels[i] *= gain[std::min<std::size_t>(i % static_cast<std::size_t>(channels), 2)];
  return linear;
}

void ArchiveFrames::fill() {
  batch_.clear();
  batch_at_ = 0;
  const std::size_t count = std::min(batch_frames_, chosen_.size() - next_);
  std::vector<Bytes> files(count);
  std::vector<std::array<float, 3>> gains(count, {1, 1, 1});
  for (std::size_t i = 0; i < count; ++i) {
    const Chosen& chosen = chosen_[next_ + i];
    files[i] = reader_.read(chosen.frame);
    if (!correction_.light_gain) continue;
    const auto measured = measured_gains_.find(chosen.frame.sha256.hex());
    gains[i] = measured != measured_gains_.end()
                   ? measured->second
                   : lightGainOf(reader_.lightChecksOfShot(chosen.shot.id), report_.camera);
    for (const float gain : gains[i]) {
      report_.gain_min = std::min(report_.gain_min, static_cast<double>(gain));
      report_.gain_max = std::max(report_.gain_max, static_cast<double>(gain));
    }
  }
  batch_.resize(count);
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
    const Chosen& chosen = chosen_[next_ + i];
    Image<float> linear = linearOf(files[i], chosen.bound, gains[i]);
    if (linear.size() != report_.size)
      linear = copyOf<float>(ImageView<const float>(linear.view())
                                 .crop({(linear.width() - report_.size.width) / 2,
                                        (linear.height() - report_.size.height) / 2,
                                        report_.size.width, report_.size.height}));
    batch_[i] = {toSeconds(chosen.frame.utc - t0_), chosen.frame.sha256, std::move(linear)};
  });
  next_ += count;
}

namespace {

// Degrees at a time: of the run's nearest temperature reading, else the room's.
class Temperatures {
 public:
  explicit Temperatures(const std::vector<db::ReadingRow>& readings) {
    for (const db::ReadingRow& reading : readings)
      if (reading.quantity == "temperature" && reading.quality == "ok")
        at_[toNs(reading.utc)] = reading.value;
  }
  double near(UtcTime utc) const {
    if (at_.empty()) return calibration::CalibrationKey{}.temperature_c;
    const auto after = at_.lower_bound(toNs(utc));
    if (after == at_.begin()) return after->second;
    const auto before = std::prev(after);
    if (after == at_.end()) return before->second;
    return toNs(utc) - before->first < after->first - toNs(utc) ? before->second : after->second;
  }

 private:
  std::map<std::int64_t, double> at_;
};

}  // namespace

void ArchiveFrames::bindMasters() {
  if (reader_.calibrations().empty()) return;
  const Bytes sample = reader_.read(chosen_.front().frame);
  chain_ = std::make_unique<SensorChain>(reader_, sample, correction_.stale);
  const Temperatures temperatures(reader_.readings(run_id_));
  for (Chosen& chosen : chosen_)
    chosen.bound = chain_->bind({.kind = {},
                                 .device_id = report_.camera,
                                 .exposure = chosen.shot.exposure,
                                 .iso = chosen.shot.iso,
                                 .size = chosen.frame.size,
                                 .temperature_c = temperatures.near(chosen.frame.utc),
                                 .utc = chosen.frame.utc,
                                 .light_state = chosen.shot.light_state},
                                chosen.frame.id);
  chain_->prepare();
  const SensorChain::Report& report = chain_->report();
  report_.masters = report.used;
  report_.masters_left = report.left;
  report_.input_sha256s.insert(report_.input_sha256s.end(), report.input_sha256s.begin(),
                               report.input_sha256s.end());
}

const std::vector<db::FrameCalibrationRow>& ArchiveFrames::bindings() const {
  static const std::vector<db::FrameCalibrationRow> none;
  return chain_ ? chain_->bindings() : none;
}

std::optional<calibration::NoiseModels> ArchiveFrames::noise() const {
  return chain_ ? chain_->noise() : std::nullopt;
}

std::vector<db::FrameRow> ArchiveFrames::rows() const {
  std::vector<db::FrameRow> rows;
  for (const Chosen& chosen : chosen_) rows.push_back(chosen.frame);
  return rows;
}

}  // namespace patina::workflow
