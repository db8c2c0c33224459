// SPDX-License-Identifier: GPL-3.0-or-later
// patina calibrate view: where a camera stands over the specimen's plane.
#include "capture/app/context.h"
#include "capture/app/verbs/board_options.h"
#include "capture/app/verbs/calibrate_verbs.h"
#include "capture/workflow/view_calibration.h"
#include "processing/image/picture_file.h"

namespace patina::app {
namespace {

struct Options {
  BoardOptions board;
  workflow::ViewRequest request;
  std::string picture, lens, fiducials, camera, out;
};

void calibrate(Context& context, Options& o) {
  workflow::ViewRequest& request = o.request;
  request.picture = o.picture;
  request.lens = o.lens;
  request.fiducials = o.fiducials;
  request.camera = o.camera;
  request.board = boardOf(o.board, 0);
  request.marker_mm = o.board.marker_mm;
  request.command = "patina calibrate view";
  request.version = PATINA_VERSION;
  const std::filesystem::path archive = o.camera.empty() ? "" : context.archive();
  const workflow::ViewCalibration made =
      makeView(archive, request, context.clock.utc(), context.progress);
  const calibration::ViewReport& report = made.fit.report;
  Item item;
  item.set("camera_x_mm", Value{report.camera_mm.x})
      .set("camera_y_mm", Value{report.camera_mm.y})
      .set("camera_z_mm", Value{report.camera_mm.z})
      .set("tilt_deg", Value{report.tilt_deg})
      .set("mm_per_px", Value{report.mm_per_px})
      .set("rms_px", Value{report.rms_px})
      .set("worst_px", Value{report.worst_px})
      .set("points", report.points)
      .set("seen_left_mm", Value{made.seen.left})
      .set("seen_bottom_mm", Value{made.seen.bottom})
      .set("seen_width_mm", Value{made.seen.width})
      .set("seen_height_mm", Value{made.seen.height})
      .set("texels_per_mm", Value{made.texels_per_mm})
      .set("lens", made.lens_from.c_str());
  if (!o.out.empty()) {
    writeFileAtomically(o.out, factsOf(made, request).json() + "\n");
    item.set("out", o.out.c_str());
  }
  if (!o.camera.empty()) {
    const workflow::KeptCalibration kept = keepView(archive, made, request, context.clock.utc());
    item.set("id", std::int64_t{kept.row.id})
        .set("device_id", o.camera.c_str())
        .set("sha256", kept.row.sha256.c_str())
        .set("path", kept.path.c_str());
  }
  context.out.asList();
  context.out.add(std::move(item));
}

}  // namespace

void addCalibrateView(Verb& group) {
  auto o = std::make_shared<Options>();
  Verb verb = group.verb("view", "Where a camera stands, by a board or markers on the specimen",
                         "patina calibrate view board.dng --board 9x6 --square 5mm --camera cam0",
                         [o](Context& context) { calibrate(context, *o); });
  verb.required("PICTURE", o->picture, "One picture of the board lying where the specimen will");
  addBoardOptions(verb, o->board);
  verb.option("--fiducials", o->fiducials, "FILE",
              "Instead of a board: lines of `id x y [angle]`, ArUco 4x4_50, mm of the rig")
      .option("--lens", o->lens, "FILE.json", "The lens (default: the archive's, of --camera)")
      .option("--check-distance", o->request.distance_mm, 0, 1e6,
              "In mm, from lens to board by a ruler: are the squares as large as told?")
      .option("--out", o->out, "FILE.json", "Also write the view there")
      .option("--camera", o->camera, "ID", "Keep it in the archive, as this camera's");
}

}  // namespace patina::app
