// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "capture/workflow/after_run.h"
#include "devices/rig.h"

namespace patina::app {

// The specimen in a camera's picture when the rig is a twin's; the whole picture otherwise.
workflow::SpecimenPlace placeOfSpecimen(const devices::RigSpec& rig, const std::string& camera);

workflow::RigLamps lampsOf(const devices::RigSpec& rig);

}  // namespace patina::app
