// SPDX-License-Identifier: GPL-3.0-or-later
// Frames without the light that is not the lamps', and as if the lamps of their state had not
// drifted apart: by the other light states of the same step.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "capture/workflow/archive_frames.h"

namespace patina::workflow {

struct LampCorrection {
  bool ambient = false;  // subtract the lights-off frame of the step
  bool apart = false;    // of a state of several lamps: undo the drift of each by its own shot
  bool any() const { return ambient || apart; }
};
struct LampFramesReport {
  double ambient_share_most = 0;  // of any channel's light of any frame given so far
  double noise_factor_most = 1;   // by that subtraction, limited by photons
  double gain_min = 1, gain_max = 1;
  bool gain_measured = false;              // by `patina light measure`, not while it was captured
  std::vector<std::string> input_sha256s;  // of the other states' frames, known from the start
};

// Thread-bound. The reader and the frames outlive it.
class LampFrames final : public ttf::FrameSource {
 public:
  // `frames` are made with Correction::light_gain off: gains follow here, after ambient light is
  // gone, where `correction` asks for them: as measured since, else of the light checks. Throws
  // WorkflowError(kUsage) when the run has no lights-off shots, or a lamp of the state none of its
  // own, or the state was measured since and a lamp of it was not.
  LampFrames(const db::ArchiveReader& reader, const std::string& run_id, ArchiveFrames& frames,
             const FrameSelection& selection, const Correction& correction,
             const LampCorrection& lamps);
  ~LampFrames() override;

  std::int64_t count() const override { return frames_.count(); }
  // Throws WorkflowError(kBadData) when a step lacks a state that is needed.
  std::optional<ttf::SourceFrame> next() override;
  const LampFramesReport& report() const { return report_; }

 private:
  struct Place {  // of a frame in its run
    std::int64_t step = 0;
    db::RowId shot = 0;
  };
  class Companion;
  using Places = std::map<std::pair<std::string, double>, Place>;  // by hash and time
  void takeAmbient(Image<float>& linear, Nanoseconds exposure, std::int64_t step);
  void undoDriftApart(Image<float>& linear, std::int64_t step);
  using Gains = std::map<std::string, std::array<float, 3>>;  // by frame, light_gain.h
  [[noreturn]] void refuseUnmeasured(const std::string& lamp) const;
  Gains measuredGains(const std::string& run_id, const std::string& light);
  std::array<float, 3> gainOf(const Gains& measured, const ttf::SourceFrame& frame,
                              db::RowId shot) const;
  void applyGain(Image<float>& linear, const std::array<float, 3>& gain);

  const db::ArchiveReader& reader_;
  ArchiveFrames& frames_;
  const Correction correction_;
  LampFramesReport report_;
  Places places_;
  std::unique_ptr<Companion> off_;
  std::vector<std::unique_ptr<Companion>> alone_;  // of each lamp, where drift apart is undone
  Gains measured_;
  std::vector<Gains> measured_alone_;
};

}  // namespace patina::workflow
