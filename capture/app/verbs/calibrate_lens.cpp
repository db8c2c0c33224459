// SPDX-License-Identifier: GPL-3.0-or-later
// patina calibrate lens: a camera's lens from pictures of a board.
#include <cmath>
#include <cstdio>

#include "capture/app/context.h"
#include "capture/app/verbs/board_options.h"
#include "capture/app/verbs/calibrate_verbs.h"
#include "capture/workflow/lens_calibration.h"
#include "processing/image/picture_file.h"

namespace patina::app {
namespace {

struct Options {
  BoardOptions board;
  workflow::LensRequest request;
  std::string first, camera, out;
  std::vector<std::string> more;
  bool no_tangential = false;
};

// "532.84 (sd 0.61)"
std::string withSd(double value, double sd) {
  char text[64];
  std::snprintf(text, sizeof text, "%.5g (sd %.2g)", value, sd);
  return text;
}

std::vector<std::string> viewTexts(const workflow::LensCalibration& made) {
  std::vector<std::string> texts;
  std::size_t view = 0;
  for (const workflow::BoardPicture& picture : made.pictures.pictures) {
    if (!picture.sight) continue;
    char text[160];
    std::snprintf(text, sizeof text, "%s %.2f px", picture.name.c_str(),
                  made.fit.report.views[view++].rms_px);
    texts.emplace_back(text);
  }
  return texts;
}

Item lensItem(const workflow::LensCalibration& made) {
  const calibration::Lens& lens = made.fit.lens;
  const calibration::LensReport& report = made.fit.report;
  Item item;
  item.set("width_px", lens.size.width).set("height_px", lens.size.height);
  const std::tuple<const char*, double, double> numbers[] = {
      {"fx", lens.fx, report.sd.fx}, {"fy", lens.fy, report.sd.fy}, {"cx", lens.cx, report.sd.cx},
      {"cy", lens.cy, report.sd.cy}, {"k1", lens.k1, report.sd.k1}, {"k2", lens.k2, report.sd.k2},
      {"p1", lens.p1, report.sd.p1}, {"p2", lens.p2, report.sd.p2}, {"k3", lens.k3, report.sd.k3}};
  for (const auto& [name, value, sd] : numbers) {
    item.set(name, Value{value}, withSd(value, sd));
    item.hidden(std::string(name) + "_sd", Value{sd});
  }
  item.set("rms_px", Value{report.rms_px})
      .set("corners", report.corners)
      .set("pictures", made.pictures.pictures.size())
      .set("views", Value{viewTexts(made)})
      .set("left_out", Value{made.left_out})
      .set("covered", Value{report.covered})
      .set("covered_radius", Value{report.covered_radius})
      .set("turn_deg", Value{report.turn_deg});
  return item;
}

// One object a picture, for programs: what people read in a line.
void addViews(Context& context, const workflow::LensCalibration& made) {
  std::size_t view = 0;
  for (const workflow::BoardPicture& picture : made.pictures.pictures) {
    Item item;
    item.set("view", picture.name.c_str()).set("found", Value{picture.sight.has_value()});
    if (picture.sight) {
      const calibration::LensView& fit = made.fit.report.views[view++];
      item.set("rms_px", Value{fit.rms_px})
          .set("corners", picture.sight->seen_px.size())
          .set("tilt_deg", Value{fit.tilt_deg})
          .set("distance_mm", Value{fit.distance_mm});
    }
    context.out.add(std::move(item));
  }
}

void calibrate(Context& context, Options& o) {
  workflow::LensRequest& request = o.request;
  const auto board = boardOf(o.board, 1);
  if (!board) throw AppError(Exit::kUsage, "which board? Give --board 9x6 or --charuco 7x5");
  request.board = *board;
  request.sources = {o.first};
  request.sources.insert(request.sources.end(), o.more.begin(), o.more.end());
  request.options.tangential = !o.no_tangential;
  request.command = "patina calibrate lens";
  request.version = PATINA_VERSION;
  if (!o.camera.empty()) context.archive();  // before minutes of work
  const workflow::LensCalibration made = makeLens(request, context.clock.utc(), context.progress);
  for (const std::string& name : made.left_out)
    context.warn("left out, the board is not seen in it: " + name);
  if (made.fit.report.covered_radius < 0.8)
    context.warn("no corner lies beyond " +
                 std::to_string(std::lround(100 * made.fit.report.covered_radius)) +
                 " % of the way to the picture's corners: what the lens does there is a guess");
  Item item = lensItem(made);
  if (!o.out.empty()) {
    writeFileAtomically(o.out, factsOf(made, request).json() + "\n");
    item.set("out", o.out.c_str());
  }
  if (!o.camera.empty()) {
    const workflow::KeptCalibration kept =
        keepLens(context.archive(), made, request, o.camera, context.clock.utc());
    item.set("id", std::int64_t{kept.row.id})
        .set("device_id", o.camera.c_str())
        .set("sha256", kept.row.sha256.c_str())
        .set("path", kept.path.c_str());
  }
  context.out.asList();
  context.out.add(std::move(item));
  if (context.options.json) addViews(context, made);
}

}  // namespace

void addCalibrateLens(Verb& group) {
  auto o = std::make_shared<Options>();
  Verb verb = group.verb("lens", "Focal length and distortion from pictures of a board",
                         "patina calibrate lens 'left*.jpg' --board 9x6 --square 25mm",
                         [o](Context& context) { calibrate(context, *o); });
  verb.required("PICTURES", o->first, "Files, a folder, or a pattern in quotes")
      .list("MORE", o->more, "The same");
  addBoardOptions(verb, o->board);
  verb.option("--radial", o->request.options.radial_terms, 0, 3, "Radial terms: k1, k2, k3")
      .flag("--no-tangential", o->no_tangential, "Without p1 and p2")
      .flag("--square-pixels", o->request.options.square_pixels, "fx = fy")
      .option("--out", o->out, "FILE.json", "Also write the lens there")
      .option("--camera", o->camera, "ID", "Keep it in the archive, as this camera's");
}

}  // namespace patina::app
