// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/hdr_folder.h"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "calibration/sensor/merge.h"
#include "calibration/sensor/radiance.h"
#include "capture/workflow/failure.h"
#include "capture/workflow/import_listing.h"
#include "capture/workflow/response_calibration.h"
#include "capture/workflow/sensor_chain.h"
#include "processing/image/linear_mosaic.h"
#include "processing/image/sidecar_file.h"

namespace patina::workflow {
namespace {

namespace fs = std::filesystem;

struct Brackets {
  std::vector<Image<float>> lights;        // mosaics [h][w][1], else as decoded
  std::vector<Image<std::uint8_t>> marks;  // of radiance.h
  std::vector<double> exposures_s;
  std::optional<RawMosaic> raw;  // the first one, where they are raw
  int bits = 8;
};

double exposureOf(const HdrRequest& request, const fs::path& file, const Bytes& bytes,
                  std::size_t at) {
  if (!request.exposures_s.empty()) return request.exposures_s[at];
  if (const auto exposure = readMetadataOf(file, bytes).exposure) return toSeconds(*exposure);
  throw WorkflowError(Exit::kUsage, file.string() +
                                        " does not say how long it was exposed: give all exposures "
                                        "in order, --times 1/100,1/50,1/25");
}

// The highest code says only that there was more; what a response makes of it is the highest light.
Image<std::uint8_t> clippedIn(const Image<float>& light, float highest) {
  Image<std::uint8_t> marks(light.width(), light.height(), light.channels());
  for (std::size_t k = 0; k < marks.texels().size(); ++k)
    if (light.texels()[k] >= highest) marks.texels()[k] = calibration::kSaturated;
  return marks;
}

void add(SensorPicture picture, float highest, Brackets& brackets) {
  if (!brackets.lights.empty() && brackets.raw.has_value() != picture.raw.has_value())
    throw WorkflowError(Exit::kBadData, "raw files and others lie in one folder: merge each alone");
  if (!picture.raw) {
    brackets.marks.push_back(clippedIn(picture.linear, highest));
    brackets.lights.push_back(std::move(picture.linear));
    return;
  }
  const RawMosaic& raw = *picture.raw;
  const SizePx size = raw.samples.size();
  brackets.lights.emplace_back(size.width, size.height, 1);
  brackets.marks.emplace_back(size.width, size.height, 1);
  calibration::toRadiance(raw, calibration::prepareCorrection(size, 1, raw.cfa, {}, {}, {}),
                          {1, 1, 1}, brackets.lights.back().view(), brackets.marks.back().view());
  if (!brackets.raw) brackets.raw = std::move(picture.raw);
}

Brackets readBrackets(const HdrRequest& request, Progress& progress) {
  const std::vector<fs::path> files = picturesIn(request.folder);
  if (files.size() < 2)
    throw WorkflowError(Exit::kUsage, "one exposure has no more range than it has: two at least");
  if (!request.exposures_s.empty() && request.exposures_s.size() != files.size())
    throw WorkflowError(Exit::kUsage, "--times names " +
                                          std::to_string(request.exposures_s.size()) +
                                          " exposures, but there are " +
                                          std::to_string(files.size()) + " pictures");
  std::optional<calibration::ResponseCurve> curve;
  if (!request.response.empty()) curve = readResponse(request.response);
  float highest = 1;
  if (curve)
    for (const auto& channel : curve->light)
      highest = std::min(highest, *std::ranges::max_element(channel));
  Brackets brackets;
  for (std::size_t k = 0; k < files.size(); ++k) {
    progress.step(static_cast<double>(k) / static_cast<double>(files.size()));
    const Bytes file = readFile(files[k]);
    brackets.exposures_s.push_back(exposureOf(request, files[k], file, k));
    SensorPicture picture = decodeSensorPicture(file, curve ? &*curve : nullptr);
    brackets.bits = picture.bits;
    add(std::move(picture), highest, brackets);
  }
  return brackets;
}

}  // namespace

HdrOutcome mergeFolder(const HdrRequest& request, Progress& progress) {
  const Brackets brackets = readBrackets(request, progress);
  std::vector<calibration::Exposed> exposed;
  for (std::size_t k = 0; k < brackets.lights.size(); ++k)
    exposed.push_back(
        {brackets.lights[k].view(), brackets.marks[k].view(), brackets.exposures_s[k]});
  calibration::NoiseModels photons;
  photons.fill({.white_level = static_cast<double>((1 << std::min(brackets.bits, 16)) - 1)});
  const calibration::ColourFilters filters =
      brackets.raw ? brackets.raw->cfa : calibration::kOneColour;
  calibration::Merged merged = calibration::mergeExposures(exposed, filters, photons);
  HdrOutcome out;
  const auto [shortest, longest] = std::ranges::minmax_element(brackets.exposures_s);
  out.exposures = static_cast<int>(exposed.size());
  out.shortest_s = *shortest, out.longest_s = *longest;
  out.saturated = merged.saturated;
  out.disagreement = merged.disagreement;
  for (std::size_t k = 0; k < merged.light.texels().size(); ++k) {
    float& light = merged.light.texels()[k];
    light *= static_cast<float>(*shortest);
    if ((merged.marks.texels()[k] & calibration::kSaturated) != 0) light = std::max(light, 1.0f);
  }
  out.light = brackets.raw ? demosaicLinear(std::as_const(merged.light).view(), filters)
                           : std::move(merged.light);
  return out;
}

}  // namespace patina::workflow
