// SPDX-License-Identifier: GPL-3.0-or-later
// A specimen as a person sees it: from straight above, under one lamp in a room.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "devices/twin/specimen.h"

namespace patina::devices::twin {

// Linear light [h][w][3]; 1 = a perfect white diffuser in the middle of the specimen. The lamp lies
// in the specimen's frame (mm) and casts shadows; the room gives back a little of its light from
// all around. Rows in parallel. Throws ProcessingError(kUsage) for a lamp that is not above the
// specimen.
Image<float> shadedPicture(const Specimen& specimen, double time, SizePx size,
                           const std::array<double, 3>& lamp_mm);

// One exposure for a whole film. A pixel counts by its brightest channel.
class FilmExposure {
 public:
  FilmExposure();
  void add(ImageView<const float> picture);
  // The factor under which the brightest one in a hundred of all pixels added begin to clip;
  // within 0.3 %. 1 when all are black.
  double gain() const;

 private:
  std::vector<std::int64_t> pixels_;  // by brightness, in steps of 1/256 stop
};

}  // namespace patina::devices::twin
