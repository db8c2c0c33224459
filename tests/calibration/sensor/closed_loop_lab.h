// SPDX-License-Identifier: GPL-3.0-or-later
// A camera of the twin over a grey card and over a specimen, with calibrations taken from its own
// pictures; and what became of the light it saw.
#pragma once

#include <array>
#include <functional>
#include <map>
#include <optional>
#include <tuple>
#include <vector>

#include "calibration/sensor/masters.h"
#include "calibration/sensor/photon_transfer.h"
#include "calibration/sensor/radiance.h"
#include "calibration/sensor/response.h"
#include "tests/calibration/sensor/light_verdict.h"
#include "tests/calibration/sensor/tone_curve.h"
#include "tests/calibration/sensor/twin_shots.h"

namespace patina::calibration {

using testing::TwinStudio;
using Lamps = std::array<double, 2>;  // level of key and fill

constexpr int kFrames = 16, kMasterFrames = 64;

// A flat of one light state, and what the card looked like.
struct Flat {
  Master master;
  std::vector<float> card;
};

class Lab {
 public:
  Lab();
  // From here on the camera gives 8 bits by a tone curve; its response is measured from brackets,
  // the first of a covered lens.
  void giveCodes(const testing::Tone& tone);

  Flat flatOf(Lamps lamps);

  // Mean of the corrected frames while the lamps drift and flicker; the gain comes from the patch.
  Image<float> meanRadiance(Lamps lamps, double drift, const Flat& flat, SensorCorrection& used);

  // The same under both lamps together, each of which drifts and flickers by itself. Each step has
  // shots of either lamp alone, whose level on the patch says what became of it.
  Image<float> meanUnderBoth(Lamps lamps, Lamps drift, const Flat& flat, SensorCorrection& used);

  // What the mean should be: the scene's light over the card's, at the flat's level.
  Image<float> truth(Lamps lamps, const Flat& flat);

  SizePx size() { return scene_.maker.layout().size; }
  const NoiseModels& noise() const { return noise_; }
  const ResponseCurve* response() const { return response_ ? &*response_ : nullptr; }
  const std::vector<bool>& saturated() const { return saturated_; }
  static ColourFilters cfa() { return RawMosaic{}.cfa; }

 private:
  static devices::twin::ShotLight shot(Lamps lamps, std::uint64_t key);
  PairSource pairs(std::vector<Lamps> levels, std::uint64_t key);
  std::function<PictureSource()> stack(Lamps lamps, std::uint64_t key);
  void correct(const RawMosaic& raw, const SensorCorrection& correction, float gain,
               Image<float>& light, ImageView<std::uint8_t> marks) const;
  // Pictures are asked for again by every tone curve.
  const RawMosaic& exposed(TwinStudio& studio, const devices::twin::ShotLight& shot);
  SensorCorrection correctionBy(const Flat& flat);
  // Over the inner part of the grey patch.
  double patchMean(const RawMosaic& raw, const SensorCorrection& correction);

  TwinStudio card_, scene_;
  std::map<std::tuple<TwinStudio*, double, double, std::uint64_t>, RawMosaic> exposed_;
  testing::Tone tone_ = testing::kTones[0];
  std::optional<ResponseCurve> response_;
  NoiseModels noise_;
  Master dark_;
  std::vector<bool> saturated_;
};

std::vector<bool> leftOut(const SensorCorrection& used, const std::vector<bool>& saturated);

}  // namespace patina::calibration
