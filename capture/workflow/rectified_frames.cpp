// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/rectified_frames.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "capture/workflow/failure.h"
#include "capture/workflow/view_calibration.h"
#include "capture/workflow/vignetting_calibration.h"

namespace patina::workflow {
namespace {

constexpr double kHoldsDays = 90;

UsedGeometry usedOf(const db::CalibrationRow& row, UtcTime utc) {
  const double days = std::abs(toSeconds(row.utc - utc)) / 86400;
  char text[96];
  std::snprintf(text, sizeof text, "%s %lld: %.1f days away", row.kind.c_str(),
                static_cast<long long>(row.id), days);
  return {row.id, row.sha256, text, row.utc, days <= kHoldsDays};
}

}  // namespace

RectifyMap rectifyMap(const db::ArchiveReader& reader, const std::string& camera, SizePx size,
                      UtcTime utc, const RectifyRequest& request) {
  std::string why_not;
  const auto row = nearestOfCamera(reader, "view", camera, size, utc, why_not);
  if (!row)
    throw WorkflowError(
        Exit::kBadData,
        "the archive has no view of " + camera +
            (why_not.empty() ? "" : " that fits (" + why_not + ")") +
            ": shoot a board lying on the specimen and run `patina calibrate view`");
  RectifyMap made;
  made.view = usedOf(*row, utc);
  if (!made.view.within_tolerance && !request.stale)
    throw WorkflowError(Exit::kBadData, made.view.described +
                                            ", at most 90 are trusted: shoot the board again and "
                                            "run `patina calibrate view`, or give "
                                            "--stale-calibration");
  const KnownView known = readView(fileOfCalibration(reader, *row));
  made.region = request.region.value_or(seenRegion(known.lens, known.view));
  calibration::RectifyOptions options{made.region, request.texels_per_mm};
  if (options.texels_per_mm == 0)
    options.texels_per_mm = naturalTexelsPerMm(known.lens, known.view, made.region);
  made.map = rectification(known.lens, known.view, options);
  made.mm_per_texel = 1 / options.texels_per_mm;
  return made;
}

std::optional<KnownVignetting> vignettingFor(const db::ArchiveReader& reader,
                                             const FramesReport& frames, UtcTime utc) {
  const auto is_flat = [](const std::string& used) { return used.starts_with("flat"); };
  if (std::any_of(frames.masters.begin(), frames.masters.end(), is_flat)) return std::nullopt;
  std::string why_not;
  const auto row = nearestOfCamera(reader, "vignetting", frames.camera, frames.size, utc, why_not);
  if (!row) return std::nullopt;
  const UsedGeometry used = usedOf(*row, utc);
  if (!used.within_tolerance) return std::nullopt;
  return KnownVignetting{readVignetting(fileOfCalibration(reader, *row)), used};
}

std::vector<db::FrameCalibrationRow> bindingsOf(const db::ArchiveReader& reader,
                                                const std::string& run_id,
                                                const FramesReport& frames,
                                                const std::vector<UsedGeometry>& used) {
  std::vector<db::FrameCalibrationRow> rows;
  if (used.empty()) return rows;
  const std::set<std::string> given(frames.input_sha256s.begin(), frames.input_sha256s.end());
  reader.eachFrame(run_id, [&](const db::ArchiveReader::CapturedFrame& one) {
    if (one.shot.device_id != frames.camera || one.shot.light_state != frames.light ||
        one.shot.exposure_index != frames.exposure || !given.contains(one.frame.sha256.hex()))
      return;
    for (const UsedGeometry& geometry : used)
      rows.push_back({one.frame.id, geometry.row, toSeconds(geometry.utc - one.frame.utc), 0,
                      geometry.within_tolerance});
  });
  return rows;
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
