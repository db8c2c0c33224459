// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/master_pictures.h"

#include <algorithm>

#include "capture/workflow/failure.h"
#include "capture/workflow/import_listing.h"
#include "processing/image/sidecar_file.h"

namespace patina::workflow {
namespace {

namespace fs = std::filesystem;

void describe(const Bytes& file, PictureStack& stack) {
  const SensorPicture picture = decodeSensorPicture(file, nullptr);
  stack.key.bits = picture.bits;
  stack.mosaic = picture.raw.has_value();
  stack.channels = picture.raw ? 1 : picture.linear.channels();
  stack.key.size = picture.raw ? picture.raw->samples.size() : picture.linear.size();
  if (picture.raw) stack.filters = picture.raw->cfa;
}

}  // namespace

std::function<calibration::PictureSource()> PictureStack::open(
    const calibration::ResponseCurve* response) const {
  return [this, response]() -> calibration::PictureSource {
    return [this, response, next = std::size_t{0}]() mutable -> std::optional<Image<float>> {
      if (next == files.size()) return std::nullopt;
      return uncorrected(decodeSensorPicture(files[next++](), response));
    };
  };
}

PictureStack stackOfFolder(const fs::path& folder, UtcTime now, std::vector<std::string>& notes) {
  const std::vector<fs::path> paths = picturesIn(folder);
  PictureStack stack;
  const Bytes middle = readFile(paths[paths.size() / 2]);
  describe(middle, stack);
  const PictureMetadata about = readMetadataOf(paths[paths.size() / 2], middle);
  stack.key.exposure = about.exposure.value_or(Nanoseconds{});
  stack.key.iso = about.iso ? about.iso->value : 0;
  stack.key.utc = about.taken_utc.value_or(now);
  if (!about.taken_utc) notes.push_back("the pictures do not say when they were taken: now");
  for (const fs::path& path : paths) {
    stack.input_sha256s.push_back(sha256OfFile(path).hex());
    stack.files.push_back([path] { return readFile(path); });
  }
  return stack;
}

PictureStack stackOfRun(const db::ArchiveReader& reader, const std::string& run,
                        const FrameSelection& selection) {
  const ArchiveFrames frames(reader, run, selection, {false, false, false});
  if (frames.report().sizes > 1)
    throw WorkflowError(Exit::kBadData, "the frames of " + run + " differ in size");
  PictureStack stack;
  for (const db::FrameRow& row : frames.rows())
    stack.files.push_back([&reader, row] { return reader.read(row); });
  describe(stack.files.front()(), stack);
  stack.key.device_id = frames.report().camera;
  stack.key.light_state = frames.report().light;
  stack.key.exposure = frames.report().exposure_time;
  stack.input_sha256s = frames.report().input_sha256s;
  double degrees = 0;
  int count = 0;
  for (const db::ReadingRow& reading : reader.readings(run))
    if (reading.quantity == "temperature" && reading.quality == "ok") {
      degrees += reading.value;
      ++count;
    }
  if (count > 0) stack.key.temperature_c = degrees / count;
  reader.eachFrame(run, [&](const db::ArchiveReader::CapturedFrame& one) {
    if (one.shot.device_id != stack.key.device_id) return;
    stack.key.iso = one.shot.iso;
    stack.key.utc = one.frame.utc;
  });
  return stack;
}

}  // namespace patina::workflow
