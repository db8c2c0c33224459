// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/colour_frames.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "capture/workflow/failure.h"

namespace patina::workflow {
namespace {

constexpr double kDaysMax = 30, kSecondsADay = 86400;
constexpr double kSameExposure = 0.01;  // relative: what two cameras' rounding differs by

double daysBetween(UtcTime a, UtcTime b) { return std::abs(toSeconds(a - b)) / kSecondsADay; }

// What the chart's picture had of exposure and ISO, over what the frame has; 1 where one is
// unknown.
double levelOf(const ColourCalibration& chart, const db::ShotRow& shot) {
  double level = 1;
  if (chart.exposure.count() > 0 && shot.exposure.count() > 0)
    level *= toSeconds(chart.exposure) / toSeconds(shot.exposure);
  if (chart.iso > 0 && shot.iso > 0) level *= chart.iso / shot.iso;
  return level;
}

[[noreturn]] void shootOne(const std::string& camera, const std::string& light,
                           const std::string& why) {
  throw WorkflowError(Exit::kBadData, why + ": photograph a ColorChecker with " + camera +
                                          " under " + light +
                                          ", then patina calibrate colour "
                                          "CHART --camera " +
                                          camera + " --light " + light);
}

}  // namespace

calibration::ColourSpace parseColourSpace(const std::string& text) {
  if (text == "srgb") return calibration::ColourSpace::kLinearSrgb;
  if (text == "xyz") return calibration::ColourSpace::kXyz;
  throw WorkflowError(Exit::kUsage, "'" + text + "' is no colour space: srgb or xyz");
}

std::string nameOf(calibration::ColourSpace space) {
  return space == calibration::ColourSpace::kXyz ? "xyz-d50" : "linear-srgb-d65";
}

ColourFrames::ColourFrames(ttf::FrameSource& frames, const db::ArchiveReader& reader,
                           const std::string& run_id, const FramesReport& chosen,
                           calibration::ColourSpace space, bool stale)
    : frames_(frames), space_(space), t0_(reader.findRun(run_id).t0_utc) {
  std::vector<db::CalibrationRow> rows = reader.calibrations("colour");
  std::erase_if(rows, [&](const db::CalibrationRow& row) {
    return row.device_id != chosen.camera || row.light_state != chosen.light;
  });
  if (rows.empty())
    shootOne(
        chosen.camera, chosen.light,
        "the archive has no colour calibration of " + chosen.camera + " under " + chosen.light);
  reader.eachFrame(run_id, [&](const db::ArchiveReader::CapturedFrame& frame) {
    if (frame.shot.device_id == chosen.camera && frame.shot.light_state == chosen.light &&
        frame.shot.exposure_index == chosen.exposure)
      bind(frame, rows, reader, stale);
  });
}

void ColourFrames::bind(const db::ArchiveReader::CapturedFrame& frame,
                        const std::vector<db::CalibrationRow>& rows,
                        const db::ArchiveReader& reader, bool stale) {
  const db::CalibrationRow& row =
      *std::ranges::min_element(rows, {}, [&](const db::CalibrationRow& one) {
        // Of equal times the newer row.
        return std::pair(daysBetween(one.utc, frame.frame.utc), -one.id);
      });
  const double days = daysBetween(row.utc, frame.frame.utc);
  char name[96];
  std::snprintf(name, sizeof name, "colour %lld: %.1f days away", static_cast<long long>(row.id),
                days);
  if (days > kDaysMax && !stale)
    shootOne(row.device_id, row.light_state,
             std::string(name) + ", more than 30 (--stale-calibration takes it all the same)");
  const auto [at, is_new] = model_of_row_.try_emplace(row.id, models_.size());
  if (is_new) {
    models_.push_back(readColourCalibration(fileOfCalibration(reader, row)));
    report_.used.emplace_back(name);
    report_.input_sha256s.push_back(row.sha256);
  }
  const ColourCalibration& chart = models_[at->second];
  const double level = levelOf(chart, frame.shot);
  if (chart.model.kind == calibration::FitKind::k4x3 && std::abs(level - 1) > kSameExposure)
    shootOne(row.device_id, row.light_state,
             std::string(name) +
                 " is a 4x3 fit, whose offset holds at the chart's exposure only; make it with "
                 "--fit root2, or");
  bound_[{frame.frame.sha256.hex(), toSeconds(frame.frame.utc - t0_)}] = {
      at->second,
      level,
      {frame.frame.id, row.id, toSeconds(row.utc - frame.frame.utc), 0, days <= kDaysMax}};
}

std::optional<ttf::SourceFrame> ColourFrames::next() {
  std::optional<ttf::SourceFrame> frame = frames_.next();
  if (!frame) return frame;
  const auto bound = bound_.find({frame->source.hex(), frame->time_s});
  PATINA_CHECK(bound != bound_.end());
  if (frame->linear.channels() != 3)
    throw WorkflowError(Exit::kBadData,
                        "the frames have no colours: a grey camera needs no colour calibration");
  calibration::applyColour(frame->linear.view(), models_[bound->second.model].model, space_,
                           bound->second.level);
  report_.bindings.push_back(bound->second.row);
  return frame;
}

}  // namespace patina::workflow
