// SPDX-License-Identifier: GPL-3.0-or-later
// Who gets between camera and specimen: a hand, an insect. Pure in seed and time; sizes go with the
// shorter side of the picture. They cast no shadow.
#pragma once

#include <cstdint>
#include <vector>

#include "processing/image/units.h"

namespace patina::devices::twin {

// An arm from beyond the picture with a hand at its end, out of focus at its edge: the share of
// each pixel it covers, [h][w]. Its place and direction are seeded.
std::vector<float> handShare(SizePx size, std::uint64_t key);
// Lays it over the light of an RGGB mosaic. `white`: the light of a white card in its place.
void drawHand(std::vector<float>& light, const std::vector<float>& white, SizePx size,
              std::uint64_t key);

struct InsectPlace {
  double x_px = 0, y_px = 0;  // of its middle; pixel centres at halves, y down
  double heading_rad = 0;     // clockwise from +x
  double half_length_px = 0;  // of its body
};
// On its way from one edge of the picture (walked = 0) to the other (1), on a seeded path.
InsectPlace insectAt(SizePx size, std::uint64_t key, double walked);
// Body, head and six legs, near-black.
void drawInsect(std::vector<float>& light, SizePx size, const InsectPlace& place);

}  // namespace patina::devices::twin
