// SPDX-License-Identifier: GPL-3.0-or-later
// patina calibrate vignetting: how a lens darkens towards the corners.
#include "capture/app/context.h"
#include "capture/app/verbs/board_options.h"
#include "capture/app/verbs/calibrate_verbs.h"
#include "capture/workflow/vignetting_calibration.h"
#include "processing/image/picture_file.h"

namespace patina::app {
namespace {

struct Options {
  BoardOptions board;
  workflow::VignettingRequest request;
  std::string first, camera, out;
  std::vector<std::string> more;
};

void calibrate(Context& context, Options& o) {
  workflow::VignettingRequest& request = o.request;
  request.sources = {o.first};
  request.sources.insert(request.sources.end(), o.more.begin(), o.more.end());
  request.board = boardOf(o.board, 1);
  request.command = "patina calibrate vignetting";
  request.version = PATINA_VERSION;
  if (!o.camera.empty()) context.archive();
  const workflow::VignettingCalibration made =
      makeVignetting(request, context.clock.utc(), context.progress);
  const calibration::VignettingReport& report = made.fit.report;
  Item item;
  item.set("width_px", made.size.width)
      .set("height_px", made.size.height)
      .set("a1", Value{made.fit.vignetting.a1})
      .set("a2", Value{made.fit.vignetting.a2})
      .set("a3", Value{made.fit.vignetting.a3})
      .set("corner", Value{report.corner})
      .set("rms", Value{report.rms})
      .set("slope", Value{report.slope})
      .set("radius_covered", Value{report.radius_covered})
      .set("samples", report.samples)
      .set("left_out", report.left_out)
      .set("pictures", made.pictures);
  if (!o.out.empty()) {
    writeFileAtomically(o.out, factsOf(made).json() + "\n");
    item.set("out", o.out.c_str());
  }
  if (!o.camera.empty()) {
    const workflow::KeptCalibration kept =
        keepVignetting(context.archive(), made, request, o.camera, context.clock.utc());
    item.set("id", std::int64_t{kept.row.id})
        .set("device_id", o.camera.c_str())
        .set("sha256", kept.row.sha256.c_str())
        .set("path", kept.path.c_str());
  }
  context.out.asList();
  context.out.add(std::move(item));
}

}  // namespace

void addCalibrateVignetting(Verb& group) {
  auto o = std::make_shared<Options>();
  Verb verb = group.verb("vignetting", "How a lens darkens towards the corners, for want of a flat",
                         "patina calibrate vignetting flats/ --camera cam0 --archive ivy",
                         [o](Context& context) { calibrate(context, *o); });
  verb.required("PICTURES", o->first,
                "Of an even surface; with --board, of a board from several places")
      .list("MORE", o->more, "The same");
  addBoardOptions(verb, o->board);
  verb.option("--terms", o->request.options.terms, 1, 3, "Even powers of the radius: r2, r4, r6")
      .option("--out", o->out, "FILE.json", "Also write it there")
      .option("--camera", o->camera, "ID", "Keep it in the archive, as this camera's");
}

}  // namespace patina::app
