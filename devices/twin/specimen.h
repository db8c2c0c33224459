// SPDX-License-Identifier: GPL-3.0-or-later
// A surface that ages, with the truth for every texel and time.
//
// Specimens lie in the plane z = 0 of the rig's frame: origin in the middle, x right, y up, in mm,
// z to the camera. They have no edge: a grid may reach beyond width_mm.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "processing/brdf/abc.h"
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

// Where texels lie: any smooth arrangement in rows and columns, e.g. what a camera's pixels see
// through its lens.
struct SampleGrid {
  SizePx size;
  std::vector<float> x_mm, y_mm;  // [h][w], centres of the texels
  float texel_mm = 1;             // typical distance of neighbours: finer detail is filtered out

  std::size_t index(int x, int y) const { return static_cast<std::size_t>(y) * size.width + x; }
  // The grid of surfaceAt(): square texels, `width_mm` from the left edge to the right.
  static SampleGrid regular(SizePx size, double width_mm);
};

// One row of truth, channels apart, so that loops over texels vectorise. Owned, reusable.
class SurfaceRow {
 public:
  enum Channel {
    kDiffuseR,
    kDiffuseG,
    kDiffuseB,
    kSpecularR,
    kSpecularG,
    kSpecularB,
    kRoughness,
    kNormalX,
    kNormalY,
    kNormalZ,
    kHeight,
    kDegree,
    kChannels
  };
  explicit SurfaceRow(int width)
      : width_(width), values_(static_cast<std::size_t>(width) * kChannels) {}
  int width() const { return width_; }
  float* operator[](Channel c) { return values_.data() + static_cast<std::size_t>(c) * width_; }
  const float* operator[](Channel c) const {
    return values_.data() + static_cast<std::size_t>(c) * width_;
  }

 private:
  int width_;
  std::vector<float> values_;
};

// A specimen on one grid, everything that does not depend on time worked out. Immutable.
class PreparedSurface {
 public:
  virtual ~PreparedSurface() = default;
  virtual void rowAt(double time, int y, SurfaceRow& row) const = 0;  // O(width)
};

// Gloss taken from measured materials: the specular part of a texel's reflectance is
// mix(fresh, aged, degree), in place of GGX. The diffuse part comes from the row as ever; the row's
// specular and roughness hold the nearest GGX equivalents (brdf::nearestGgx), mixed likewise, for
// whoever knows no other model.
struct MeasuredReflectance {
  brdf::AbcLobe fresh, aged;
};

// Thread-safe for reading; pure in (seed, time, grid). `time` is the share of the process's
// duration in [0,1]; any time at once, without the ones before. Resolution-independent.
class Specimen {
 public:
  virtual ~Specimen() = default;
  virtual const SpecimenInfo& info() const = 0;
  virtual std::shared_ptr<const PreparedSurface> prepare(const SampleGrid& grid) const = 0;
  // Truth on the regular grid of `size`, which stays prepared until another size is asked for.
  virtual SurfaceMaps surfaceAt(double time, SizePx size) const = 0;
  // Not null: see MeasuredReflectance. Lives as long as the specimen.
  virtual const MeasuredReflectance* measured() const { return nullptr; }
};

std::vector<SpecimenInfo> listSpecimens();
// "NAME", or "NAME+NAME" for two processes at once (paired_processes.h). Throws
// ProcessingError(kUsage) naming the specimens there are.
std::unique_ptr<Specimen> makeSpecimen(const std::string& name, std::uint64_t seed);

// All maps of a prepared surface; rows in parallel.
SurfaceMaps mapsAt(const PreparedSurface& surface, double time, SizePx size);

}  // namespace patina::devices::twin
