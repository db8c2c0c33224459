// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/verbs/specimen_place.h"

#include "devices/twin/specimen.h"
#include "devices/twin/twin.h"

namespace patina::app {

workflow::SpecimenPlace placeOfSpecimen(const devices::RigSpec& rig, const std::string& camera) {
  workflow::SpecimenPlace place;
  if (!rig.twin) return place;
  for (const devices::CameraSpec& spec : rig.cameras) {
    if (spec.id != camera || spec.backend != "twin") continue;
    const devices::twin::PictureLayout layout = devices::twin::pictureLayout(rig, spec);
    place.region = layout.specimen_px;
    for (const devices::twin::SpecimenInfo& info : devices::twin::listSpecimens())
      if (info.name == rig.twin->specimen)
        place.mm_per_texel =
            (layout.view_mm > 0 ? layout.view_mm : info.width_mm) / layout.size.width;
  }
  return place;
}

workflow::RigLamps lampsOf(const devices::RigSpec& rig) {
  workflow::RigLamps lamps;
  for (const devices::LightSpec& light : rig.lights) lamps[light.id] = light.position_mm;
  return lamps;
}

}  // namespace patina::app
