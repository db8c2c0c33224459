// SPDX-License-Identifier: GPL-3.0-or-later
// patina twin specimens [list | render | film]: the simulated surfaces and their truth.
#include "capture/app/context.h"
#include "capture/app/verbs/twin_camera.h"
#include "capture/app/verbs/twin_film.h"
#include "capture/app/verbs/verbs.h"
#include "devices/twin/specimen.h"
#include "processing/brdf/brdf_file.h"

namespace patina::app {
namespace {

void list(Context& context) {
  for (const devices::twin::SpecimenInfo& info : devices::twin::listSpecimens())
    context.out.add(std::move(Item()
                                  .set("name", info.name.c_str())
                                  .set("duration_ns", info.duration)
                                  .set("width_mm", Value{info.width_mm})
                                  .set("description", info.description.c_str())));
}

struct Options {
  std::string name, out;
  double time = 0.5;
  SizePx size{512, 512};
};

// A BRDF set (design, section 6) with the truth beside it, in a folder that appears whole.
void render(Context& context, const Options& options) {
  refuseThatIsThere({options.out});
  if (options.size.width < 1 || options.size.height < 1 || options.size.width > 16384 ||
      options.size.height > 16384)
    throw AppError(Exit::kUsage, "--size must lie between 1x1 and 16384x16384");
  const auto specimen = devices::twin::makeSpecimen(options.name, context.seed());
  devices::twin::SurfaceMaps truth = specimen->surfaceAt(options.time, options.size);
  brdf::BrdfSetInfo info;
  if (specimen->measured())
    info.facts.text("gloss", "measured materials; Specular and Roughness are the nearest GGX");
  info.facts.text("specimen", options.name).number("time", options.time);
  info.facts.count("seed", static_cast<std::int64_t>(context.seed()));
  info.facts.number("mm_per_texel", specimen->info().width_mm / options.size.width);
  brdf::BrdfMaps maps{std::move(truth.diffuse),
                      std::move(truth.specular),
                      std::move(truth.roughness),
                      std::move(truth.normal),
                      {}};
  maps.extra["Height"] = std::move(truth.height);
  maps.extra["degree"] = std::move(truth.degree);
  brdf::writeBrdfSet(options.out, info, maps);
  context.out.asList();
  context.out.add(std::move(Item()
                                .set("path", options.out.c_str())
                                .set("specimen", options.name.c_str())
                                .set("time", Value{options.time})
                                .set("width_px", options.size.width)
                                .set("height_px", options.size.height)));
}

}  // namespace

void addTwinVerbs(Verb root) {
  Verb twin = root.group("twin", "The simulated rig");
  Verb specimens = twin.group("specimens", "The virtual specimens");
  specimens.byDefault([](Context& context) { list(context); });
  specimens.verb("list", "Their names and what happens to them", "patina twin specimens list",
                 [](Context& context) { list(context); });
  auto o = std::make_shared<Options>();
  specimens
      .verb("render", "Their truth at one time, as maps",
            "patina twin specimens render banana_ripening --time 0.5 --size 512x512 --out banana",
            [o](Context& context) { render(context, *o); })
      .required("NAME", o->name, "A specimen's name")
      .option("--time", o->time, 0.0, 1.0, "Share of the whole process")
      .option("--size", o->size, parseSize, "WxH", "In pixels")
      .option("--out", o->out, "FOLDER", "Where to")
      .demand("--out");
  addTwinFilmVerb(specimens);
  addTwinTtfVerb(specimens);
  addTwinCameraVerb(twin);
}

}  // namespace patina::app
