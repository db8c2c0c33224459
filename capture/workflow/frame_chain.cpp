// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/frame_chain.h"

#include <numeric>
#include <utility>

#include "capture/workflow/failure.h"

namespace patina::workflow {
namespace {

// Gains follow when ambient light is gone.
Correction ofArchiveFrames(const FrameRequest& request) {
  Correction correction = request.correction;
  if (request.lamps.any()) correction.light_gain = false;
  return correction;
}

template <class T>
void append(std::vector<T>& to, const std::vector<T>& what) {
  to.insert(to.end(), what.begin(), what.end());
}

// Where the light is to stay what it is, so that the chart's colours hold.
std::optional<calibration::PlacePx> chartMiddle(const db::ArchiveReader& reader,
                                                const calibration::CalibrationKey& frames,
                                                const FrameRequest& request) {
  if (!request.colour) return std::nullopt;
  const CalibrationChoice chart =
      chooseCalibration(reader, "colour", frames, request.correction.stale);
  if (!chart.row || chart.row->size != frames.size) return std::nullopt;
  calibration::PlacePx middle;
  for (const auto& corner : readColourCalibration(fileOfCalibration(reader, *chart.row)).corners) {
    middle.x += corner.x / 4;
    middle.y += corner.y / 4;
  }
  return middle;
}

}  // namespace

std::string rectText(const RectPx& r) {
  return std::to_string(r.x) + "," + std::to_string(r.y) + "," + std::to_string(r.width) + "," +
         std::to_string(r.height);
}

FrameChain::FrameChain(const db::ArchiveReader& reader, const db::RunRow& run,
                       const FrameRequest& request, Progress& progress)
    : reader_(reader),
      run_id_(run.id),
      request_(request),
      frames_(reader, run.id, request.selection, ofArchiveFrames(request)),
      source_(&frames_) {
  const FramesReport& chosen = frames_.report();
  if (request.lamps.any())
    source_ = &lamps_.emplace(reader, run.id, frames_, request.selection, request.correction,
                              request.lamps);
  const calibration::CalibrationKey key = keyOf(chosen, run.t0_utc);
  evenTheLight(key);
  std::optional<PixelMap> map;
  if (request.rectify) {
    rectify_ = rectifyMap(reader, key, *request.rectify, request.correction.stale);
    of_run_.push_back(rectify_->view);
    if (!request.laid_later) map = rectify_->map;
  }
  if (request.registration && !request.laid_later)
    source_ = &registered_.emplace(*source_, *request.registration, std::move(map), progress);
  else if (map)
    source_ = &rectified_.emplace(*source_, std::nullopt, std::move(map));
  if (request.colour)
    source_ = &colour_.emplace(*source_, reader, run.id, chosen, *request.colour,
                               request.correction.stale);
}

// A field holds the fall-off too; so does an albedo scale, as far as it was taken for even light.
void FrameChain::evenTheLight(const calibration::CalibrationKey& key) {
  const bool flat = hasFlat(frames_.report()), stale = request_.correction.stale;
  std::optional<EvenLight> light;
  if (request_.white) {
    light = whiteLight(key, flat);
  } else if (request_.albedo) {
    if (request_.colour)
      throw WorkflowError(Exit::kUsage,
                          "both an albedo scale and a colour chart say what is white: choose one");
    light = albedoFor(reader_, key, flat, stale);
  } else if (request_.field == FieldUse::kAsked ||
             (request_.field == FieldUse::kWhereItFits && request_.correction.masters)) {
    std::vector<std::string> left;
    std::optional<StateField> field = fieldOfState(reader_, key, flat, stale, left);
    if (!field && request_.field == FieldUse::kAsked)
      throw WorkflowError(Exit::kBadData,
                          "no field of gain fits these frames: " +
                              (left.empty() ? shootInstead(key, "gain_field") : left.front()));
    append(left_, left);
    if (field) light = evenLightOf(std::move(*field), chartMiddle(reader_, key, request_));
  }
  if (light) {
    append(of_run_, light->used);
    if (light->patch && !request_.lamps.any())
      if (const std::string other = frames_.holdToPatch(*light->patch); !other.empty())
        left_.push_back(other);
    source_ = &even_.emplace(*source_, std::move(*light));
  } else if (request_.correction.masters && !flat) {
    if (const auto known = vignettingFor(reader_, key, stale, left_)) {
      source_ = &without_falloff_.emplace(*source_, known->vignetting, std::nullopt);
      of_run_.push_back(known->used);
    }
  }
}

std::optional<EvenLight> FrameChain::whiteLight(const calibration::CalibrationKey& key, bool flat) {
  const bool stale = request_.correction.stale;
  std::optional<EvenLight> light;
  if (chooseCalibration(reader_, "albedo", key, stale).row) {
    light = albedoFor(reader_, key, flat, stale);
  } else if (auto field = fieldOfState(reader_, key, flat, stale, left_)) {
    light = whiteLightOf(std::move(*field));
  }
  if (!light) return light;
  double scale = 0, level = light->field ? 0 : 1;
  for (int c = 0; c < light->scale.channels; ++c) scale += light->scale.scale[c];
  if (light->field) {
    const std::vector<float>& levels = light->field->texels();
    level = std::accumulate(levels.begin(), levels.end(), 0.0) / static_cast<double>(levels.size());
  }
  white_level_ = level * light->scale.channels / scale;
  return light;
}

SizePx FrameChain::size() const { return rectify_ ? rectify_->map.size() : frames_.report().size; }

std::optional<calibration::ColourFilters> FrameChain::filters() const {
  if (rectify_ || registered_ || colour_) return std::nullopt;
  return frames_.filters();
}

void FrameChain::addOptions(Facts& options) const {
  const FramesReport& frames = frames_.report();
  options.text("camera", frames.camera);
  options.text("light", frames.light);
  options.count("exposure", frames.exposure);
  options.set("display_referred", frames.display_referred);
  if (request_.selection.merged) options.count("hdr", frames.exposures);
  options.count("every", request_.selection.every);
  options.set("partial", request_.selection.partial);
  options.count("file", request_.selection.file_index);
  options.set("light_gain", request_.correction.light_gain);
  if (frames.held_to_patch) options.set("held_to_patch", true);
  options.set("corrected", request_.correction.masters).set("stale", request_.correction.stale);
  options.text("field_use", request_.field == FieldUse::kAsked  ? "asked"
                            : request_.field == FieldUse::kNone ? "none"
                                                                : "where_it_fits");
  options.set("masters", frames.masters);
  if (request_.lamps.any())
    options.set("ambient", request_.lamps.ambient).set("lamps_apart", request_.lamps.apart);
  if (request_.white) options.set("white", true);
  options.set("albedo", request_.albedo).set("field", even_.has_value() && !request_.albedo);
  if (request_.colour) options.text("colour", nameOf(*request_.colour));
  if (const auto& r = request_.registration) {
    options.text("register", name(r->model)).set("markers", r->markers).set("deform", r->deform);
    std::vector<std::string> fiducials;
    for (const RectPx& rect : r->fiducials) fiducials.push_back(rectText(rect));
    options.set("fiducials", fiducials);
  }
  if (!rectify_) return;
  const calibration::RegionMm& region = rectify_->region;
  options.number("left_mm", region.left).number("bottom_mm", region.bottom);
  options.number("width_mm", region.width).number("height_mm", region.height);
  options.number("mm_per_texel", rectify_->mm_per_texel);
}

void FrameChain::addInputs(Making& making) const {
  append(making.input_sha256s, frames_.report().input_sha256s);
  if (lamps_) append(making.input_sha256s, lamps_->report().input_sha256s);
  std::vector<std::string> described;
  for (const RunCalibration& used : of_run_) {
    described.push_back(used.described);
    making.input_sha256s.push_back(used.sha256);
  }
  if (!described.empty()) making.options.set("run_calibrations", described);
  if (!colour_) return;
  making.options.set("colour_calibrations", colour_->report().input_sha256s);
  append(making.input_sha256s, colour_->report().input_sha256s);
}

FramesReport FrameChain::frames() const {
  FramesReport report = frames_.report();
  if (lamps_) {
    report.gain_min = lamps_->report().gain_min;
    report.gain_max = lamps_->report().gain_max;
    report.gain_measured = lamps_->report().gain_measured;
  }
  return report;
}

std::vector<std::string> FrameChain::calibrations() const {
  std::vector<std::string> all = frames_.report().masters;
  for (const RunCalibration& used : of_run_) all.push_back(used.described);
  if (colour_) append(all, colour_->report().used);
  return all;
}

std::vector<std::string> FrameChain::left() const {
  std::vector<std::string> all = frames_.report().masters_left;
  append(all, left_);
  return all;
}

std::vector<db::FrameCalibrationRow> FrameChain::bindings() const {
  std::vector<db::FrameCalibrationRow> all = frames_.bindings();
  append(all, bindingsOf(reader_, run_id_, frames_.report(), of_run_));
  if (colour_) append(all, colour_->report().bindings);
  return all;
}

}  // namespace patina::workflow
