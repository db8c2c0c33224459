// SPDX-License-Identifier: GPL-3.0-or-later
// Which lamp lit each frame of a run, by how it shades the specimen, against what its row says.
#pragma once

#include <string>
#include <vector>

#include "capture/workflow/archive_frames.h"

namespace patina::workflow {

struct StateConfirmation {
  std::string light;
  std::int64_t frames = 0, confirmed = 0, dark = 0, unclear = 0, other = 0;
  double margin_least = 1;  // of those confirmed
};
struct LampConfirmation {
  std::string camera;
  std::vector<StateConfirmation> states;
  // "2024-05-01T10:20 fill: lit by key"; as many as a person reads, then how many more.
  std::vector<std::string> told;
  bool all() const;  // every frame has the light that its row says
  std::string verdict() const;
};
// Of one camera and exposure under every light state but off; two at least. A frame is held
// against the last frame of each state that was confirmed, so that a specimen that ages drops out;
// the first frames of the run are believed, as far as they differ. `selection`'s light is ignored.
// Frames without light gains. Throws WorkflowError(kUsage). O(texels) a frame and state.
LampConfirmation confirmLamps(const db::ArchiveReader& reader, const std::string& run_id,
                              const FrameSelection& selection, Progress& progress);

}  // namespace patina::workflow
