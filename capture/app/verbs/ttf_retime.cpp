// SPDX-License-Identifier: GPL-3.0-or-later
// patina ttf retime: every texel of a texture ages at a pace of its own.
#include <cstdio>

#include "capture/app/context.h"
#include "capture/app/verbs/ttf_verbs.h"
#include "capture/workflow/products.h"
#include "capture/workflow/sequence.h"
#include "capture/workflow/time_control.h"
#include "processing/mesh/mesh_file.h"

namespace patina::app {
namespace {

struct Options {
  std::string in, out, map, height, light, lamp, mesh;
  std::vector<std::string> casters;
  double lamp_radius = 0, mesh_mm = 0;
  mesh::V3f mesh_turn_deg{0, 0, 0};
  workflow::TimeControl control;
  ttf::RetimeOptions retime;
  std::optional<Nanoseconds> duration;
  int frames = 0;
  bool raw = false;
};

constexpr const char* kBetween[] = {"nearest", "linear", "monotone"};

ttf::Between parseBetween(const std::string& text) {
  for (int i = 0; i < 3; ++i)
    if (text == kBetween[i]) return static_cast<ttf::Between>(i);
  throw AppError(Exit::kUsage, "--between is '" + text + "'; allowed: nearest, linear, monotone");
}

mesh::V3f parseTurn(const std::string& text) {
  mesh::V3f turn;
  char rest = 0;
  if (std::sscanf(text.c_str(), "%f,%f,%f%c", &turn.x, &turn.y, &turn.z, &rest) != 3)
    throw AppError(Exit::kUsage, "--mesh-turn is '" + text + "'; it takes three angles: 90,0,0");
  return turn;
}

workflow::SharedMesh meshOf(const Options& options, const std::string& file) {
  return std::make_shared<mesh::TriangleMesh>(
      placed(mesh::readMesh(file, {options.mesh_mm}), {options.mesh_turn_deg, mesh::V3f(0), 1}));
}

void prepare(Options& options, const ttf::TtfInfo& input, Progress& progress) {
  if (!options.light.empty() && !options.lamp.empty())
    throw AppError(Exit::kUsage, "--light is a direction, --lamp a place: give one of them");
  options.control.map = options.map;
  options.control.height = options.height;
  if (!options.mesh.empty() && !options.height.empty())
    throw AppError(Exit::kUsage, "--mesh and --height are two surfaces: give one of them");
  if (!options.light.empty())
    options.control.lamp = workflow::MovingLamp::parse(options.light, true);
  if (!options.lamp.empty())
    options.control.lamp = workflow::MovingLamp::parse(options.lamp, false);
  if (options.control.lamp) options.control.lamp->radius = options.lamp_radius;
  if (!options.mesh.empty()) options.control.mesh = meshOf(options, options.mesh);
  for (const std::string& caster : options.casters)
    options.control.casters.push_back(meshOf(options, caster));
  options.retime.fastest_as_captured = !options.raw;
  if (options.duration) options.retime.duration_s = toSeconds(*options.duration);
  if (options.frames > 0) options.retime.frames = options.frames;
  // Frames at another rate need no formula.
  if (options.control.rate.empty() && options.control.start.empty() && options.map.empty() &&
      options.frames > 0)
    return;
  workflow::controlTime(options.control, input, options.retime, progress);
}

workflow::Making makingOf(const Options& options, const ttf::TtfInfo& input) {
  workflow::Making making;
  making.command = "patina ttf retime";
  making.version = PATINA_VERSION;
  std::vector<std::string> files{options.in, options.map, options.height, options.mesh};
  files.insert(files.end(), options.casters.begin(), options.casters.end());
  for (const std::string& file : files)
    if (!file.empty()) making.input_sha256s.push_back(sha256OfFile(file).hex());
  workflow::Facts& facts = making.options;
  facts.set("display_referred", workflow::isDisplayReferred(input));
  facts.text("rate", options.control.rate).text("start", options.control.start);
  facts.text("light", options.light).text("lamp", options.lamp);
  facts.number("lamp_radius", options.lamp_radius);
  facts.number("mesh_mm", options.mesh_mm);
  facts.text("mesh_turn_deg", std::to_string(options.mesh_turn_deg.x) + "," +
                                  std::to_string(options.mesh_turn_deg.y) + "," +
                                  std::to_string(options.mesh_turn_deg.z));
  facts.number("height_mm", options.control.height_mm);
  facts.number("mm_per_texel", options.control.mm_per_texel);
  facts.set("raw", options.raw);
  facts.text("between", kBetween[static_cast<int>(options.retime.between)]);
  if (options.retime.duration_s) facts.number("duration_s", *options.retime.duration_s);
  if (options.retime.frames) facts.count("frames", *options.retime.frames);
  return making;
}

void retime(Context& context, Options& options) {
  const ttf::TtfReader input(options.in);
  prepare(options, input.info(), context.progress);
  const ttf::RetimeReport report =
      ttf::retimeTtf(input, options.retime, options.out,
                     makingOf(options, input.info()).facts().json(), context.progress);
  context.out.asList();
  context.out.add(std::move(Item()
                                .set("path", options.out.c_str())
                                .set("frames", report.frames)
                                .set("duration_ns", fromSeconds(report.duration_s))
                                .set("rate_least", Value{report.rate_least})
                                .set("rate_greatest", Value{report.rate_greatest})
                                .set("ended_share", Value{report.ended_share})));
}

}  // namespace

void addTtfRetime(Verb ttf) {
  auto o = std::make_shared<Options>();
  ttf.verb("retime", "Every texel at a pace of its own: by a picture, a light, a shape, a formula",
           "patina ttf retime grass.h5 --lamp 0,0,120 --rate '0.1 + 0.9*light' --out lit.h5",
           [o](Context& context) { retime(context, *o); })
      .required("IN", o->in, "A texture's .h5 file")
      .option("--rate", o->control.rate, "FORMULA",
              "How many times as fast a texel ages, of x y t map height slope curvature light "
              "shadow sky (default: map)")
      .option("--start", o->control.start, "FORMULA",
              "Share of the texture's time that a texel waits first")
      .option("--map", o->map, "FILE", "A picture: white is fast")
      .option("--height", o->height, "FILE", "The surface as a picture of heights")
      .option("--height-mm", o->control.height_mm, -1e6, 1e6,
              "What its white stands for, or 1 in an EXR (default: 1)")
      .option("--mm-per-texel", o->control.mm_per_texel, 0.0, 1e6,
              "Size of a texel (default: as the texture says)")
      .option("--mesh", o->mesh, "FILE",
              "What the texture is wrapped about, in place of --height: .obj, .gltf, .glb")
      .option("--caster", o->casters, "FILE",
              "Another mesh, which throws its shadow on it; again "
              "for more")
      .option("--mesh-mm", o->mesh_mm, 0.0, 1e9,
              "Size of a mesh's unit (default: 1 of an OBJ, 1000 of a glTF)")
      .option("--mesh-turn", o->mesh_turn_deg, parseTurn, "X,Y,Z",
              "Turns meshes about x, then y, then z, in degrees: 90,0,0 where y is up")
      .option("--light", o->light, "X,Y,Z",
              "Direction to the light: right, up, to the viewer; each may be a formula of t: "
              "cos(pi*t),0,sin(pi*t)")
      .option("--lamp", o->lamp, "X,Y,Z", "Place of the light, in mm from the middle; or formulas")
      .option("--lamp-radius", o->lamp_radius, 0.0, 1e6,
              "How wide it is, in mm (of --light: degrees): soft shadows")
      .flag("--raw", o->raw, "Rates as they are; else the fastest texel ages as captured")
      .option("--duration", o->duration, parseDuration, "TIME",
              "Of the result (default: until the fastest texel has ended)")
      .option("--frames", o->frames, 0, 10'000'000, "Evenly over it (default: as captured)")
      .option("--between", o->retime.between, parseBetween, "nearest|linear|monotone",
              "Between captured frames (default: monotone)")
      .option("--out", o->out, "FILE.h5", "Where to")
      .demand("--out");
}

}  // namespace patina::app
