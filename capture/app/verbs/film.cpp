// SPDX-License-Identifier: GPL-3.0-or-later
// patina film IN OUT.mp4: a texture or a run as a film.
#include "capture/workflow/film.h"

#include <cmath>

#include "capture/app/context.h"
#include "capture/app/verbs/film_verbs.h"
#include "capture/app/verbs/verbs.h"
#include "capture/workflow/overlay.h"

namespace patina::app {
namespace {

void film(Context& context, ShowingOptions& options, workflow::FilmRequest request) {
  const workflow::Sequence sequence = openShown(context, options);
  request.show = options.show;
  const workflow::FilmOutcome outcome =
      workflow::makeFilm(sequence, request, options.out, context.progress);
  char length[24];
  std::snprintf(length, sizeof length, "%.1f s", toSeconds(outcome.length));
  context.out.asList();
  context.out.add(std::move(Item()
                                .set("path", options.out.c_str())
                                .set("frames", outcome.frames)
                                .set("frames_per_second", Value{outcome.frames_per_second})
                                .set("length_ns", Value{outcome.length.count()}, length)
                                .set("width_px", outcome.size.width)
                                .set("height_px", outcome.size.height)
                                .set("gain", Value{outcome.gain})));
}

}  // namespace

workflow::Sequence openShown(Context& context, ShowingOptions& options) {
  workflow::Sequence sequence = openSequence(context, options.in, options);
  if (options.overlay.empty()) return sequence;
  const workflow::Overlay overlay = workflow::readOverlay(options.overlay);
  const double gain = workflow::gainOf(sequence, options.show, context.progress);
  options.show.exposure = Stops{std::log2(gain)};
  return workflow::overlaid(sequence, overlay, gain);
}

void addShowingOptions(Verb& verb, ShowingOptions& options, const std::string& in,
                       const std::string& out) {
  verb.required("IN", options.in, in)
      .required("OUT", options.out, out)
      .option(
          "--exposure-stops", options.show.exposure,
          [](const std::string& text) {
            char* end = nullptr;
            const double stops = std::strtod(text.c_str(), &end);
            if (end == text.c_str() || *end != '\0' || !(stops >= -20 && stops <= 20))
              throw AppError(Exit::kUsage, "'" + text + "' is no number of stops (-20 to 20)");
            return Stops{stops};
          },
          "X", "Brighter (or darker) than the linear values (default: chosen once, for all frames)")
      .option("--overlay", options.overlay, "FOLDER",
              "An object and its shadow laid over every frame (ttf key)");
  addFrameOptions(verb, options);
}

void addFilmVerbs(Verb root) {
  auto o = std::make_shared<ShowingOptions>();
  auto request = std::make_shared<workflow::FilmRequest>();
  Verb verb =
      root.verb("film", "A texture or a run as a film (H.264)", "patina film ivy.h5 ivy.mp4",
                [o, request](Context& context) { film(context, *o, *request); });
  addShowingOptions(verb, *o, "A texture's .h5 file, or a texture or run of the archive",
                    "The film to write: .mp4");
  verb.option("--fps", request->frames_per_second, 0.1, 240.0,
              "Frames a second (default: so that it lasts about 15 s)")
      .option("--crf", request->quality_crf, 0, 51,
              "H.264's loss: 0 none, 18 hardly seen (default), 28 a third of the bytes");
}

}  // namespace patina::app
