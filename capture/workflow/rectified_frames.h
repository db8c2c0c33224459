// SPDX-License-Identifier: GPL-3.0-or-later
// Frames as a texture in millimetres: the lens straightened, the plane seen from straight above,
// the lens's fall-off taken out where no flat did it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibration/lens/rectification.h"
#include "calibration/lens/vignetting.h"
#include "capture/workflow/run_calibration.h"

namespace patina::workflow {

struct RectifyRequest {
  std::optional<calibration::RegionMm> region;  // nothing: the largest that is wholly seen
  double texels_per_mm = 0;                     // 0: as many as the picture has pixels
};
// Where texels are seen in the frames of one camera, before any of them is decoded. `map` composes
// with a registration (processing/image/pixel_map.h).
struct RectifyMap {
  PixelMap map;
  calibration::RegionMm region;
  double mm_per_texel = 0;
  RunCalibration view;
};
// By the view of the camera that fits best. Throws WorkflowError(kBadData), saying what to shoot.
RectifyMap rectifyMap(const db::ArchiveReader& reader, const calibration::CalibrationKey& frames,
                      const RectifyRequest& request, bool stale);

// The fall-off of the camera's lens, where the archive has one that fits. `left`: why one does not.
struct KnownVignetting {
  calibration::Vignetting vignetting;
  RunCalibration used;
};
std::optional<KnownVignetting> vignettingFor(const db::ArchiveReader& reader,
                                             const calibration::CalibrationKey& frames, bool stale,
                                             std::vector<std::string>& left);

// What is done to every frame, in this order. Thread-bound; `frames` outlives it.
class RectifiedFrames final : public ttf::FrameSource {
 public:
  RectifiedFrames(ttf::FrameSource& frames, std::optional<calibration::Vignetting> vignetting,
                  std::optional<PixelMap> map);
  std::int64_t count() const override { return frames_.count(); }
  std::optional<ttf::SourceFrame> next() override;

 private:
  ttf::FrameSource& frames_;
  std::optional<calibration::Vignetting> vignetting_;
  std::optional<PixelMap> map_;
};

}  // namespace patina::workflow
