// SPDX-License-Identifier: GPL-3.0-or-later
// A surface that ages, with the truth for every texel and time.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "processing/image/image.h"

namespace patina::devices::twin {

// Truth at one time. All [h][w][c]; linear light.
struct SurfaceMaps {
  Image<float> diffuse;    // rgb albedo in [0,1]
  Image<float> specular;   // rgb reflectance at normal incidence in [0,1]
  Image<float> roughness;  // alpha (GGX) in (0,1], 1 channel
  Image<float> normal;     // unit x right, y up, z to the camera
  Image<float> height;     // mm, 1 channel
  Image<float> degree;     // of weathering, 0 fresh .. 1 aged, 1 channel; never falls
};

struct SpecimenInfo {
  std::string name;         // "banana_ripening"
  std::string description;  // one line, for people
  Nanoseconds duration;     // natural length of the process
  double width_mm;          // of the square that a full picture shows
};

// Thread-safe for reading; pure in (seed, time, size). `time` is the share of the process's
// duration in [0,1]; any time at once, without the ones before. Resolution-independent.
class Specimen {
 public:
  virtual ~Specimen() = default;
  virtual const SpecimenInfo& info() const = 0;
  virtual SurfaceMaps surfaceAt(double time, SizePx size) const = 0;
};

std::vector<SpecimenInfo> listSpecimens();
// Throws ProcessingError(kUsage) naming the specimens there are.
std::unique_ptr<Specimen> makeSpecimen(const std::string& name, std::uint64_t seed);

}  // namespace patina::devices::twin
