// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/mean_picture.h"

#include <algorithm>
#include <functional>

#include "capture/workflow/failure.h"
#include "capture/workflow/import_listing.h"
#include "processing/image/metadata_file.h"

namespace patina::workflow {
namespace {

namespace fs = std::filesystem;

using Next = std::function<std::optional<Image<float>>()>;

void average(MeanPicture& mean, const Next& next, int most, Progress& progress) {
  progress.begin("pictures", most);
  while (mean.frames < most) {
    std::optional<Image<float>> picture = next();
    if (!picture) break;
    if (mean.frames == 0)
      mean.linear = std::move(*picture);
    else if (picture->size() != mean.linear.size() || picture->channels() != mean.linear.channels())
      throw WorkflowError(Exit::kBadData, "the pictures differ in size");
    else
      std::transform(mean.linear.texels().begin(), mean.linear.texels().end(),
                     picture->texels().begin(), mean.linear.texels().begin(), std::plus<>());
    ++mean.frames;
    progress.step();
  }
  for (float& v : mean.linear.texels()) v /= static_cast<float>(std::max(mean.frames, 1));
}

MeanPicture ofFolder(const MeanPictureRequest& request, UtcTime now, Progress& progress) {
  std::vector<fs::path> files = picturesIn(request.folder);
  files.resize(std::min(files.size(), static_cast<std::size_t>(request.frames_most)));
  MeanPicture mean;
  for (const fs::path& file : files) mean.input_sha256s.push_back(sha256OfFile(file).hex());
  const Bytes first = readFile(files.front());
  const PictureMetadata about = readMetadata(first);
  mean.zoom = zoomOf(first);
  mean.row.device_id = request.camera;
  mean.row.light_state = request.light;
  mean.row.exposure = about.exposure.value_or(Nanoseconds{});
  mean.row.iso = about.iso ? about.iso->value : 0;
  mean.row.utc = about.taken_utc.value_or(now);
  std::size_t at = 0;
  average(
      mean,
      [&]() -> std::optional<Image<float>> {
        return at < files.size() ? std::optional(readPicture(files[at++]).linear) : std::nullopt;
      },
      request.frames_most, progress);
  return mean;
}

// Of the first `count` frames.
std::optional<ChannelLevels> patchOf(const db::ArchiveReader& reader, const ArchiveFrames& frames,
                                     int count) {
  ChannelLevels mean{};
  const std::vector<db::FrameRow> rows = frames.rows();
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
    const auto level =
        patchLevelOf(reader.lightChecksOfShot(rows[i].shot_id), frames.report().camera);
    if (!level) return std::nullopt;
    for (std::size_t c = 0; c < mean.size(); ++c) mean[c] += (*level)[c] / count;
  }
  return mean;
}

MeanPicture ofRun(const fs::path& archive, const MeanPictureRequest& request, Progress& progress) {
  const db::ArchiveReader reader(archive);
  MeanPicture mean;
  mean.run_id = reader.findRun(request.run).id;
  Correction correction;
  correction.light_gain = false;
  ArchiveFrames frames(reader, mean.run_id, request.selection, correction);
  mean.row.device_id = frames.report().camera;
  mean.row.light_state = frames.report().light;
  mean.row.exposure = frames.report().exposure_time;
  mean.zoom = {frames.report().focal_mm, frames.report().focus_m};
  mean.flat = hasFlat(frames.report());
  reader.eachFrame(mean.run_id, [&](const db::ArchiveReader::CapturedFrame& one) {
    if (one.shot.device_id != mean.row.device_id) return;
    mean.row.iso = one.shot.iso;
    mean.row.utc = one.frame.utc;
  });
  average(
      mean,
      [&]() -> std::optional<Image<float>> {
        auto frame = frames.next();
        if (!frame) return std::nullopt;
        mean.input_sha256s.push_back(frame->source.hex());
        return std::move(frame->linear);
      },
      request.frames_most, progress);
  mean.patch = patchOf(reader, frames, mean.frames);
  return mean;
}

}  // namespace

MeanPicture meanPicture(const fs::path& archive, const MeanPictureRequest& request, UtcTime now,
                        Progress& progress) {
  MeanPicture mean =
      request.run.empty() ? ofFolder(request, now, progress) : ofRun(archive, request, progress);
  mean.row.size = mean.linear.size();
  return mean;
}

}  // namespace patina::workflow
