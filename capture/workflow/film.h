// SPDX-License-Identifier: GPL-3.0-or-later
// A film of a sequence.
#pragma once

#include <filesystem>
#include <optional>

#include "capture/workflow/sequence.h"
#include "processing/image/progress.h"

namespace patina::workflow {

struct ShowOptions {
  std::optional<Stops> exposure;  // nothing: displayGain()
};
double gainOf(const Sequence& sequence, const ShowOptions& options, Progress& progress);

struct FilmRequest {
  ShowOptions show;
  double frames_per_second = 0;  // 0: so that the film lasts about 15 s
  int quality_crf = 18;          // as FilmOptions
  int every = 1;
};
struct FilmOutcome {
  std::int64_t frames = 0;
  double frames_per_second = 0, gain = 1;
  Nanoseconds length{};
  SizePx size;
};
FilmOutcome makeFilm(const Sequence& sequence, const FilmRequest& request,
                     const std::filesystem::path& mp4, Progress& progress);

// The customary rate under which `frames` last nearest to 15 s.
double filmRate(std::int64_t frames);

}  // namespace patina::workflow
