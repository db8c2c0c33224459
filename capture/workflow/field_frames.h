// SPDX-License-Identifier: GPL-3.0-or-later
// Frames as if their light fell evenly (by the fields of the lamps that are on), or as absolute
// diffuse albedo (by targets of known reflectance too).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibration/lamps/albedo.h"
#include "calibration/place.h"
#include "capture/workflow/run_calibration.h"

namespace patina::workflow {

enum class FieldUse { kWhereItFits, kAsked, kNone };

// frame * scale / field, per channel.
struct EvenLight {
  std::optional<Image<float>> field;  // [h][w][c]; nothing: the light was taken for even
  calibration::AlbedoScale scale;
  std::vector<RunCalibration> used;
  // What the patch shows in frames of this exposure and ISO while the light is what it was when it
  // was calibrated. Of what only makes the light even, or was calibrated without a patch: nothing.
  std::optional<ChannelLevels> patch;
};

// The light of a state: the sum of what its lamps give, each by its own field, at the exposure of
// the first one's. Nothing where the archive has no field of these lamps; where one does not fit,
// `left` says why. A field holds the lens's fall-off, or none where it was made through a flat:
// `flat` says whether these frames had one.
struct StateField {
  Image<float> levels;
  std::vector<RunCalibration> used;
  std::string sha256s;           // of the files, joined by +
  double reflectance = 1;        // of the card that the first was taken from
  double frames_over_field = 1;  // how much more light exposure and ISO of the frames let in
  std::optional<ChannelLevels> patch{};  // as in those pictures; all of them tell it
};
std::optional<StateField> fieldOfState(const db::ArchiveReader& reader,
                                       const calibration::CalibrationKey& frames, bool flat,
                                       bool stale, std::vector<std::string>& left);

// Levels stay what they are at `hold` (the colour chart's middle), else on average.
EvenLight evenLightOf(StateField field, std::optional<calibration::PlacePx> hold);

// Levels over those that a flat white diffuser would show, by what is known of the fields' card.
EvenLight whiteLightOf(StateField field);

// By the albedo scale of this camera and light state and the field it was solved with, scaled by
// exposure and ISO where both are known. Throws WorkflowError(kBadData), saying what to shoot.
EvenLight albedoFor(const db::ArchiveReader& reader, const calibration::CalibrationKey& frames,
                    bool flat, bool stale);

// Thread-bound; `frames` outlives it.
class FieldFrames final : public ttf::FrameSource {
 public:
  FieldFrames(ttf::FrameSource& frames, EvenLight light)
      : frames_(frames), light_(std::move(light)) {}
  std::int64_t count() const override { return frames_.count(); }
  // Throws WorkflowError(kBadData) when a frame has other channels than the calibration.
  std::optional<ttf::SourceFrame> next() override;

 private:
  ttf::FrameSource& frames_;
  const EvenLight light_;
};

}  // namespace patina::workflow
