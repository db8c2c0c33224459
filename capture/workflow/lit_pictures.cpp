// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/lit_pictures.h"

#include <algorithm>
#include <optional>
#include <set>

#include "capture/workflow/failure.h"
#include "capture/workflow/import_listing.h"
#include "capture/workflow/picture_times.h"
#include "processing/image/metadata_file.h"

namespace patina::workflow {
namespace {

namespace fs = std::filesystem;

LitPictures ofFolder(const fs::path& folder, UtcTime now) {
  const std::vector<fs::path> files = picturesIn(folder);
  LitPictures pictures;
  for (const fs::path& file : files) {
    pictures.names.push_back(file.filename().string());
    pictures.input_sha256s.push_back(sha256OfFile(file).hex());
  }
  const Bytes first = readFile(files.front());
  const PictureMetadata about = readMetadata(first);
  pictures.row.size = readPictureHeader(first).size;
  pictures.zoom = zoomOf(first);
  pictures.row.exposure = about.exposure.value_or(Nanoseconds{});
  pictures.row.iso = about.iso ? about.iso->value : 0;
  pictures.row.utc = about.taken_utc.value_or(now);
  pictures.picture = [files](int i) {
    return readPicture(files[static_cast<std::size_t>(i)]).linear;
  };
  return pictures;
}

LitPictures ofRun(const fs::path& archive, const LitPicturesRequest& request) {
  LitPictures pictures;
  pictures.reader = std::make_shared<const db::ArchiveReader>(archive);
  const db::ArchiveReader& reader = *pictures.reader;
  pictures.run_id = reader.findRun(request.run).id;
  std::set<std::string> lamps;
  reader.eachFrame(pictures.run_id, [&](const db::ArchiveReader::CapturedFrame& one) {
    const std::string& state = one.shot.light_state;
    if (state != "off" && state.find('+') == std::string::npos) lamps.insert(state);
    pictures.row.utc = one.frame.utc;
    pictures.row.iso = one.shot.iso;
  });
  if (lamps.empty())
    throw WorkflowError(Exit::kBadData, pictures.run_id +
                                            " has no shots under one lamp alone; give its plan "
                                            "lights = [[\"key\"], [\"fill\"], ...]");
  pictures.names.assign(lamps.begin(), lamps.end());
  std::sort(pictures.names.begin(), pictures.names.end(), naturalLess);
  const auto framesOf = [reader = pictures.reader, run = pictures.run_id,
                         selection = request.selection](const std::string& lamp) {
    FrameSelection under = selection;
    under.light = lamp;
    Correction correction;
    correction.light_gain = false;
    return std::make_unique<ArchiveFrames>(*reader, run, under, correction);
  };
  const auto first = framesOf(pictures.names.front());
  pictures.row.device_id = first->report().camera;
  pictures.row.exposure = first->report().exposure_time;
  pictures.row.size = first->report().size;
  pictures.flat = hasFlat(first->report());
  pictures.zoom = {first->report().focal_mm, first->report().focus_m};
  pictures.picture = [framesOf, names = pictures.names](int i) {
    return std::move(framesOf(names[static_cast<std::size_t>(i)])->next()->linear);
  };
  for (const std::string& lamp : pictures.names)
    pictures.input_sha256s.push_back(framesOf(lamp)->report().input_sha256s.front());
  return pictures;
}

}  // namespace

LitPictures litPictures(const fs::path& archive, const LitPicturesRequest& request, UtcTime now) {
  return request.run.empty() ? ofFolder(request.folder, now) : ofRun(archive, request);
}

calibration::CalibrationKey keyOf(const LitPictures& pictures) {
  calibration::CalibrationKey key;
  key.device_id = pictures.row.device_id;
  key.exposure = pictures.row.exposure;
  key.iso = pictures.row.iso;
  key.size = pictures.row.size;
  key.utc = pictures.row.utc;
  key.focal_mm = pictures.zoom.focal_mm;
  key.focus_m = pictures.zoom.focus_m;
  return key;
}

}  // namespace patina::workflow
