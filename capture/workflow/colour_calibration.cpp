// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/colour_calibration.h"

#include "calibration/colour/chart_refine.h"
#include "capture/workflow/failure.h"
#include "processing/image/metadata_file.h"

namespace patina::workflow {
namespace {

namespace fs = std::filesystem;
using calibration::ChartColours;
using calibration::ChartCorners;

constexpr std::int64_t kRunFramesMax = 16;

Image<float> openPicture(const ColourRequest& request, UtcTime now, ColourOutcome& outcome) {
  ColourCalibration& calibration = outcome.calibration;
  const Bytes file = readFile(request.picture);
  Picture picture = decodePicture(file);
  if (picture.format == PictureFormat::kJpeg || picture.format == PictureFormat::kPng)
    outcome.notes.emplace_back(
        "the picture was made for the eye; the colours of a raw file are surer");
  const PictureMetadata about = readMetadata(file);
  calibration.camera = request.camera;
  calibration.light = request.light;
  calibration.exposure = about.exposure.value_or(Nanoseconds{});
  calibration.iso = about.iso ? about.iso->value : 0;
  calibration.taken_utc = about.taken_utc.value_or(now);
  outcome.input_sha256s.push_back(sha256OfFile(request.picture).hex());
  return std::move(picture.linear);
}

// The mean of its first frames.
Image<float> openRun(const fs::path& archive, const ColourRequest& request,
                     ColourOutcome& outcome) {
  const db::ArchiveReader reader(archive);
  const std::string run = reader.findRun(request.run).id;
  ArchiveFrames frames(reader, run, request.selection, request.correction);
  if (frames.report().sizes > 1)
    throw WorkflowError(Exit::kBadData, "the frames of " + run + " differ in size");
  Image<float> sum;
  std::int64_t count = 0;
  for (; count < kRunFramesMax; ++count) {
    auto frame = frames.next();
    if (!frame) break;
    if (sum.empty())
      sum = std::move(frame->linear);
    else
      for (std::size_t i = 0; i < sum.texels().size(); ++i)
        sum.texels()[i] += frame->linear.texels()[i];
  }
  for (float& v : sum.texels()) v /= static_cast<float>(count);
  ColourCalibration& calibration = outcome.calibration;
  calibration.camera = frames.report().camera;
  calibration.light = frames.report().light;
  calibration.exposure = frames.report().exposure_time;
  reader.eachFrame(run, [&](const db::ArchiveReader::CapturedFrame& one) {
    if (one.shot.device_id != calibration.camera) return;
    calibration.iso = one.shot.iso;
    calibration.taken_utc = one.frame.utc;
  });
  outcome.input_sha256s = frames.report().input_sha256s;
  return sum;
}

ChartColours expectedOf(const ColourRequest& request, ColourOutcome& outcome) {
  if (request.reference.empty()) {
    outcome.calibration.chart =
        request.edition == calibration::ChartEdition::kSince2014 ? "2014" : "classic";
    return calibration::chartColours(request.edition);
  }
  constexpr std::uint64_t kBytesMax = 65536;
  const Bytes bytes = readFile(request.reference, kBytesMax);
  outcome.calibration.chart = request.reference.filename().string();
  outcome.input_sha256s.push_back(sha256OfFile(request.reference).hex());
  return calibration::parseChartColours(
      std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
}

ChartCorners placeChart(const Image<float>& linear, const ColourRequest& request,
                        Progress& progress) {
  std::optional<ChartCorners> corners = request.corners;
  if (!corners) corners = calibration::findChart(linear.view(), {}, progress);
  if (!corners)
    throw WorkflowError(Exit::kBadData,
                        "no chart of 24 fields was found: is it wholly in the frame, sharp, and "
                        "wider than a tenth of it? Else give the middles of its corner fields, "
                        "--corners X,Y,X,Y,X,Y,X,Y");
  return calibration::refineCorners(linear.view(), *corners);
}

[[noreturn]] void refuse(const std::vector<std::string>& reasons) {
  std::string all = "the chart is refused: ";
  for (std::size_t i = 0; i < reasons.size(); ++i) {
    if (i > 0) all += "; ";
    all += reasons[i];
  }
  throw WorkflowError(Exit::kBadData, all);
}

Facts valuesOf(const ColourCalibration& calibration) {
  const calibration::ColourFitReport& report = calibration.report;
  Facts values;
  values.text("fit", nameOf(calibration.model.kind)).text("chart", calibration.chart);
  values.number("delta_e_before", report.mean_before);
  values.number("delta_e_after", report.mean_after);
  values.number("delta_e_worst", report.worst_after);
  values.text("worst_field", calibration::fieldName(report.worst_field));
  values.number("delta_e_left_out", report.left_out_mean);
  return values.number("gradient", calibration.verdict.gradient);
}

}  // namespace

ColourOutcome calibrateColour(const fs::path& archive, const ColourRequest& request, UtcTime now,
                              Progress& progress) {
  ColourOutcome outcome;
  ColourCalibration& calibration = outcome.calibration;
  const Image<float> linear =
      request.run.empty() ? openPicture(request, now, outcome) : openRun(archive, request, outcome);
  if (linear.channels() != 3)
    throw WorkflowError(Exit::kBadData, "the picture has no colours: a chart needs three channels");
  calibration.size = linear.size();
  if (request.exposure) calibration.exposure = *request.exposure;
  if (request.iso) calibration.iso = *request.iso;
  const ChartColours expected = expectedOf(request, outcome);
  const ChartCorners corners = placeChart(linear, request, progress);
  const calibration::CheckedChart chart = calibration::checkChart(
      calibration::sampleChart(linear.view(), corners, {}), expected, request.check);
  if (!chart.verdict.refusals.empty()) refuse(chart.verdict.refusals);
  calibration::ColourFit fit = calibration::fitColour(chart.seen, expected, request.fit, progress);
  if (const std::string why = fitRefusal(fit.report, request.check); !why.empty()) refuse({why});
  if (fit.model.kind == calibration::FitKind::k4x3)
    outcome.notes.emplace_back(
        "a 4x3 fit has an offset and serves frames of this exposure only; --fit root2 serves all");
  calibration.corners = chart.samples.corners;
  calibration.verdict = chart.verdict;
  calibration.seen = chart.seen;
  calibration.model = std::move(fit.model);
  calibration.report = fit.report;
  return outcome;
}

KeptCalibration keepColour(const fs::path& archive, const ColourRequest& request,
                           const ColourOutcome& outcome, UtcTime now) {
  const ColourCalibration& made = outcome.calibration;
  if (made.camera.empty() || made.light.empty())
    throw WorkflowError(Exit::kUsage,
                        "of which camera and under which light is the chart? Give --camera ID and "
                        "--light STATE");
  NewCalibration calibration;
  calibration.row.kind = "colour";
  calibration.row.device_id = made.camera;
  calibration.row.exposure = made.exposure;
  calibration.row.iso = made.iso;
  calibration.row.size = made.size;
  calibration.row.light_state = made.light;
  calibration.row.utc = made.taken_utc;
  calibration.values = valuesOf(made);
  calibration.file_name = "colour.json";
  calibration.write = [&](const fs::path& file) { writeColourCalibration(file, made); };
  if (!request.run.empty()) calibration.run_id = db::ArchiveReader(archive).findRun(request.run).id;
  Facts options;
  options.text("camera", made.camera).text("light", made.light).text("chart", made.chart);
  options.text("fit", request.fit.kind ? nameOf(*request.fit.kind) : "auto");
  options.set("preserve_white", request.fit.preserve_white);
  calibration.making = {request.command, options, 0, request.version, outcome.input_sha256s};
  return keepCalibration(archive, std::move(calibration), now);
}

}  // namespace patina::workflow
