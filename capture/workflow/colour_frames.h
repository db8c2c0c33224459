// SPDX-License-Identifier: GPL-3.0-or-later
// Frames in colours of a standard space, by the colour calibration of their camera and light.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "capture/workflow/colour_calibration.h"

namespace patina::workflow {

// "srgb" and "xyz"; kUsage otherwise.
calibration::ColourSpace parseColourSpace(const std::string& text);
std::string nameOf(calibration::ColourSpace space);  // "linear-srgb-d65" "xyz-d50"

struct ColourFramesReport {
  std::vector<std::string> used;                  // "colour 7: 2.1 days away"
  std::vector<std::string> input_sha256s;         // of the calibrations
  std::vector<db::FrameCalibrationRow> bindings;  // of the frames given so far
};

// What a fit says is reflectance where a perfect diffuser at the chart is 1. Frames of another
// exposure time or ISO are scaled by what the chart's picture had of both (where both are known),
// so that the same surface has the same value; a fit with an offset serves its own exposure only.
//
// A frame takes the calibration of its camera and light state that is nearest in time; beyond 30
// days it is refused unless `stale`, and so is a frame without any: some frames in colour and some
// not would be no texture. Thread-bound; `frames` and the reader outlive it.
class ColourFrames final : public ttf::FrameSource {
 public:
  // `chosen` is what `frames` are of. Throws WorkflowError(kBadData), saying what to shoot.
  ColourFrames(ttf::FrameSource& frames, const db::ArchiveReader& reader, const std::string& run_id,
               const FramesReport& chosen, calibration::ColourSpace space, bool stale);

  std::int64_t count() const override { return frames_.count(); }
  std::optional<ttf::SourceFrame> next() override;
  const ColourFramesReport& report() const { return report_; }

 private:
  struct Bound {
    std::size_t model = 0;  // into models_
    double level = 1;
    db::FrameCalibrationRow row;
  };
  void bind(const db::ArchiveReader::CapturedFrame& frame,
            const std::vector<db::CalibrationRow>& rows, const db::ArchiveReader& reader,
            bool stale);

  ttf::FrameSource& frames_;
  const calibration::ColourSpace space_;
  const UtcTime t0_;
  ColourFramesReport report_;
  std::vector<ColourCalibration> models_;
  std::map<db::RowId, std::size_t> model_of_row_;
  // By the frame's hash and time: frames of equal bytes may be served by different charts.
  std::map<std::pair<std::string, double>, Bound> bound_;
};

}  // namespace patina::workflow
