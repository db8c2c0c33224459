// SPDX-License-Identifier: GPL-3.0-or-later
// patina calibrate response | hdr: which light each code of an 8-bit camera stands for; brackets
// merged.
#include <sstream>

#include "capture/app/context.h"
#include "capture/app/verbs/calibrate_verbs.h"
#include "capture/workflow/hdr_folder.h"
#include "capture/workflow/response_calibration.h"
#include "processing/image/picture_file.h"

namespace patina::app {
namespace {

struct Options {
  workflow::ResponseRequest request;
  std::string folder, method = "robertson";
};

std::vector<double> parseTimes(const std::string& text) {
  std::vector<double> times_s;
  std::istringstream parts(text);
  for (std::string part; std::getline(parts, part, ',');)
    times_s.push_back(part == "0" ? 0 : toSeconds(parseExposure(part)));
  return times_s;
}

void measure(Context& context, Options& options) {
  workflow::ResponseRequest& request = options.request;
  request.folder = options.folder;
  if (options.method == "debevec")
    request.options.method = calibration::ResponseMethod::kDebevecMalik;
  else if (options.method != "robertson")
    throw AppError(Exit::kUsage, "--method is robertson or debevec, not " + options.method);
  request.command = "patina calibrate response";
  request.version = PATINA_VERSION;
  const workflow::ResponseOutcome outcome = workflow::makeResponse(
      context.options.archive, request, context.clock.utc(), context.progress);
  if (!outcome.kept) context.warn("not kept: give --archive DIR to keep it");
  const calibration::ResponseReport& report = outcome.response.report;
  context.out.asList();
  Item item;
  if (outcome.kept)
    item.set("id", std::int64_t{outcome.kept->row.id}).set("path", outcome.kept->path.c_str());
  std::vector<std::string> curve;
  for (const float light : outcome.response.curve.light[1]) curve.push_back(std::to_string(light));
  item.set("exposures", report.exposures)
      .set("ratio", Value{report.ratio})
      .set("residual", Value{report.residual})
      .set("codes_seen", report.codes_seen[0])
      .set("block_sums", report.block_sums)
      .set("fall_mended", Value{report.fall_mended})
      .hidden("green", Value{curve});
  context.out.add(std::move(item));
}

struct HdrOptions {
  workflow::HdrRequest request;
  std::string folder, response, out;
};

void merge(Context& context, HdrOptions& options) {
  workflow::HdrRequest& request = options.request;
  request.folder = options.folder;
  request.response = options.response;
  const workflow::HdrOutcome outcome = workflow::mergeFolder(request, context.progress);
  writeExr(options.out, outcome.light.view());
  context.out.asList();
  context.out.add(std::move(Item()
                                .set("path", options.out.c_str())
                                .set("exposures", outcome.exposures)
                                .set("shortest_s", Value{outcome.shortest_s})
                                .set("longest_s", Value{outcome.longest_s})
                                .set("saturated_samples", outcome.saturated)
                                .set("disagreement", Value{outcome.disagreement})));
}

void addHdr(Verb& group) {
  auto o = std::make_shared<HdrOptions>();
  group
      .verb("hdr", "Brackets of a still scene to one linear picture of more range",
            "patina calibrate hdr brackets/ scene.exr",
            [o](Context& context) { merge(context, *o); })
      .required("FOLDER", o->folder, "Raw files or pictures that differ in exposure alone")
      .required("OUT", o->out, "The picture to write: .exr; 1 is full scale of the shortest")
      .option("--times", o->request.exposures_s, parseTimes, "LIST",
              "Their exposures in order of name (default: as their EXIF data say)")
      .option("--response", o->response, "FILE.exr",
              "Of an 8-bit camera, by calibrate response (default: sRGB)");
}

}  // namespace

void addCalibrateResponse(Verb& group) {
  auto o = std::make_shared<Options>();
  group
      .verb("response", "The response curve of an 8-bit camera from brackets of a still scene",
            "patina calibrate response brackets/ --times 1/200,1/100,1/50,1/25 --camera cam0 "
            "--archive ivy",
            [o](Context& context) { measure(context, *o); })
      .required("FOLDER", o->folder, "Pictures that differ in exposure alone")
      .option("--times", o->request.exposures_s, parseTimes, "LIST",
              "Their exposures in order of name (default: as their EXIF data say); 0: lens covered")
      .option("--method", o->method, "NAME", "robertson (the default) or debevec")
      .option("--block", o->request.options.block_px, 0, 64,
              "Side in pixels of the even blocks that refine it; 0: not at all")
      .option("--camera", o->request.camera, "ID", "The camera they were taken with");
  addHdr(group);
}

}  // namespace patina::app
