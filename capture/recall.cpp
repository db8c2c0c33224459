// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/recall.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace patina::capture {
namespace {

constexpr double kWeight = 0.3;  // of an innovation: as of a tile's forecast

using SeriesKey = std::tuple<std::string, std::string, int>;  // camera, light state, exposure

std::optional<calibration::TileLevels> tilesOfFrame(const db::ArchiveReader& reader,
                                                    const db::FrameRow& frame, RectPx patch) {
  try {
    return tilesOf(reader.read(frame), patch);
  } catch (const Failure&) {
    return std::nullopt;  // gone or damaged: scrub tells of it
  }
}

// Log of the patch's level over all channels; nothing where the shot has none.
std::optional<double> patchLevel(const std::vector<db::LightCheckRow>& checks,
                                 const std::string& camera) {
  double sum = 0;
  int channels = 0;
  for (const db::LightCheckRow& check : checks)
    if (check.source == "patch:" + camera && check.level > 0) {
      sum += std::log(check.level);
      ++channels;
    }
  return channels > 0 ? std::optional(sum / channels) : std::nullopt;
}

std::vector<db::StepRow> lastSteps(const db::ArchiveReader& reader, const std::string& run_id,
                                   int steps_most) {
  std::vector<db::StepRow> last;
  const std::vector<db::StepRow> steps = reader.steps(run_id);
  for (auto step = steps.rbegin();
       step != steps.rend() && static_cast<int>(last.size()) < steps_most; ++step)
    if (step->shots_captured > 0) last.push_back(*step);
  std::ranges::reverse(last);
  return last;
}

}  // namespace

std::vector<RecalledPicture> recallPictures(const db::ArchiveReader& reader,
                                            const std::string& run_id,
                                            const std::map<std::string, RectPx>& patches,
                                            int steps_most,
                                            const std::function<bool()>& time_left) {
  std::vector<RecalledPicture> pictures;
  std::map<SeriesKey, double> foretold;  // log level of the patch
  for (const db::StepRow& step : lastSteps(reader, run_id, steps_most)) {
    const std::vector<db::FrameRow> frames = reader.framesOfStep(step.id);
    for (const db::ShotRow& shot : reader.shotsOfStep(step.id)) {
      if (shot.state != db::ShotState::kCaptured) continue;
      RecalledPicture picture;
      picture.camera = shot.device_id;
      picture.light_state = shot.light_state;
      picture.exposure_index = shot.exposure_index;
      picture.utc = shot.began_utc;
      const auto patch = patches.find(shot.device_id);
      for (const db::FrameRow& frame : frames) {
        if (frame.shot_id != shot.id) continue;
        picture.files.push_back({frame.file_index, frame.sha256, shot.light_state != "off"});
        if (frame.file_index == 0 && patch != patches.end() && time_left())
          picture.tiles = tilesOfFrame(reader, frame, patch->second);
      }
      if (const auto level = patchLevel(reader.lightChecksOfShot(shot.id), shot.device_id)) {
        double& forecast =
            foretold.try_emplace({shot.device_id, shot.light_state, shot.exposure_index}, *level)
                .first->second;
        picture.patch = std::expm1(*level - forecast);
        forecast += kWeight * (*level - forecast);
      }
      pictures.push_back(std::move(picture));
    }
  }
  return pictures;
}

}  // namespace patina::capture
