// SPDX-License-Identifier: GPL-3.0-or-later
// patina render SCENE: meshes that wear textures, lit and seen. A folder is a set (render_set.h).
#include <unistd.h>

#include <algorithm>
#include <filesystem>

#include "capture/app/context.h"
#include "capture/app/verbs/render_set.h"
#include "capture/app/verbs/verbs.h"
#include "capture/scene/scene_pictures.h"
#include "processing/image/encoding.h"
#include "processing/image/film_file.h"
#include "processing/image/picture_file.h"

namespace patina::app {
namespace {

namespace fs = std::filesystem;

constexpr int kStripTimes = 5;

struct Options {
  std::string in, out, strip, light = "0,0,1", local_rate, local_start;
  bool top = false;
  std::optional<double> time;
  std::optional<SizePx> size;
  int samples = 0, frames = 0, quality_crf = 18;
  double rate = 24;
};

bool isFilm(const Options& options) { return fs::path(options.out).extension() == ".mp4"; }

void check(const Options& options) {
  const std::string kind = fs::path(options.out).extension();
  if (kind != ".png" && kind != ".exr" && kind != ".mp4")
    throw AppError(Exit::kUsage,
                   "a scene is written as .png, .exr or .mp4, not as '" + options.out + "'");
  if (options.time && isFilm(options))
    throw AppError(Exit::kUsage, "a film shows all times: --time is for a picture");
  if (!options.strip.empty() && (!isFilm(options) || fs::path(options.strip).extension() != ".png"))
    throw AppError(Exit::kUsage, "--strip goes beside a film, and is written as .png");
}

scene::SceneFile sceneOf(const Options& options) {
  scene::SceneFile file = scene::readScene(options.in);
  if (options.size) file.scene.camera.size = *options.size;
  if (options.samples > 0) file.options.samples = options.samples;
  return file;
}

Image<std::uint8_t> shown(Image<float> picture, double gain) {
  for (float& v : picture.texels()) v *= static_cast<float>(gain);
  return encodeSrgb8(picture.view());
}

class Strip {
 public:
  explicit Strip(SizePx size)
      : size_(size),
        stride_(size.width + std::max(2, size.width / 64)),
        picture_(stride_ * kStripTimes - (stride_ - size.width), size.height, 3, 255) {}

  void put(int place, ImageView<const std::uint8_t> picture) {
    for (int y = 0; y < size_.height; ++y)
      std::copy_n(picture.row(y), static_cast<std::size_t>(size_.width) * 3,
                  picture_.view().texel(place * stride_, y).data());
  }
  ImageView<const std::uint8_t> view() const { return picture_.view(); }

 private:
  SizePx size_;
  int stride_;
  Image<std::uint8_t> picture_;
};

double writeFilm(Context& context, const Options& options, scene::ScenePictures& pictures,
                 const render::RenderOptions& how) {
  FilmOptions film_options;
  film_options.frames_per_second = options.rate;
  film_options.quality_crf = options.quality_crf;
  FilmWriter film(options.out, pictures.size(), film_options);
  const double gain = pictures.gain(how.seed, context.progress);
  Strip strip(pictures.size());
  const int last = static_cast<int>(pictures.count()) - 1;
  for (int i = 0; i <= last; ++i) {
    const Image<std::uint8_t> frame =
        shown(pictures.at(static_cast<std::size_t>(i), how, context.progress), gain);
    film.add(frame.view());
    for (int k = 0; k < kStripTimes; ++k)
      if (k * last / (kStripTimes - 1) == i) strip.put(k, frame.view());
  }
  if (!options.strip.empty()) writePng(options.strip, strip.view());
  film.close();
  return gain;
}

double writePicture(Context& context, const Options& options, scene::ScenePictures& pictures,
                    const render::RenderOptions& how) {
  const bool is_linear = fs::path(options.out).extension() == ".exr";
  const double gain = is_linear ? 1 : pictures.gain(how.seed, context.progress);
  const Image<float> picture = pictures.at(0, how, context.progress);
  if (is_linear)
    writeExr(options.out, picture.view());
  else
    writePng(options.out, shown(picture, gain).view());
  return gain;
}

void render(Context& context, const Options& options) {
  if (fs::is_directory(options.in)) {
    renderSet(context, {options.in, options.light, options.out, options.time.value_or(0.5),
                        options.top, options.local_rate, options.local_start});
    return;
  }
  check(options);
  scene::SceneFile file = sceneOf(options);
  render::RenderOptions how = file.options;
  how.seed = context.seed();
  const int frames = isFilm(options) ? (options.frames > 0 ? options.frames : 96) : 1;
  const std::vector<double> times =
      isFilm(options) ? scene::evenTimes(frames) : std::vector<double>{options.time.value_or(0.5)};
  const fs::path scratch = options.out + ".tmp" + std::to_string(getpid());
  scene::ScenePictures pictures(std::move(file), times, scratch, context.progress);
  const double gain = isFilm(options) ? writeFilm(context, options, pictures, how)
                                      : writePicture(context, options, pictures, how);
  context.out.asList();
  Item item = std::move(Item()
                            .set("path", options.out.c_str())
                            .set("frames", frames)
                            .set("width_px", pictures.size().width)
                            .set("height_px", pictures.size().height)
                            .set("samples", how.samples)
                            .set("gain", Value{gain}));
  if (!options.strip.empty()) item.set("strip_path", options.strip.c_str());
  context.out.add(std::move(item));
}

}  // namespace

void addRenderVerb(Verb root) {
  auto o = std::make_shared<Options>();
  root.verb("render",
            "A scene of meshes that wear textures, as a picture or a film; or a BRDF set under a "
            "light (SET --top --light 0.2,-0.24,0.95)",
            "patina render scene.toml --time 0.5 --out scene.png",
            [o](Context& context) { render(context, *o); })
      .required("SCENE", o->in, "A scene's .toml file, or the folder of a BRDF or ST-BRDF set")
      .flag("--top", o->top, "A set seen from straight above")
      .option("--light", o->light, "X,Y,Z",
              "Of a set: direction to the light; right, up, to the camera (default: 0,0,1)")
      .option("--out", o->out, "FILE", "Where to: .png, .exr (linear) or .mp4")
      .demand("--out")
      .option(
          "--time", o->time,
          [](const std::string& text) {
            char* end = nullptr;
            const double share = std::strtod(text.c_str(), &end);
            if (end == text.c_str() || *end != '\0' || !(share >= 0 && share <= 1))
              throw AppError(Exit::kUsage, "--time is '" + text + "'; it is a share of 0 to 1");
            return share;
          },
          "T", "Share of the whole, of a picture (default: 0.5)")
      .option("--local-rate", o->local_rate, "FILE",
              "Of an ST-BRDF set: how many times as fast each texel ages, a map")
      .option("--local-start", o->local_start, "FILE",
              "Of an ST-BRDF set: how old each texel is when it begins, a map")
      .option("--frames", o->frames, 1, 100'000, "Of a film, evenly over the whole (default: 96)")
      .option("--rate", o->rate, 0.1, 240.0, "Frames a second (default: 24)")
      .option("--crf", o->quality_crf, 0, 51,
              "H.264's loss: 0 none, 18 hardly seen (default), 28 a third of the bytes")
      .option("--strip", o->strip, "FILE", "Five times of the film side by side too: .png")
      .option("--size", o->size, parseSize, "WxH", "In pixels (default: the scene's)")
      .option("--samples", o->samples, 1, 65536, "Rays a pixel (default: the scene's)");
}

}  // namespace patina::app
