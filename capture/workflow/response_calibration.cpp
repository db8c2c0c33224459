// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/response_calibration.h"

#include "capture/workflow/failure.h"
#include "capture/workflow/import_listing.h"
#include "capture/workflow/master_pictures.h"
#include "processing/image/encoding.h"
#include "processing/image/picture_file.h"
#include "processing/image/sidecar_file.h"

namespace patina::workflow {

using calibration::kCodes;

void writeResponse(const std::filesystem::path& file, const calibration::ResponseCurve& curve) {
  Image<float> image(kCodes, 1, 3);
  for (int code = 0; code < kCodes; ++code)
    for (int c = 0; c < 3; ++c)
      image.at(code, 0, c) =
          curve.light[static_cast<std::size_t>(c)][static_cast<std::size_t>(code)];
  writeExr(file, image.view());
}

calibration::ResponseCurve readResponse(const std::filesystem::path& file) {
  const Image<float> image = readPicture(file).linear;
  if (image.width() != kCodes || image.height() != 1 || image.channels() != 3)
    throw WorkflowError(Exit::kBadData, file.string() + " is no response curve of 256 codes");
  calibration::ResponseCurve curve;
  for (int code = 0; code < kCodes; ++code)
    for (int c = 0; c < 3; ++c)
      curve.light[static_cast<std::size_t>(c)][static_cast<std::size_t>(code)] =
          image.at(code, 0, c);
  return curve;
}

namespace {

namespace fs = std::filesystem;

std::vector<calibration::Bracket> readBrackets(const ResponseRequest& request,
                                               std::vector<std::string>& sha256s) {
  const std::vector<fs::path> files = picturesIn(request.folder);
  if (!request.exposures_s.empty() && request.exposures_s.size() != files.size())
    throw WorkflowError(Exit::kUsage, "--times names " +
                                          std::to_string(request.exposures_s.size()) +
                                          " exposures, but there are " +
                                          std::to_string(files.size()) + " pictures");
  std::vector<calibration::Bracket> brackets;
  for (std::size_t i = 0; i < files.size(); ++i) {
    const Bytes file = readFile(files[i]);
    sha256s.push_back(sha256(file).hex());
    const std::optional<Nanoseconds> exposure = readMetadataOf(files[i], file).exposure;
    if (request.exposures_s.empty() && !exposure)
      throw WorkflowError(Exit::kUsage, files[i].string() +
                                            " does not say how long it was exposed: give all "
                                            "exposures in order, --times 1/100,1/50,1/25");
    const Picture picture = decodePicture(file);
    const bool raw = picture.format == PictureFormat::kDng || picture.format == PictureFormat::kRaw;
    if (raw || picture.bits != 8)
      throw WorkflowError(Exit::kBadData, files[i].string() +
                                              " is not of 8 bits: raw files are linear already and "
                                              "need no response");
    brackets.push_back({encodeSrgb8(picture.linear.view()), request.exposures_s.empty()
                                                                ? toSeconds(*exposure)
                                                                : request.exposures_s[i]});
  }
  return brackets;
}

}  // namespace

ResponseOutcome makeResponse(const fs::path& archive, const ResponseRequest& request, UtcTime now,
                             Progress& progress) {
  std::vector<std::string> sha256s;
  ResponseOutcome outcome;
  const std::vector<calibration::Bracket> brackets = readBrackets(request, sha256s);
  outcome.response = calibration::measureResponse(brackets, request.options, progress);
  if (archive.empty()) return outcome;
  if (request.camera.empty())
    throw WorkflowError(Exit::kUsage, "of which camera are these? Give --camera ID");
  NewCalibration calibration;
  calibration.row.kind = "response";
  calibration.row.device_id = request.camera;
  calibration.row.size = brackets[0].codes.size();
  calibration.row.utc = now;
  const calibration::ResponseReport& report = outcome.response.report;
  calibration.values.count("bits", 8)
      .count("exposures", report.exposures)
      .number("residual", report.residual);
  calibration.file_name = "response.exr";
  calibration.write = [&](const fs::path& file) { writeResponse(file, outcome.response.curve); };
  Facts options;
  options.text("camera", request.camera);
  calibration.making = {request.command, options, 0, request.version, std::move(sha256s)};
  outcome.kept = keepCalibration(archive, std::move(calibration), now);
  return outcome;
}

}  // namespace patina::workflow
