// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/paired_processes.h"

#include <cmath>

#include "devices/twin/row_loop.h"
#include "devices/twin/specimens.h"

namespace patina::devices::twin {

namespace {

using S = SurfaceRow;

// `under` becomes the pair.
void lay(const SurfaceRow& over, SurfaceRow& under) {
  const int width = under.width();
  const float* share = over[S::kDegree];
  for (int c = 0; c < S::kDegree; ++c) {
    const auto channel = static_cast<S::Channel>(c);
    float* below = under[channel];
    const float* above = over[channel];
    PATINA_INDEPENDENT_TEXELS
    for (int x = 0; x < width; ++x) below[x] += (above[x] - below[x]) * share[x];
  }
  float *nx = under[S::kNormalX], *ny = under[S::kNormalY], *nz = under[S::kNormalZ],
        *degree = under[S::kDegree];
  PATINA_INDEPENDENT_TEXELS
  for (int x = 0; x < width; ++x) {
    const float inverse = 1 / std::sqrt(nx[x] * nx[x] + ny[x] * ny[x] + nz[x] * nz[x]);
    nx[x] *= inverse;
    ny[x] *= inverse;
    nz[x] *= inverse;
    degree[x] = 1 - (1 - degree[x]) * (1 - share[x]);
  }
}

class PairedSurface final : public PreparedSurface {
 public:
  PairedSurface(std::shared_ptr<const PreparedSurface> under,
                std::shared_ptr<const PreparedSurface> over)
      : under_(std::move(under)), over_(std::move(over)) {}
  void rowAt(double time, int y, SurfaceRow& row) const override {
    SurfaceRow above(row.width());
    over_->rowAt(time, y, above);
    under_->rowAt(time, y, row);
    lay(above, row);
  }

 private:
  std::shared_ptr<const PreparedSurface> under_, over_;
};

class Pair final : public Specimen {
 public:
  Pair(std::unique_ptr<Specimen> under, std::unique_ptr<Specimen> over)
      : under_(std::move(under)), over_(std::move(over)), info_(under_->info()) {
    info_.name += "+" + over_->info().name;
    info_.description += "; and on it: " + over_->info().description;
  }
  const SpecimenInfo& info() const override { return info_; }
  std::shared_ptr<const PreparedSurface> prepare(const SampleGrid& grid) const override {
    return std::make_shared<PairedSurface>(under_->prepare(grid), over_->prepare(grid));
  }
  SurfaceMaps surfaceAt(double time, SizePx size) const override {
    return regular_.at(*this, time, size);
  }

 private:
  std::unique_ptr<Specimen> under_, over_;
  SpecimenInfo info_;
  mutable RegularSurface regular_;
};

}  // namespace

std::unique_ptr<Specimen> pairProcesses(std::unique_ptr<Specimen> under,
                                        std::unique_ptr<Specimen> over) {
  return std::make_unique<Pair>(std::move(under), std::move(over));
}

}  // namespace patina::devices::twin
