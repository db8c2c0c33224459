// SPDX-License-Identifier: GPL-3.0-or-later
// Builds a TTF from a FrameSource, streaming: peak memory a few frames at any length.
#pragma once

#include <optional>

#include "processing/image/progress.h"
#include "processing/ttf/frame_source.h"
#include "processing/ttf/ttf_file.h"

namespace patina::ttf {

struct BuildOptions {
  std::optional<RectPx> region = {};  // of interest, px of the source frames; nothing: all
  int every = 1;                      // keep frame 0, every, 2*every ... of those that are there
  double scale = 1.0;                 // linear value stored as 65535
  double mm_per_texel = 0;
  bool compress = false;
  void check() const;  // throws ProcessingError(kUsage): field, value, range
};
struct BuildReport {
  int frames = 0;
  std::int64_t clipped_samples = 0;  // beyond [0, scale]
};

// Frames whose size differs from the first are an error here: the source brings them to one size.
BuildReport buildTtf(FrameSource& source, const BuildOptions& options, const TtfInfo& about,
                     const std::filesystem::path& out, Progress& progress);

}  // namespace patina::ttf
