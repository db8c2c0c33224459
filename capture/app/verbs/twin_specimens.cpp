// SPDX-License-Identifier: GPL-3.0-or-later
// patina twin specimens [list | render | film]: the simulated surfaces and their truth.
#include <unistd.h>

#include "capture/app/context.h"
#include "capture/app/verbs/twin_camera.h"
#include "capture/app/verbs/twin_film.h"
#include "capture/app/verbs/verbs.h"
#include "capture/workflow/facts.h"
#include "devices/twin/specimen.h"
#include "processing/image/picture_file.h"

namespace patina::app {
namespace {

namespace fs = std::filesystem;

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
  if (fs::exists(options.out))
    throw AppError(Exit::kCannotCreate, options.out + " is there already");
  if (options.size.width < 1 || options.size.height < 1 || options.size.width > 16384 ||
      options.size.height > 16384)
    throw AppError(Exit::kUsage, "--size must lie between 1x1 and 16384x16384");
  const auto specimen = devices::twin::makeSpecimen(options.name, context.seed());
  const devices::twin::SurfaceMaps maps = specimen->surfaceAt(options.time, options.size);
  workflow::Facts manifest;
  manifest.text("format", "patina.brdf-set/1").text("model", "ggx").text("roughness", "alpha");
  if (specimen->measured())
    manifest.text("gloss", "measured materials; Specular and Roughness are the nearest GGX");
  manifest.text("specimen", options.name).number("time", options.time);
  manifest.count("seed", static_cast<std::int64_t>(context.seed()));
  manifest.number("mm_per_texel", specimen->info().width_mm / options.size.width);
  const fs::path folder = options.out + ".tmp" + std::to_string(getpid());
  fs::create_directories(folder);
  try {
    writeExr(folder / "Diffuse.exr", maps.diffuse.view());
    writeExr(folder / "Specular.exr", maps.specular.view());
    writeExr(folder / "Roughness.exr", maps.roughness.view());
    writeExr(folder / "Normal.exr", maps.normal.view());
    writeExr(folder / "Height.exr", maps.height.view());
    writeExr(folder / "degree.exr", maps.degree.view());
    writeFileAtomically(folder / "manifest.json", manifest.json() + "\n");
    fs::rename(folder, options.out);
  } catch (...) {
    std::error_code none;
    fs::remove_all(folder, none);
    throw;
  }
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
  addTwinCameraVerb(twin);
}

}  // namespace patina::app
