// SPDX-License-Identifier: GPL-3.0-or-later
// Which sensors cannot be believed, by what they say themselves: one at the end of its range, and a
// lux sensor that says the same to the bit, three times in a row, with lamps at rest and with more
// of them lit. That light was there is for a picture to show.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "capture/light_gate.h"

namespace patina::capture {

// Single-threaded. Knows nothing of readings before the process began.
class SensorWatch {
 public:
  // Before a step, the lamps of `lit` on.
  void atRest(const SensorSample& sample, const std::vector<std::string>& lit);
  // Lux, during a shot. `seen`: its picture is not dark.
  void duringShot(const SensorSample& sample, const std::string& light_state,
                  const std::vector<std::string>& lit, bool seen);
  // Empty while nothing speaks against it.
  std::string doubt(const std::string& sensor) const;

 private:
  struct Watched {
    std::optional<double> rest;
    std::vector<std::string> rest_lit;
    std::set<std::string> saturated;  // light states; "" at rest
    int unmoved = 0;                  // in a row
    std::string says;                 // what is doubtful
  };
  std::map<std::string, Watched> sensors_;
};

}  // namespace patina::capture
