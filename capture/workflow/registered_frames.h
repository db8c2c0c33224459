// SPDX-License-Identifier: GPL-3.0-or-later
// Frames laid over the first one: each texel shows the same place of the specimen all along.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "calibration/registration/deformation_track.h"
#include "calibration/registration/pose_track.h"
#include "processing/image/pixel_map.h"
#include "processing/image/progress.h"
#include "processing/ttf/frame_source.h"

namespace patina::workflow {

struct RegistrationRequest {
  calibration::MotionModel model = calibration::MotionModel::kTranslation;
  std::vector<RectPx> fiducials;  // of the first frame: what is not specimen and does not age
  bool markers = false;           // ArUco markers of the first frame are fiducials too
  bool deform = false;            // a smooth field on top, from recent frames
};

// What is not specimen, of the first frame: fiducials and markers, others 0. Empty where the
// request names none. Throws CalibrationError as maskOf() and markersIn().
Image<std::uint8_t> outsideOf(const RegistrationRequest& request, const Image<float>& first);

struct RegisteredFrame {
  double time_s = 0;
  Sha256 source;
  calibration::FramePose pose;
  bool used = false;
  double deformed_px = 0;  // the farthest that a place lies from where the pose has it
};
struct RegistrationReport {
  std::vector<RegisteredFrame> frames;  // all of them so far, those refused too
  std::vector<calibration::PoseEpoch> epochs;
  int refused = 0, keyframes = 0;
  RectPx seen_by_all;          // of the first frame's pixels; what lies outside is 0 in some frame
  double largest_move_px = 0;  // of a corner
};

// Frames that cannot be trusted are left out and named in the report; nothing is put in their
// place. Without a map the result has the first frame's geometry; with one (a lens straightened, a
// view in millimetres, of the first frame) both are one resampling. Thread-bound; `frames` and
// `progress` outlive it. Throws CalibrationError.
class RegisteredFrames final : public ttf::FrameSource {
 public:
  RegisteredFrames(ttf::FrameSource& frames, const RegistrationRequest& request,
                   std::optional<PixelMap> map, Progress& progress);

  std::int64_t count() const override { return frames_.count(); }  // at most
  std::optional<ttf::SourceFrame> next() override;
  const RegistrationReport& report() const { return report_; }

 private:
  void begin(const Image<float>& first);
  PixelMap placesOf(const Image<float>& frame, RegisteredFrame& about);

  ttf::FrameSource& frames_;
  const RegistrationRequest request_;
  std::optional<PixelMap> map_;
  Progress& progress_;
  std::unique_ptr<calibration::PoseTrack> track_;
  std::unique_ptr<calibration::DeformationTrack> deformations_;  // where they are asked for
  RegistrationReport report_;
};

// One line of JSON for the whole, then one a frame: poses by rows (m00 .. m22: where in the frame
// is what the first one shows at (x, y, 1)), verdicts, and what they rest on.
std::string registrationLines(const RegistrationReport& report, const RegistrationRequest& request);
// "1 of 48 frames refused: 31 (fogged: contrast is 0.42 of the reference's, wanted 0.80)"; empty
// when none was.
std::string refusedFrames(const RegistrationReport& report);

}  // namespace patina::workflow
