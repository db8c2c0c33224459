// SPDX-License-Identifier: GPL-3.0-or-later
// The specimens there are, each in a file of its own, and what they share. Private to the twin.
#pragma once

#include <memory>
#include <mutex>

#include "devices/twin/specimen.h"

namespace patina::devices::twin {

const SpecimenInfo& bananaInfo();
std::unique_ptr<Specimen> makeBanana(std::uint64_t seed);
const SpecimenInfo& copperInfo();
std::unique_ptr<Specimen> makeCopper(std::uint64_t seed);
const SpecimenInfo& grassInfo();
std::unique_ptr<Specimen> makeGrass(std::uint64_t seed);
const SpecimenInfo& paintInfo();
std::unique_ptr<Specimen> makePaint(std::uint64_t seed);
const SpecimenInfo& steelInfo();
std::unique_ptr<Specimen> makeSteel(std::uint64_t seed);
const SpecimenInfo& woodInfo();
std::unique_ptr<Specimen> makeWood(std::uint64_t seed);
const SpecimenInfo& greyCardInfo();
std::unique_ptr<Specimen> makeGreyCard(std::uint64_t seed);
const SpecimenInfo& snowInfo();
std::unique_ptr<Specimen> makeSnow(std::uint64_t seed);

// The last regular grid asked for, prepared. Thread-safe.
class RegularSurface {
 public:
  SurfaceMaps at(const Specimen& specimen, double time, SizePx size);

 private:
  std::mutex mutex_;
  SizePx size_;
  std::shared_ptr<const PreparedSurface> surface_;
};

}  // namespace patina::devices::twin
