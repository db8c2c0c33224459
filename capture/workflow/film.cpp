// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/film.h"

#include <cmath>

#include "capture/workflow/failure.h"
#include "processing/image/film_file.h"

namespace patina::workflow {

double gainOf(const Sequence& sequence, const ShowOptions& options, Progress& progress) {
  return options.exposure ? std::exp2(options.exposure->value) : displayGain(sequence, progress);
}

double filmRate(std::int64_t frames) {
  constexpr double kWantedSeconds = 15;
  double best = 25, best_off = HUGE_VAL;
  for (const double rate :
       {1.0, 2.0, 3.0, 5.0, 8.0, 10.0, 12.0, 15.0, 20.0, 25.0, 30.0, 50.0, 60.0}) {
    const double off = std::abs(std::log(static_cast<double>(frames) / rate / kWantedSeconds));
    if (off < best_off) {
      best_off = off;
      best = rate;
    }
  }
  return best;
}

FilmOutcome makeFilm(const Sequence& sequence, const FilmRequest& request,
                     const std::filesystem::path& mp4, Progress& progress) {
  if (mp4.extension() != ".mp4")
    throw WorkflowError(Exit::kUsage, "a film is written as .mp4, not as '" + mp4.string() + "'");
  FilmOutcome outcome;
  outcome.gain = gainOf(sequence, request.show, progress);
  const auto source = sequence.open(request.every);
  outcome.frames = source->count();
  if (outcome.frames < 1) throw WorkflowError(Exit::kBadData, sequence.name + " has no frames");
  FilmOptions options;
  options.frames_per_second =
      request.frames_per_second > 0 ? request.frames_per_second : filmRate(outcome.frames);
  options.quality_crf = request.quality_crf;
  outcome.frames_per_second = options.frames_per_second;
  outcome.size = sequence.size;
  outcome.length = fromSeconds(static_cast<double>(outcome.frames) / options.frames_per_second);
  FilmWriter film(mp4, sequence.size, options);
  progress.begin("writing the film", outcome.frames);
  while (const auto frame = source->next()) {
    const Image<std::uint8_t> shown = toDisplay(frame->linear.view(), outcome.gain);
    film.add(shown.view());
    progress.step();
  }
  film.close();
  return outcome;
}

}  // namespace patina::workflow
