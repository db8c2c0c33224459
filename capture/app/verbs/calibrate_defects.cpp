// SPDX-License-Identifier: GPL-3.0-or-later
// patina calibrate defects: hot, dead, dim and bright pixels out of the masters of an archive.
#include "capture/app/context.h"
#include "capture/app/verbs/calibrate_verbs.h"
#include "capture/workflow/defects_calibration.h"

namespace patina::app {
namespace {

struct Options {
  workflow::DefectsRequest request;
  int dark = 0, flat = 0;
};

void find(Context& context, Options& options) {
  workflow::DefectsRequest& request = options.request;
  request.dark = options.dark;
  request.flat = options.flat;
  request.command = "patina calibrate defects";
  request.version = PATINA_VERSION;
  const workflow::DefectsOutcome outcome =
      workflow::makeDefects(context.archive(), request, context.clock.utc());
  const calibration::DefectReport& report = outcome.report;
  context.out.asList();
  context.out.add(std::move(Item()
                                .set("id", std::int64_t{outcome.kept.row.id})
                                .set("device_id", outcome.kept.row.device_id.c_str())
                                .set("hot", report.hot)
                                .set("dead", report.dead)
                                .set("dim", report.dim)
                                .set("bright", report.bright)
                                .set("clusters", report.clusters)
                                .set("largest_cluster", report.largest_cluster)
                                .set("temperature_c", Value{outcome.kept.row.temperature_c})
                                .set("sha256", outcome.kept.row.sha256.c_str())
                                .set("path", outcome.kept.path.c_str())));
}

}  // namespace

void addCalibrateDefects(Verb& group) {
  auto o = std::make_shared<Options>();
  group
      .verb("defects", "Pixels that do not measure light, out of the archive's dark and flat",
            "patina calibrate defects --camera cam0 --archive ivy",
            [o](Context& context) { find(context, *o); })
      .option("--camera", o->request.camera, "ID", "The camera")
      .demand("--camera")
      .option("--dark", o->dark, 1, 1'000'000'000, "Which dark (default: the camera's newest)")
      .option("--flat", o->flat, 1, 1'000'000'000, "Which flat (default: the camera's newest)")
      .option("--hot", o->request.options.hot_least, 0, 1,
              "Share of full scale that a hot pixel shows in the dark at least");
}

}  // namespace patina::app
