// SPDX-License-Identifier: GPL-3.0-or-later
// Everything that is done to a run's frames before they are a texture, in its order: masters and
// light gains; ambient light and lamps that drifted apart; the light's field and the lens's
// fall-off, or absolute albedo; registration and rectification, resampled once; colour.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "capture/workflow/colour_frames.h"
#include "capture/workflow/field_frames.h"
#include "capture/workflow/lamp_frames.h"
#include "capture/workflow/products.h"
#include "capture/workflow/rectified_frames.h"
#include "capture/workflow/registered_frames.h"

namespace patina::workflow {

struct FrameRequest {
  FrameSelection selection;
  Correction correction;
  LampCorrection lamps;
  FieldUse field = FieldUse::kWhereItFits;
  bool albedo = false;  // absolute: a perfect diffuser is 1
  bool white = false;   // over a flat white diffuser, by albedo, else by field; else as it is
  std::optional<RegistrationRequest> registration;  // nothing: frames as they lie
  std::optional<RectifyRequest> rectify;            // nothing: as the camera sees it
  std::optional<calibration::ColourSpace> colour;   // nothing: as the camera sees
  // Neither is done: frames lie as they were taken, and whoever takes them lays them over one
  // another and, by rectification(), into millimetres.
  bool laid_later = false;
};

std::string rectText(const RectPx& r);  // "X,Y,WIDTH,HEIGHT", as options are kept

// Thread-bound. What it is made of outlives it.
class FrameChain {
 public:
  // Throws WorkflowError as its links do, before any frame is decoded.
  FrameChain(const db::ArchiveReader& reader, const db::RunRow& run, const FrameRequest& request,
             Progress& progress);

  ttf::FrameSource& source() { return *source_; }
  SizePx size() const;  // when all is done
  // Level of a frame that a white diffuser shows, where it was made 1: mean over its fields.
  std::optional<double> whiteLevel() const { return white_level_; }
  const std::optional<RectifyMap>& rectification() const { return rectify_; }
  std::optional<calibration::NoiseModels> noise() const { return frames_.noise(); }
  // The mosaic whose samples frames still hold, each in its pixel's own colour; nothing where they
  // are resampled or their colours mixed.
  std::optional<calibration::ColourFilters> filters() const;
  double mmPerTexel() const { return rectify_ ? rectify_->mm_per_texel : 0; }  // 0: not known
  // What changes the result, but for the pictures' calibrations, which follow by addInputs().
  void addOptions(Facts& options) const;
  void addInputs(Making& making) const;

  // Of the frames given so far.
  FramesReport frames() const;
  std::vector<std::string> calibrations() const;  // "dark 1: 0.2 days away", "view 4: ..."
  std::vector<std::string> left() const;          // those that do not fit: why, what to shoot
  LampFramesReport lamps() const { return lamps_ ? lamps_->report() : LampFramesReport{}; }
  ColourFramesReport colour() const { return colour_ ? colour_->report() : ColourFramesReport{}; }
  const RegistrationReport* registration() const {
    return registered_ ? &registered_->report() : nullptr;
  }
  // Which frame was given which calibration, for the catalogue.
  std::vector<db::FrameCalibrationRow> bindings() const;

 private:
  void evenTheLight(const calibration::CalibrationKey& key);
  std::optional<EvenLight> whiteLight(const calibration::CalibrationKey& key, bool flat);

  const db::ArchiveReader& reader_;
  const std::string run_id_;
  const FrameRequest request_;
  ArchiveFrames frames_;
  ttf::FrameSource* source_;
  std::optional<LampFrames> lamps_;
  std::vector<RunCalibration> of_run_;
  std::vector<std::string> left_;
  std::optional<FieldFrames> even_;
  std::optional<double> white_level_;
  std::optional<RectifiedFrames> without_falloff_, rectified_;
  std::optional<RectifyMap> rectify_;
  std::optional<RegisteredFrames> registered_;
  std::optional<ColourFrames> colour_;
};

}  // namespace patina::workflow
