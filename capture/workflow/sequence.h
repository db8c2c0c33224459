// SPDX-License-Identifier: GPL-3.0-or-later
// Frames in order of time that can be gone through more than once: a TTF file or a run.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "capture/workflow/archive_frames.h"
#include "processing/ttf/frame_source.h"
#include "processing/ttf/ttf_file.h"

namespace patina::workflow {

struct Sequence {
  std::string name;  // of the file or the run
  std::int64_t frames = 0;
  SizePx size;
  UtcTime t0_utc;
  bool display_referred = false;  // made of pictures that were exposed for the eye
  // From the start, every n-th frame. What it uses lives as long as the sequence.
  std::function<std::unique_ptr<ttf::FrameSource>(int every)> open;
  std::vector<std::string> input_sha256s;
};

Sequence sequenceOfTtf(const std::filesystem::path& file);
Sequence sequenceOfRun(std::shared_ptr<const db::ArchiveReader> reader, const std::string& run_id,
                       const FrameSelection& selection, const Correction& correction);

bool isDisplayReferred(const ttf::TtfInfo& info);  // as its provenance says

// One factor for the whole sequence, so that its frames stay comparable: display-referred pictures
// keep theirs (1); others are set so that 99.5 % of the samples of nine frames lie below 0.9.
double displayGain(const Sequence& sequence, Progress& progress);

// sRGB, 8 bits, three channels.
Image<std::uint8_t> toDisplay(ImageView<const float> linear, double gain);

}  // namespace patina::workflow
