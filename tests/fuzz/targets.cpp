// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/fuzz/targets.h"

namespace patina::testing {

const std::vector<FuzzTarget>& fuzzTargets() {
  static const std::vector<FuzzTarget> kTargets = {
      {"plan", fuzzPlan},
      {"rig", fuzzRig},
      {"faults", fuzzFaults},
      {"journal", fuzzJournal},
      {"picture_header", fuzzPictureHeader},
      {"lights", fuzzLights},
  };
  return kTargets;
}

}  // namespace patina::testing
