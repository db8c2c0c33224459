// SPDX-License-Identifier: GPL-3.0-or-later
// The frames of a run as a FrameSource: one camera, one light state, one exposure or all of a
// sweep's merged; decoded, calibrated, of one size. Registration and colour are decorators of their
// own.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "calibration/sensor/colour_filters.h"
#include "calibration/sensor/noise_model.h"
#include "capture/workflow/shot_light.h"
#include "db/archive.h"
#include "processing/ttf/frame_source.h"

namespace patina::workflow {

// Which frames. Empty fields: the only one there is; where a run has several, the choice is
// refused with the ones there are.
struct FrameSelection {
  std::string camera{}, light{};
  std::optional<int> exposure{};
  int file_index = 0;    // RAW+JPEG: 0 is the raw file
  bool partial = false;  // also frames of steps that are not whole
  int every = 1;         // frame 0, every, 2*every ... of those there are
  bool merged = false;   // all exposures of a step in one frame, scaled and named as the shortest
  std::int64_t from_step = 0;  // number; earlier ones count for `every` and are not given
};
enum class Clipped { kAsItIs, kUnknown };  // the latter: NaN, with what colours were mixed from it
struct Correction {
  bool light_gain = true;  // per light and channel, as measured since, else of the light checks
  bool masters = true;     // response, dark (else bias), defects and flat, by key
  bool stale = false;      // also those out of tolerance, flagged; otherwise left out, with why
  Clipped clipped = Clipped::kAsItIs;
};

class SensorChain;

// What was chosen and what was done to it.
struct FramesReport {
  std::string camera, light;
  int exposure = 0;
  Nanoseconds exposure_time{};
  double iso = 0;                    // 0: not known
  double focal_mm = 0, focus_m = 0;  // of the first frame; 0: its file does not say
  std::int64_t frames = 0, steps_partial_left_out = 0;
  SizePx size;                             // of every frame given
  int sizes = 1;                           // how many different ones there were
  SizePx largest;                          // before cropping about the centre
  int exposures = 1;                       // merged into each frame
  int as_short = 1;                        // of them those as short as the shortest
  std::int64_t saturated_samples = 0;      // in every one of them, over the frames given so far
  double disagreement_most = 0;            // of merged exposures: 1 where the noise model holds
  std::vector<std::string> masters;        // "dark 3: 2.1 days, 0.4 K away"
  std::vector<std::string> masters_left;   // why one was not used, what to shoot
  std::vector<std::string> input_sha256s;  // frames, then masters and measured gains
  bool display_referred = false;           // JPEG, PNG and the like: exposed for the eye already
  double gain_min = 1, gain_max = 1;       // over the frames given so far
  bool gain_measured = false;              // by `patina light measure`, not while it was captured
  bool held_to_patch = false;              // as bright as when their light was calibrated
};

bool hasFlat(const FramesReport& report);  // frames went through one

// Decodes a few frames at a time in parallel and gives them in order: memory is bounded by about
// 400 MB whatever the length. Thread-bound. The reader outlives it.
class ArchiveFrames final : public ttf::FrameSource {
 public:
  // Throws WorkflowError: kUsage with the choices; kBadData when no frame is left.
  ArchiveFrames(const db::ArchiveReader& reader, const std::string& run_id,
                const FrameSelection& selection, const Correction& correction);
  // Before the first frame: gains are those that bring the patch to `level`, which it had, at these
  // frames' exposure and ISO, when their light was calibrated. Not of gains measured since, nor
  // where the run's first shot was not watched, nor of a patch that is 15 % off there: that is
  // another one, and said.
  std::string holdToPatch(const ChannelLevels& level);
  ~ArchiveFrames() override;

  std::int64_t count() const override;
  std::optional<ttf::SourceFrame> next() override;
  const FramesReport& report() const { return report_; }
  // Which calibration every frame was given: for the catalogue's frame_calibration.
  const std::vector<db::FrameCalibrationRow>& bindings() const;
  // What noise the numbers of these frames carry; nothing without a photon transfer that fits. For
  // a frame as given, a number is 1 / range() of full scale.
  std::optional<calibration::NoiseModels> noise() const;
  // The mosaic of raw files, where frames of one size are given: each pixel's own colour is the
  // sensor's sample then, the others are mixed from neighbours. Decodes a file.
  std::optional<calibration::ColourFilters> filters() const;
  std::vector<db::FrameRow> rows() const;  // of the frames, in order

 private:
  struct Chosen;
  void choose(const db::ArchiveReader& reader, const FrameSelection& selection);
  std::vector<std::vector<Chosen>> byStep(std::vector<Chosen> all, bool merged);
  void note(const Chosen& chosen);
  std::array<float, 3> gainOf(const Chosen& chosen, const Chosen& shortest);
  std::optional<std::array<float, 3>> gainByPatch(const ChannelLevels& level,
                                                  const db::ShotRow& shot) const;
  void bindMasters();
  struct Decoding;
  void decode(const Chosen& chosen, Decoding& decoding) const;
  void fill();

  const db::ArchiveReader& reader_;
  const std::string run_id_;
  const Correction correction_;
  UtcTime t0_;
  FramesReport report_;
  std::vector<Chosen> chosen_;
  db::ShotRow first_shot_;                                      // of the run under this light
  std::optional<ChannelLevels> patch_;                          // that gains bring theirs to
  std::unique_ptr<SensorChain> chain_;                          // absent: no masters wanted
  std::map<std::string, std::array<float, 3>> measured_gains_;  // by frame, light_gain.h
  std::set<std::pair<int, int>> sizes_;
  std::size_t next_ = 0, batch_at_ = 0, batch_frames_ = 1;
  std::vector<ttf::SourceFrame> batch_;
};

}  // namespace patina::workflow
