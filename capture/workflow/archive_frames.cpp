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
#include "processing/image/metadata_file.h"

namespace patina::workflow {
namespace {

constexpr std::int64_t kBatchBytes =
    200'000'000;                     // of decoded frames; decoding needs as much again
constexpr double kSamePatch = 0.15;  // the light of a lamp does not change by more, relative

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
  std::int64_t step = 0;       // its number
  std::size_t bound = 0;       // in the chain
  std::vector<Chosen> longer;  // exposures of the same step, to be merged with this
};
ArchiveFrames::ArchiveFrames(const db::ArchiveReader& reader, const std::string& run_id,
                             const FrameSelection& selection, const Correction& correction)
    : reader_(reader), run_id_(run_id), correction_(correction) {
  if (selection.every < 1) throw WorkflowError(Exit::kUsage, "--every must be at least 1");
  t0_ = reader.findRun(run_id).t0_utc;
  choose(reader, selection);
  if (selection.merged && !correction.masters)
    throw WorkflowError(Exit::kUsage,
                        "exposures are merged once they are free of their darks: "
                        "leave out --uncorrected or --hdr");
  if (correction.masters) bindMasters();
  if (correction.light_gain) {
    MeasuredGains measured = lightGainsOf(reader, run_id, report_.camera, report_.light);
    report_.gain_measured = !measured.gains.empty();
    if (report_.gain_measured) report_.input_sha256s.push_back(measured.sha256);
    measured_gains_ = std::move(measured.gains);
  }
  const std::int64_t frame_bytes =
      std::int64_t{report_.largest.width} * report_.largest.height * 3 * 4 * 2 * report_.exposures;
  batch_frames_ = static_cast<std::size_t>(
      std::clamp<std::int64_t>(kBatchBytes / std::max<std::int64_t>(frame_bytes, 1), 1,
                               4 * tbb::info::default_concurrency()));
}

ArchiveFrames::~ArchiveFrames() = default;

bool hasFlat(const FramesReport& report) {
  return std::ranges::any_of(report.masters,
                             [](const std::string& used) { return used.starts_with("flat "); });
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
    all.push_back({one.frame, one.shot, *one.step.number, 0, {}});
  });
  if (cameras.empty()) throw WorkflowError(Exit::kBadData, run_id_ + " has no frames");
  report_.camera = pick("camera", "--camera", selection.camera, cameras, run_id_);
  report_.light = pick("light state", "--light", selection.light, lights, run_id_);
  if (!selection.merged)
    report_.exposure = std::stoi(pick("exposure", "--exposure",
                                      selection.exposure ? std::to_string(*selection.exposure) : "",
                                      exposures, run_id_));
  std::int64_t index = 0;
  for (std::vector<Chosen>& step : byStep(std::move(all), selection.merged)) {
    if (static_cast<int>(step.size()) < report_.exposures) {
      partial.insert(step.front().shot.step_id);
      continue;
    }
    if (index == 0) first_shot_ = step.front().shot;
    if (index++ % selection.every != 0 || step.front().step < selection.from_step) continue;
    Chosen chosen = std::move(step.front());
    chosen.longer.assign(std::make_move_iterator(step.begin() + 1),
                         std::make_move_iterator(step.end()));
    note(chosen);
    chosen_.push_back(std::move(chosen));
  }
  report_.steps_partial_left_out = static_cast<std::int64_t>(partial.size());
  if (chosen_.empty())
    throw WorkflowError(Exit::kBadData, run_id_ + " has no whole step with a frame of " +
                                            report_.camera + " under " + report_.light +
                                            "; --partial takes the others too");
  report_.frames = count();
}

// The shots of one camera and light state, the shortest exposure first; of several attempts the
// first.
std::vector<std::vector<ArchiveFrames::Chosen>> ArchiveFrames::byStep(std::vector<Chosen> all,
                                                                      bool merged) {
  std::vector<std::vector<Chosen>> steps;
  std::set<int> exposures;
  for (Chosen& chosen : all) {
    const db::ShotRow& shot = chosen.shot;
    if (shot.device_id != report_.camera || shot.light_state != report_.light ||
        (!merged && shot.exposure_index != report_.exposure))
      continue;
    if (steps.empty() || steps.back().front().shot.step_id != shot.step_id) steps.emplace_back();
    std::vector<Chosen>& step = steps.back();
    if (std::ranges::any_of(
            step, [&](const Chosen& c) { return c.shot.exposure_index == shot.exposure_index; }))
      continue;
    exposures.insert(shot.exposure_index);
    step.push_back(std::move(chosen));
  }
  if (!merged) return steps;
  if (exposures.size() < 2)
    throw WorkflowError(Exit::kUsage, run_id_ + " has one exposure of " + report_.camera +
                                          " under " + report_.light +
                                          ": nothing to merge; give the sweep of its plan "
                                          "exposures = [\"1/100\", \"1/25\", ...]");
  report_.exposures = static_cast<int>(exposures.size());
  for (std::vector<Chosen>& step : steps)
    std::ranges::stable_sort(step, {}, [](const Chosen& c) { return c.shot.exposure; });
  return steps;
}

// What the report says of all frames.
void ArchiveFrames::note(const Chosen& chosen) {
  const SizePx size = chosen.frame.size;
  const bool first = chosen_.empty();
  sizes_.insert({size.width, size.height});
  report_.sizes = static_cast<int>(sizes_.size());
  report_.size.width = first ? size.width : std::min(report_.size.width, size.width);
  report_.size.height = first ? size.height : std::min(report_.size.height, size.height);
  report_.largest.width = std::max(report_.largest.width, size.width);
  report_.largest.height = std::max(report_.largest.height, size.height);
  report_.exposure_time = chosen.shot.exposure;
  report_.iso = chosen.shot.iso;
  if (!chosen.longer.empty()) report_.exposure = chosen.shot.exposure_index;
  report_.as_short =
      1 + static_cast<int>(std::ranges::count_if(chosen.longer, [&](const Chosen& c) {
        return c.shot.exposure <= chosen.shot.exposure;
      }));
  const std::string& ext = chosen.frame.ext;
  report_.display_referred = ext == "jpg" || ext == "jpeg" || ext == "png" || ext == "tif";
  report_.input_sha256s.push_back(chosen.frame.sha256.hex());
  for (const Chosen& longer : chosen.longer)
    report_.input_sha256s.push_back(longer.frame.sha256.hex());
}

std::optional<ttf::SourceFrame> ArchiveFrames::next() {
  if (batch_at_ == batch_.size()) fill();
  if (batch_.empty()) return std::nullopt;
  return std::move(batch_[batch_at_++]);
}

// A frame on its way from its files.
struct ArchiveFrames::Decoding {
  std::vector<Bytes> files;  // of the shortest exposure, then of the longer ones
  std::vector<std::array<float, 3>> gains;
  SensorChain::Merged merged;  // of one exposure: its light alone
};

void ArchiveFrames::decode(const Chosen& chosen, Decoding& decoding) const {
  if (!chosen.longer.empty()) {
    std::vector<SensorChain::Exposure> exposures;
    const auto add = [&](const Chosen& one) {
      const std::size_t i = exposures.size();
      exposures.push_back(
          {one.bound, decoding.files[i], decoding.gains[i], toSeconds(one.shot.exposure)});
    };
    add(chosen);
    std::ranges::for_each(chosen.longer, add);
    decoding.merged = correction_.clipped == Clipped::kUnknown ? chain_->mergeWhereKnown(exposures)
                                                               : chain_->merge(exposures);
    return;
  }
  Image<float>& light = decoding.merged.light;
  const std::array<float, 3>& gain = decoding.gains.front();
  if (chain_) {
    light = correction_.clipped == Clipped::kUnknown
                ? chain_->applyWhereKnown(chosen.bound, decoding.files.front(), gain)
                : chain_->apply(chosen.bound, decoding.files.front(), gain);
    return;
  }
  light = decodePicture(decoding.files.front()).linear;
  if (correction_.clipped == Clipped::kUnknown) forgetWhites(light);
  if (gain == std::array<float, 3>{1, 1, 1}) return;
  const auto channels = static_cast<std::size_t>(light.channels());
  std::vector<float>& texels = light.texels();
  for (std::size_t i = 0; i < texels.size(); ++i)
    texels[i] *= gain[std::min<std::size_t>(i % channels, 2)];
}

std::string ArchiveFrames::holdToPatch(const ChannelLevels& level) {
  if (!correction_.light_gain || !measured_gains_.empty()) return {};
  const auto gains = gainByPatch(level, first_shot_);
  if (!gains) return {};
  for (const float gain : *gains)
    if (std::abs(1 / gain - 1) > kSamePatch) {
      char text[240];
      std::snprintf(text, sizeof text,
                    "light_gain: under %s the patch is %+.0f %% off what it was when the light was "
                    "calibrated: another patch, another lamp, or under the card? It is not held to",
                    report_.light.c_str(), 100 * (1 / gain - 1));
      return text;
    }
  patch_ = level;
  report_.held_to_patch = true;
  return {};
}

std::optional<std::array<float, 3>> ArchiveFrames::gainByPatch(const ChannelLevels& level,
                                                               const db::ShotRow& shot) const {
  const auto seen = patchLevelOf(reader_.lightChecksOfShot(shot.id), report_.camera);
  if (!seen) return std::nullopt;
  const double exposed = exposureOver(shot, chosen_.front().shot);
  std::array<float, 3> gains{};
  for (std::size_t c = 0; c < 3; ++c)
    gains[c] = static_cast<float>(level[c] * exposed / (*seen)[c]);
  return gains;
}

// Of a longer exposure, whose patch may be clipped, at worst that of its step's shortest.
std::array<float, 3> ArchiveFrames::gainOf(const Chosen& chosen, const Chosen& shortest) {
  if (!correction_.light_gain) return {1, 1, 1};
  std::array<float, 3> gains{};
  if (const auto measured = measured_gains_.find(chosen.frame.sha256.hex());
      measured != measured_gains_.end())
    gains = measured->second;
  else if (const auto own = patch_ ? gainByPatch(*patch_, chosen.shot) : std::nullopt)
    gains = *own;
  else if (const auto beside = patch_ ? gainByPatch(*patch_, shortest.shot) : std::nullopt)
    gains = *beside;
  else
    gains = lightGainOf(reader_.lightChecksOfShot(chosen.shot.id), report_.camera);
  for (const float gain : gains) {
    report_.gain_min = std::min(report_.gain_min, static_cast<double>(gain));
    report_.gain_max = std::max(report_.gain_max, static_cast<double>(gain));
  }
  return gains;
}

void ArchiveFrames::fill() {
  batch_.clear();
  batch_at_ = 0;
  const std::size_t count = std::min(batch_frames_, chosen_.size() - next_);
  std::vector<Decoding> decodings(count);
  for (std::size_t i = 0; i < count; ++i) {
    const Chosen& chosen = chosen_[next_ + i];
    const auto read = [&](const Chosen& one) {
      decodings[i].files.push_back(reader_.read(one.frame));
      decodings[i].gains.push_back(gainOf(one, chosen));
    };
    read(chosen);
    std::ranges::for_each(chosen.longer, read);
  }
  batch_.resize(count);
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
    const Chosen& chosen = chosen_[next_ + i];
    decode(chosen, decodings[i]);
    Image<float> linear = std::move(decodings[i].merged.light);
    if (linear.size() != report_.size)
      linear = copyOf<float>(ImageView<const float>(linear.view())
                                 .crop({(linear.width() - report_.size.width) / 2,
                                        (linear.height() - report_.size.height) / 2,
                                        report_.size.width, report_.size.height}));
    batch_[i] = {toSeconds(chosen.frame.utc - t0_), chosen.frame.sha256, std::move(linear)};
  });
  for (const Decoding& decoding : decodings) {
    report_.saturated_samples += decoding.merged.saturated;
    report_.disagreement_most = std::max(report_.disagreement_most, decoding.merged.disagreement);
  }
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
  const bool merging = report_.exposures > 1;
  if (reader_.calibrations().empty() && !merging) return;
  const Bytes sample = reader_.read(chosen_.front().frame);
  const PictureMetadata about = readMetadata(sample);
  report_.focal_mm = about.focal_mm.value_or(0);
  report_.focus_m = about.focus_m.value_or(0);
  chain_ = std::make_unique<SensorChain>(reader_, sample, correction_.stale);
  const Temperatures temperatures(reader_.readings(run_id_));
  const auto bind = [&](Chosen& one) {
    calibration::CalibrationKey key = workflow::keyOf(one.shot, one.frame);
    key.temperature_c = temperatures.near(one.frame.utc);
    one.bound = chain_->bind(key, one.frame.id);
  };
  for (Chosen& chosen : chosen_) {
    bind(chosen);
    std::ranges::for_each(chosen.longer, bind);
  }
  merging ? chain_->prepareToMerge() : chain_->prepare();
  if (merging && !chain_->noise())
    report_.masters_left.push_back(
        "photon_transfer: none of " + report_.camera +
        " that fits, so exposures are weighed as photons alone would have it; run `patina "
        "calibrate noise`");
  const SensorChain::Report& report = chain_->report();
  report_.masters = report.used;
  report_.masters_left.insert(report_.masters_left.end(), report.left.begin(), report.left.end());
  report_.input_sha256s.insert(report_.input_sha256s.end(), report.input_sha256s.begin(),
                               report.input_sha256s.end());
}

const std::vector<db::FrameCalibrationRow>& ArchiveFrames::bindings() const {
  static const std::vector<db::FrameCalibrationRow> none;
  return chain_ ? chain_->bindings() : none;
}

std::optional<calibration::ColourFilters> ArchiveFrames::filters() const {
  if (report_.sizes > 1) return std::nullopt;
  if (chain_) return chain_->filters();
  const SensorPicture sample = decodeSensorPicture(reader_.read(chosen_.front().frame), nullptr);
  return sample.raw ? std::optional(sample.raw->cfa) : std::nullopt;
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
