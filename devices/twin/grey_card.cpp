// SPDX-License-Identifier: GPL-3.0-or-later
// A flat, even, perfectly diffuse card of 50 %: for flats and for measuring the camera.
#include <algorithm>

#include "devices/twin/specimens.h"

namespace patina::devices::twin {

namespace {

constexpr float kAlbedo = 0.5f;

class GreySurface final : public PreparedSurface {
 public:
  void rowAt(double, int, SurfaceRow& row) const override {
    const auto fill = [&](SurfaceRow::Channel c, float v) { std::fill_n(row[c], row.width(), v); };
    for (const auto c : {SurfaceRow::kDiffuseR, SurfaceRow::kDiffuseG, SurfaceRow::kDiffuseB})
      fill(c, kAlbedo);
    for (const auto c :
         {SurfaceRow::kSpecularR, SurfaceRow::kSpecularG, SurfaceRow::kSpecularB,
          SurfaceRow::kNormalX, SurfaceRow::kNormalY, SurfaceRow::kHeight, SurfaceRow::kDegree})
      fill(c, 0);
    fill(SurfaceRow::kRoughness, 1);
    fill(SurfaceRow::kNormalZ, 1);
  }
};

class GreyCard final : public Specimen {
 public:
  const SpecimenInfo& info() const override { return greyCardInfo(); }
  std::shared_ptr<const PreparedSurface> prepare(const SampleGrid&) const override {
    return std::make_shared<GreySurface>();
  }
  SurfaceMaps surfaceAt(double time, SizePx size) const override {
    return mapsAt(GreySurface(), time, size);
  }
};

}  // namespace

const SpecimenInfo& greyCardInfo() {
  static const SpecimenInfo info{"grey_card", "an even grey card of 50 %, which does not age",
                                 std::chrono::hours(24), 80};
  return info;
}

std::unique_ptr<Specimen> makeGreyCard(std::uint64_t) { return std::make_unique<GreyCard>(); }

}  // namespace patina::devices::twin
