// SPDX-License-Identifier: GPL-3.0-or-later
// Frames as a texture in millimetres: the lens straightened, the plane seen from straight above,
// the lens's fall-off taken out where no flat did it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibration/lens/rectification.h"
#include "calibration/lens/vignetting.h"
#include "capture/workflow/archive_frames.h"

namespace patina::workflow {

struct RectifyRequest {
  std::optional<calibration::RegionMm> region;  // nothing: the largest that is wholly seen
  double texels_per_mm = 0;                     // 0: as many as the picture has pixels
  bool stale = false;                           // also by a view that is more than 90 days away
};
// A calibration of the camera's geometry, as it serves a run.
struct UsedGeometry {
  db::RowId row = 0;
  std::string sha256;             // of its file
  std::string described;          // "view 4: 2.1 days away"
  UtcTime utc;                    // when its picture was taken
  bool within_tolerance = false;  // 90 days
};
// Where texels are seen in the frames of one camera, before any of them is decoded. `map` composes
// with a registration (processing/image/pixel_map.h).
struct RectifyMap {
  PixelMap map;
  calibration::RegionMm region;
  double mm_per_texel = 0;
  UsedGeometry view;
};
// By the view of the camera nearest to `utc`. Throws WorkflowError(kBadData), saying what to shoot.
RectifyMap rectifyMap(const db::ArchiveReader& reader, const std::string& camera, SizePx size,
                      UtcTime utc, const RectifyRequest& request);

// The fall-off of the camera's lens, when the archive has one that fits, is within tolerance and no
// flat was applied.
struct KnownVignetting {
  calibration::Vignetting vignetting;
  UsedGeometry used;
};
std::optional<KnownVignetting> vignettingFor(const db::ArchiveReader& reader,
                                             const FramesReport& frames, UtcTime utc);

// Which frames of the run were given it, for the catalogue's frame_calibration.
std::vector<db::FrameCalibrationRow> bindingsOf(const db::ArchiveReader& reader,
                                                const std::string& run_id,
                                                const FramesReport& frames,
                                                const std::vector<UsedGeometry>& used);

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
