// SPDX-License-Identifier: GPL-3.0-or-later
// Two processes on one surface at once: "steel_rusting+snow_accumulation". Private to the twin.
#pragma once

#include <memory>

#include "devices/twin/specimen.h"

namespace patina::devices::twin {

// `over` lies on `under` as far as it has come: at its degree w every map is (1 - w) under + w over
// (normals made unit again), and the degree is 1 - (1 - degree under) (1 - degree over). Both run
// over the duration and width of `under`; measured gloss is stood for by its nearest GGX.
std::unique_ptr<Specimen> pairProcesses(std::unique_ptr<Specimen> under,
                                        std::unique_ptr<Specimen> over);

}  // namespace patina::devices::twin
