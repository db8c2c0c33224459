// SPDX-License-Identifier: GPL-3.0-or-later
// patina calibrate colour: a picture of a ColorChecker becomes what the camera's numbers mean.
#include <cstdio>

#include "capture/app/context.h"
#include "capture/app/verbs/calibrate_verbs.h"
#include "capture/workflow/colour_calibration.h"
#include "capture/workflow/colour_picture.h"
#include "processing/image/picture_file.h"

namespace patina::app {
namespace {

struct Options {
  workflow::ColourRequest request;
  std::string source, out, picture, reference;
};

calibration::ChartCorners parseCorners(const std::string& text) {
  calibration::ChartCorners c;
  char rest = 0;
  if (std::sscanf(text.c_str(), "%lf,%lf,%lf,%lf,%lf,%lf,%lf,%lf%c", &c[0].x, &c[0].y, &c[1].x,
                  &c[1].y, &c[2].x, &c[2].y, &c[3].x, &c[3].y, &rest) != 8)
    throw AppError(Exit::kUsage,
                   "'" + text +
                       "' are no four corners: X,Y,X,Y,X,Y,X,Y, the middles of dark skin, "
                       "bluish green, black and white in pixels");
  return c;
}

calibration::ChartEdition parseEdition(const std::string& text) {
  if (text == "2014") return calibration::ChartEdition::kSince2014;
  if (text == "classic") return calibration::ChartEdition::kBefore2014;
  throw AppError(Exit::kUsage, "'" + text +
                                   "' is no edition: 2014 (made since November 2014) or "
                                   "classic (before)");
}

std::optional<calibration::FitKind> parseFit(const std::string& text) {
  if (text == "auto") return std::nullopt;
  if (const auto kind = calibration::fitNamed(text)) return kind;
  throw AppError(Exit::kUsage, "'" + text + "' is no fit: auto, 3x3, 4x3, root2 or root3");
}

std::vector<std::string> described(const std::vector<calibration::KindError>& kinds) {
  std::vector<std::string> out;
  for (const calibration::KindError& kind : kinds) {
    char text[80];
    std::snprintf(text, sizeof text, "%s %.2f (left out %.2f)", nameOf(kind.kind).c_str(),
                  kind.mean, kind.left_out_mean);
    out.emplace_back(text);
  }
  return out;
}

std::string inPixels(const calibration::ChartCorners& corners) {
  std::string text;
  for (const calibration::PlacePx& place : corners) {
    char one[64];
    std::snprintf(one, sizeof one, "%s%.1f,%.1f", text.empty() ? "" : ",", place.x, place.y);
    text += one;
  }
  return text;
}

Item itemOf(const workflow::ColourCalibration& made) {
  const calibration::ColourFitReport& report = made.report;
  const calibration::ChartVerdict& chart = made.verdict;
  Item item;
  item.set("fit", nameOf(made.model.kind).c_str())
      .set("delta_e_before", Value{report.mean_before})
      .set("delta_e_after", Value{report.mean_after})
      .set("delta_e_median", Value{report.median_after})
      .set("delta_e_worst", Value{report.worst_after})
      .set("worst_field", calibration::fieldName(report.worst_field).c_str())
      .set("delta_e_left_out", Value{report.left_out_mean})
      .set("kinds", Value{described(report.kinds)})
      .set("chart", made.chart.c_str())
      .set("corners_px", inPixels(made.corners).c_str())
      .set("turned", Value{chart.sense == calibration::ChartSense::kTurned})
      .set("gradient", Value{chart.gradient})
      .set("tilt_deg", Value{chart.tilt_deg})
      .set("unevenness", Value{chart.unevenness})
      .set("gamma", Value{chart.gamma})
      .set("veil", Value{chart.veil});
  if (made.exposure.count() > 0) item.set("exposure_ns", made.exposure);
  if (made.iso > 0) item.set("iso", Value{made.iso});
  return item;
}

void calibrate(Context& context, Options& options) {
  workflow::ColourRequest& request = options.request;
  const bool kept = !context.options.archive.empty();
  request.reference = options.reference;
  request.selection.camera = request.camera;
  request.selection.light = request.light;
  request.command = "patina calibrate colour";
  request.version = PATINA_VERSION;
  if (std::filesystem::is_regular_file(options.source))
    request.picture = options.source;
  else if (kept)
    request.run = options.source;
  else
    throw AppError(Exit::kUsage, "there is no picture " + options.source +
                                     "; if it is a run, give --archive DIR too");
  if (kept && request.run.empty() && (request.camera.empty() || request.light.empty()))
    throw AppError(Exit::kUsage,
                   "to keep it in the archive, say of which camera and under which light the chart "
                   "is: --camera ID --light STATE");
  const workflow::ColourOutcome outcome = workflow::calibrateColour(
      context.options.archive, request, context.clock.utc(), context.progress);
  for (const std::string& note : outcome.notes) context.warn(note);
  Item item = itemOf(outcome.calibration);
  if (kept) {
    const workflow::KeptCalibration row =
        workflow::keepColour(context.archive(), request, outcome, context.clock.utc());
    item.set("id", std::int64_t{row.row.id})
        .set("device_id", row.row.device_id.c_str())
        .set("light_state", row.row.light_state.c_str())
        .set("sha256", row.row.sha256.c_str())
        .set("path", row.path.c_str());
  }
  if (!options.out.empty()) workflow::writeColourCalibration(options.out, outcome.calibration);
  if (!options.picture.empty())
    writePng(options.picture, workflow::drawColours(outcome.calibration).view());
  context.out.asList();
  context.out.add(std::move(item));
}

}  // namespace

void addCalibrateColour(Verb& group) {
  auto o = std::make_shared<Options>();
  workflow::ColourRequest& r = o->request;
  group
      .verb("colour",
            "A picture of a ColorChecker: what the camera's numbers mean in colour. Exit 65 when "
            "the chart is wet, tilted, shaded or not found",
            "patina calibrate colour chart.dng --camera cam0 --light key --archive ivy --picture "
            "chart.png",
            [o](Context& context) { calibrate(context, *o); })
      .required("SOURCE", o->source, "A picture, best a raw one, or a run whose frames show it")
      .option("--corners", r.corners, parseCorners, "X,Y,X,Y,X,Y,X,Y",
              "Middles of dark skin, bluish green, black and white (default: found by itself)")
      .option("--chart", r.edition, parseEdition, "EDITION",
              "2014: made since November 2014 (the default); classic: before")
      .option("--reference", o->reference, "FILE",
              "The chart's own measured values: 24 lines L a b, under D50")
      .option("--fit", r.fit.kind, parseFit, "KIND", "auto (the default), 3x3, 4x3, root2 or root3")
      .flag("--preserve-white", r.fit.preserve_white, "White comes out exactly")
      .option("--tilt", r.check.tilt_max_deg, 0, 90, "Degrees the chart may lie to the picture")
      .option("--camera", r.camera, "ID", "The camera it was taken with")
      .option("--light", r.light, "STATE", "The lamps it was lit by: key+fill")
      .take(
          "--exposure", "N",
          [o](const std::string& text) { o->request.selection.exposure = std::stoi(text); },
          "Of a run with several exposures: 0 is the first")
      .option("--exposure-time", r.exposure, parseExposure, "TIME",
              "Instead of what the picture says: 1/50")
      .take(
          "--iso", "X", [o](const std::string& text) { o->request.iso = std::stod(text); },
          "Instead of what the picture says")
      .option("--out", o->out, "FILE.json", "Also write it there")
      .option("--picture", o->picture, "FILE.png", "Draw the fields before, after and as they are");
}

}  // namespace patina::app
