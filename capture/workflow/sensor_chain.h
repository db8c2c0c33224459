// SPDX-License-Identifier: GPL-3.0-or-later
// From one camera's files to linear light by what the archive knows of its sensor: response (8-bit
// files), dark or bias, defects, flat, then the gain of the light. Each calibration is chosen for
// each frame by key, and its distance is kept; what does not fit is left out, with what to shoot.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "calibration/sensor/calibration_key.h"
#include "calibration/sensor/noise_model.h"
#include "calibration/sensor/radiance.h"
#include "calibration/sensor/response.h"
#include "db/archive.h"

namespace patina::workflow {

// A decoded file before any correction.
struct SensorPicture {
  std::optional<RawMosaic> raw;  // or, of every other file:
  Image<float> linear;           // by the response where one is given, else as the format says
  int bits = 8;
};
SensorPicture decodeSensorPicture(std::span<const std::byte> file,
                                  const calibration::ResponseCurve* response);
// Share of full scale, [h][w][1] of a mosaic, else [h][w][3]: what masters are stacked from.
Image<float> uncorrected(const SensorPicture& picture);

// What a frame was taken with; its temperature is the caller's to know.
calibration::CalibrationKey keyOf(const db::ShotRow& shot, const db::FrameRow& frame);
// The key of a row, and of bits and response where it says so.
calibration::CalibrationKey keyOf(const db::CalibrationRow& row);

// The one that fits best, within tolerance; masters of as many channels and the same response.
std::optional<db::CalibrationRow> nearestCalibration(const db::ArchiveReader& reader,
                                                     const std::string& kind,
                                                     const calibration::CalibrationKey& key,
                                                     int channels = 0, db::RowId response = 0);

class SensorChain {
 public:
  // What was chosen, in words, and which inputs it adds to a product.
  struct Report {
    std::vector<std::string> used;  // "dark 3: 2.1 days, 0.4 K away"
    std::vector<std::string> left;  // "dark 3: exposed for 1/100, not 1/50; shoot 16 darks at ..."
    std::vector<std::string> input_sha256s;
  };
  // `sample` is any of the camera's files: it says how many bits and channels they have.
  SensorChain(const db::ArchiveReader& reader, std::span<const std::byte> sample, bool stale);

  // Chooses for a frame and remembers it. `key`'s bits are filled in. Not thread-safe.
  std::size_t bind(calibration::CalibrationKey key, db::RowId frame_id);
  // A file of a frame that was bound, as [h][w][3] or grey [h][w][1]. Thread-safe after the last
  // bind and prepare.
  Image<float> apply(std::size_t bound, std::span<const std::byte> file,
                     const calibration::ChannelGains& gain) const;
  // The same; what is clipped is not known: NaN, and so is what colours were mixed from it.
  Image<float> applyWhereKnown(std::size_t bound, std::span<const std::byte> file,
                               const calibration::ChannelGains& gain) const;
  // One of several exposures of a scene.
  struct Exposure {
    std::size_t bound = 0;
    std::span<const std::byte> file;
    calibration::ChannelGains gain{1, 1, 1};
    double seconds = 0;
  };
  struct Merged {
    Image<float> light;  // 1 is full scale of the shortest exposure, before flat and gain
    std::int64_t saturated =
        0;                    // samples that are so in every exposure: 1 at least, marked by that
    double disagreement = 0;  // of the exposures: 1 where the noise model holds
  };
  // Merged before flat and gain, by the noise model, or as photons alone would have it where there
  // is none; gains of one scene differ by little. Thread-safe like apply, after prepareToMerge.
  Merged merge(std::span<const Exposure> exposures) const;
  // The same; what is clipped in all of them is not known.
  Merged mergeWhereKnown(std::span<const Exposure> exposures) const;
  void prepare();  // reads the files of what was chosen
  void prepareToMerge();
  const Report& report() const { return report_; }
  const std::vector<db::FrameCalibrationRow>& bindings() const { return bindings_; }
  // Colours of the mosaic that the files hold; of frames given, each pixel's own is the sensor's
  // sample. Nothing of developed files.
  std::optional<calibration::ColourFilters> filters() const {
    return mosaic_ ? std::optional(filters_) : std::nullopt;
  }
  // Of the first frame that has one; in numbers of the raw files.
  const std::optional<calibration::NoiseModels>& noise() const { return noise_; }

 private:
  Image<float> apply(std::size_t bound, std::span<const std::byte> file,
                     const calibration::ChannelGains& gain, Image<std::uint8_t>* marks) const;
  Merged merge(std::span<const Exposure> exposures, Image<std::uint8_t>* marks) const;
  void forgetClipped(Image<float>& light, const Image<std::uint8_t>& marks) const;
  using Chosen = std::map<std::string, db::RowId>;  // by kind
  struct Ready {
    Chosen chosen;
    SizePx size;
    Nanoseconds exposure{};
    double warmest_c = -300;  // of its frames: hot pixels are chosen for it
    calibration::SensorCorrection correction;
    std::optional<calibration::SensorCorrection> flat;  // apart from the rest, to be merged before
    std::optional<calibration::ResponseCurve> response;
  };
  std::optional<db::RowId> choose(const std::string& kind, const calibration::CalibrationKey& key,
                                  db::RowId frame_id, std::optional<db::RowId> response);
  const db::CalibrationRow& row(db::RowId id) const;
  void prepare(Ready& ready, bool flat_apart) const;
  calibration::NoiseModels noiseOrPhotons() const;

  const db::ArchiveReader& reader_;
  const bool stale_;
  std::vector<db::CalibrationRow> rows_;
  bool mosaic_ = false;
  int bits_ = 8;
  calibration::ColourFilters filters_ = calibration::kOneColour;
  int channels_ = 3;
  std::vector<Ready> ready_;
  Report report_;
  std::set<db::RowId> told_;
  std::vector<db::FrameCalibrationRow> bindings_;
  std::optional<calibration::NoiseModels> noise_;
};

// Samples of a picture without a chain that are clipped become NaN.
void forgetWhites(Image<float>& linear);

}  // namespace patina::workflow
