// SPDX-License-Identifier: GPL-3.0-or-later
// A run's sweeps laid over its first: every lamp's picture of a step by the pose that all of them
// tell.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "calibration/registration/sweep_track.h"
#include "capture/workflow/registered_frames.h"

namespace patina::workflow {

struct SweepPicture {
  std::size_t state = 0;  // of the plan
  Image<float> linear;
  bool resampled = false;  // otherwise each pixel is the sensor's own
};

// Thread-bound; `progress` outlives it.
class RegisteredSweeps {
 public:
  // `states`: lamps by number, to be named. Throws WorkflowError(kUsage) for a field of
  // displacements: that is found for one lamp's frames alone.
  RegisteredSweeps(const RegistrationRequest& request, std::vector<std::string> states,
                   std::optional<PixelMap> map, Progress& progress);

  // The next sweep, its pictures in order of time: those that cannot be trusted are taken out, the
  // others resampled, but for those that lie as the first within a tenth of a pixel; with a map
  // all, into its geometry. Without `resampled` they stay as they are: only poses are wanted.
  // Levels that are not known (NaN) stay that, and so does what is mixed from them. Throws
  // CalibrationError where fiducials or, under every lamp, markers are not there.
  void lay(std::int64_t step, std::vector<SweepPicture>& pictures, bool resampled);

  // What was left out, what was taken for ageing, and where the camera moved within a sweep: a line
  // each.
  std::vector<std::string> notes() const;

 private:
  void begin(const std::vector<SweepPicture>& first);
  void note(std::int64_t step, const std::vector<SweepPicture>& pictures,
            const calibration::SweepPoses& poses);

  const RegistrationRequest request_;
  const std::vector<std::string> states_;
  const std::optional<PixelMap> map_;
  Progress& progress_;
  std::unique_ptr<calibration::SweepTrack> track_;
  int frames_ = 0, refused_ = 0;
  std::string refused_named_, aged_steps_;
  std::vector<std::string> bumps_;
};

}  // namespace patina::workflow
