// SPDX-License-Identifier: GPL-3.0-or-later
// patina twin specimens film: a specimen's whole process under one lamp.
#include "capture/app/verbs/twin_film.h"

#include <array>
#include <filesystem>

#include "capture/app/context.h"
#include "devices/twin/specimen_picture.h"
#include "processing/image/encoding.h"
#include "processing/image/film_file.h"
#include "processing/image/picture_file.h"

namespace patina::app {
namespace {

using devices::twin::Specimen;
using Lamp = std::array<double, 3>;

constexpr int kStripTimes = 5;

struct Options {
  std::string name, out, strip;
  SizePx size{256, 256};
  int frames = 120;
  double rate = 24;
  Lamp lamp_mm{-230, 260, 320};  // upper left
};

Lamp parseLamp(const std::string& text) {
  Lamp lamp{};
  const char* at = text.c_str();
  for (int i = 0; i < 3; ++i) {
    char* end = nullptr;
    lamp[static_cast<std::size_t>(i)] = std::strtod(at, &end);
    const bool ends_well = *end == (i < 2 ? ',' : '\0');
    if (end == at || !ends_well || !(std::abs(lamp[static_cast<std::size_t>(i)]) <= 1e5))
      throw AppError(Exit::kUsage, "'" + text +
                                       "' is no place of a lamp: x,y,z in mm, such as "
                                       "-230,260,320 (x right, y up, z to the viewer)");
    at = end + 1;
  }
  if (!(lamp[2] >= 1))
    throw AppError(Exit::kUsage, "--light " + text + ": its z must be at least 1 mm");
  return lamp;
}

void check(const Options& options) {
  if (std::filesystem::path(options.out).extension() != ".mp4")
    throw AppError(Exit::kUsage, "a film is written as .mp4, not as '" + options.out + "'");
  if (!options.strip.empty() && std::filesystem::path(options.strip).extension() != ".png")
    throw AppError(Exit::kUsage, "a strip is written as .png, not as '" + options.strip + "'");
  if (options.size.width < 16 || options.size.height < 16 || options.size.width > 4096 ||
      options.size.height > 4096)
    throw AppError(Exit::kUsage, "--size must lie between 16x16 and 4096x4096");
}

// Five times of the process side by side, a narrow white gap between them.
Image<std::uint8_t> strip(const Specimen& specimen, const Options& options, double gain) {
  const SizePx size = options.size;
  const int gap = std::max(2, size.width / 64), stride = size.width + gap;
  Image<std::uint8_t> out(stride * kStripTimes - gap, size.height, 3, 255);
  for (int i = 0; i < kStripTimes; ++i) {
    Image<float> picture =
        shadedPicture(specimen, static_cast<double>(i) / (kStripTimes - 1), size, options.lamp_mm);
    for (float& v : picture.texels()) v *= static_cast<float>(gain);
    const Image<std::uint8_t> shown = encodeSrgb8(picture.view());
    for (int y = 0; y < size.height; ++y)
      std::copy_n(shown.view().row(y), static_cast<std::size_t>(size.width) * 3,
                  out.view().texel(i * stride, y).data());
  }
  return out;
}

// The film is gone through twice rather than kept: once for its exposure, once to write it.
void film(Context& context, const Options& options) {
  check(options);
  const auto specimen = devices::twin::makeSpecimen(options.name, context.seed());
  const auto pictureOf = [&](int frame) {
    return shadedPicture(*specimen, static_cast<double>(frame) / (options.frames - 1), options.size,
                         options.lamp_mm);
  };
  FilmOptions film_options;
  film_options.frames_per_second = options.rate;
  FilmWriter film(options.out, options.size, film_options);
  devices::twin::FilmExposure exposure;
  context.progress.begin("looking at the exposure", options.frames);
  for (int i = 0; i < options.frames; ++i) {
    exposure.add(pictureOf(i).view());
    context.progress.step();
  }
  const double gain = exposure.gain();
  context.progress.begin("writing the film", options.frames);
  for (int i = 0; i < options.frames; ++i) {
    Image<float> picture = pictureOf(i);
    for (float& v : picture.texels()) v *= static_cast<float>(gain);
    film.add(encodeSrgb8(picture.view()).view());
    context.progress.step();
  }
  if (!options.strip.empty()) writePng(options.strip, strip(*specimen, options, gain).view());
  film.close();
  context.out.asList();
  Item item = std::move(Item()
                            .set("path", options.out.c_str())
                            .set("specimen", options.name.c_str())
                            .set("frames", options.frames)
                            .set("frames_per_second", Value{options.rate})
                            .set("width_px", options.size.width)
                            .set("height_px", options.size.height)
                            .set("gain", Value{gain}));
  if (!options.strip.empty()) item.set("strip_path", options.strip.c_str());
  context.out.add(std::move(item));
}

}  // namespace

void addTwinFilmVerb(Verb specimens) {
  auto o = std::make_shared<Options>();
  specimens
      .verb("film",
            "The whole process under one lamp as a film; one exposure for all of it, under which "
            "1 % of its pixels reach white",
            "patina twin specimens film banana_ripening --out banana.mp4 --strip banana.png",
            [o](Context& context) { film(context, *o); })
      .required("NAME", o->name, "A specimen's name")
      .option("--out", o->out, "FILM", "The film to write: .mp4")
      .demand("--out")
      .option("--size", o->size, parseSize, "WxH", "In pixels (default: 256x256)")
      .option("--frames", o->frames, 2, 100'000, "Evenly over the whole process")
      .option("--rate", o->rate, 0.1, 240.0, "Frames a second")
      .option("--strip", o->strip, "FILE", "Five times side by side too: .png")
      .option("--light", o->lamp_mm, parseLamp, "X,Y,Z",
              "Where the lamp is, in mm from the middle: right, up, to the viewer (default: "
              "-230,260,320, upper left)");
}

}  // namespace patina::app
