// SPDX-License-Identifier: GPL-3.0-or-later
// The options by which frames of a run are chosen and corrected, for every verb that takes a run.
#pragma once

#include <memory>

#include "calibration/lens/rectification.h"
#include "capture/app/command_line.h"
#include "capture/workflow/archive_frames.h"
#include "capture/workflow/sequence.h"

namespace patina::app {

struct FrameOptions {
  workflow::FrameSelection selection;
  workflow::Correction correction;
  bool uncorrected = false;
};
// `options` lives until the verb has run.
void addFrameOptions(Verb& verb, FrameOptions& options);
int parseExposureNumber(const std::string& text);
calibration::RegionMm parseRegionMm(const std::string& text);  // "LEFT,BOTTOM,WIDTH,HEIGHT"
workflow::Correction correctionOf(const FrameOptions& options);

// IN of film, sheet and keogram: a TTF file that is there, else a TTF or run of the archive.
workflow::Sequence openSequence(const Context& context, const std::string& in,
                                const FrameOptions& options);

}  // namespace patina::app
