// SPDX-License-Identifier: GPL-3.0-or-later
// patina ttf key: an object and its shadow off a photograph.
#include <cstdio>

#include "capture/app/context.h"
#include "capture/app/verbs/ttf_verbs.h"
#include "capture/workflow/overlay.h"
#include "processing/image/encoding.h"
#include "processing/image/picture_file.h"
#include "processing/matte/keying.h"

namespace patina::app {
namespace {

struct Options {
  std::string photo, background, out;
  matte::KeyOptions key;
};

// "#20a040", as displayed.
std::optional<matte::PlainColour> colourOf(const std::string& text) {
  unsigned int red = 0, green = 0, blue = 0;
  char rest = 0;
  if (text.size() != 7 ||
      std::sscanf(text.c_str(), "#%2x%2x%2x%c", &red, &green, &blue, &rest) != 3)
    return std::nullopt;
  return matte::PlainColour{{linearFromSrgb(static_cast<float>(red) / 255),
                             linearFromSrgb(static_cast<float>(green) / 255),
                             linearFromSrgb(static_cast<float>(blue) / 255)}};
}

void key(Context& context, const Options& options) {
  const Picture photo = readPicture(options.photo);
  Picture empty;
  matte::Background background;
  if (options.background.starts_with('#')) {
    const auto colour = colourOf(options.background);
    if (!colour)
      throw AppError(Exit::kUsage, "--background is '" + options.background +
                                       "'; a colour is written as #20a040");
    background = *colour;
  } else {
    empty = readPicture(options.background);
    background = std::as_const(empty.linear).view();
  }
  const matte::Keyed keyed =
      matte::keyOut(std::as_const(photo.linear).view(), background, options.key);
  workflow::writeOverlay(keyed, options.out);
  context.out.asList();
  context.out.add(std::move(Item()
                                .set("path", options.out.c_str())
                                .set("width_px", photo.linear.width())
                                .set("height_px", photo.linear.height())
                                .set("noise", Value{keyed.noise})
                                .set("object_share", Value{keyed.object_share})
                                .set("shadow_share", Value{keyed.shadow_share})));
}

}  // namespace

void addTtfKey(Verb ttf) {
  auto o = std::make_shared<Options>();
  ttf.verb("key", "An object and its shadow off a photograph before a plain background",
           "patina ttf key ball.jpg --background '#20a040' --out ball",
           [o](Context& context) { key(context, *o); })
      .required("PHOTO", o->photo, "The photograph")
      .option("--background", o->background, "FILE|#COLOUR",
              "A picture of the empty background, or its colour")
      .demand("--background")
      .option("--threshold", o->key.threshold, 2.0, 1000.0,
              "What differs from the background by so many times its noise is object (default: 8)")
      .option("--difference", o->key.difference, 0.0, 1.0,
              "And by at least so much of its brightness: the object lights it too (default: 0.06)")
      .option("--shadow-blur", o->key.shadow_blur_px, 0.0, 100.0,
              "Smooths the shadow, in pixels (default: 1.5)")
      .option("--out", o->out, "FOLDER",
              "Where to: object.png, mask.png, shadow.png; for --map and --overlay")
      .demand("--out");
}

}  // namespace patina::app
