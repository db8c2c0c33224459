// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/rectified_frames.h"

#include "capture/workflow/failure.h"
#include "capture/workflow/view_calibration.h"
#include "capture/workflow/vignetting_calibration.h"

namespace patina::workflow {

RectifyMap rectifyMap(const db::ArchiveReader& reader, const calibration::CalibrationKey& frames,
                      const RectifyRequest& request, bool stale) {
  const CalibrationChoice choice = chooseCalibration(reader, "view", frames, stale);
  if (!choice.row)
    throw WorkflowError(Exit::kBadData,
                        "the archive has no view of " + frames.device_id +
                            (choice.left.empty() ? ": " + shootInstead(frames, "view")
                                                 : " that fits: " + choice.left));
  RectifyMap made;
  made.view = choice.used;
  const KnownView known = readView(fileOfCalibration(reader, *choice.row));
  made.region = request.region.value_or(seenRegion(known.lens, known.view));
  calibration::RectifyOptions options{made.region, request.texels_per_mm};
  if (options.texels_per_mm == 0)
    options.texels_per_mm = naturalTexelsPerMm(known.lens, known.view, made.region);
  made.map = rectification(known.lens, known.view, options);
  made.mm_per_texel = 1 / options.texels_per_mm;
  return made;
}

std::optional<KnownVignetting> vignettingFor(const db::ArchiveReader& reader,
                                             const calibration::CalibrationKey& frames, bool stale,
                                             std::vector<std::string>& left) {
  const CalibrationChoice choice = chooseCalibration(reader, "vignetting", frames, stale);
  if (!choice.left.empty()) left.push_back(choice.left);
  if (!choice.row) return std::nullopt;
  return KnownVignetting{readVignetting(fileOfCalibration(reader, *choice.row)), choice.used};
}

RectifiedFrames::RectifiedFrames(ttf::FrameSource& frames,
                                 std::optional<calibration::Vignetting> vignetting,
                                 std::optional<PixelMap> map)
    : frames_(frames), vignetting_(vignetting), map_(std::move(map)) {}

std::optional<ttf::SourceFrame> RectifiedFrames::next() {
  std::optional<ttf::SourceFrame> frame = frames_.next();
  if (!frame) return frame;
  if (vignetting_) removeVignetting(frame->linear.view(), *vignetting_);
  if (map_) frame->linear = resample(frame->linear.view(), *map_);
  return frame;
}

}  // namespace patina::workflow
