// SPDX-License-Identifier: GPL-3.0-or-later
// An object and its shadow, keyed out of a photograph (processing/matte): as a folder of pictures,
// and laid over the frames of a texture (Enrique et al. 2005, figure 10).
#pragma once

#include <filesystem>
#include <memory>

#include "capture/workflow/sequence.h"

namespace patina::matte {
struct Keyed;
}

namespace patina::workflow {

struct Overlay {
  Image<float> object;  // [h][w][3] linear, as displayed: 1 = white
  Image<float> mask;    // [h][w][1] its cover, 0 to 1
  Image<float> shadow;  // [h][w][1] what it leaves of the light, 0 to 1
};

// `folder` with object.png, mask.png and shadow.png appears whole or not at all. Throws
// WorkflowError(kCannotCreate) when it is there already.
void writeOverlay(const matte::Keyed& keyed, const std::filesystem::path& folder);
// Throws WorkflowError(kBadData) when the three differ in size, or as readPicture().
Overlay readOverlay(const std::filesystem::path& folder);

// Frames that are shown `gain` times as bright as they are, under the overlay, which is resized to
// them. Throws WorkflowError(kUsage) when its shape differs from theirs by more than 2 %.
Sequence overlaid(const Sequence& sequence, const Overlay& overlay, double gain);

}  // namespace patina::workflow
