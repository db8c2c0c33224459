// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/witness_drift.h"

#include <cmath>
#include <cstdio>

namespace patina::capture {
namespace {

bool counts(const db::LightCheckRow& row) {
  return row.baseline > 0 && row.ratio > 0 && (row.verdict == "pass" || row.verdict == "correct");
}

std::string describe(const db::LightCheckRow& row) {
  return row.source + " (" + percent(row.ratio - 1) + ")";
}

}  // namespace

std::string percent(double share) {
  char text[32];
  std::snprintf(text, sizeof text, "%+.1f %%", share * 100);
  return text;
}

std::string driftedApart(std::span<const db::LightCheckRow> rows, double band) {
  for (const db::LightCheckRow& patch : rows) {
    if (!counts(patch) || !patch.source.starts_with("patch:")) continue;
    if (patch.channel != "g" && patch.channel != "y") continue;
    for (const db::LightCheckRow& lux : rows)
      if (counts(lux) && lux.channel == "lx" && std::abs(patch.ratio / lux.ratio - 1) > band)
        return describe(patch) + " and " + describe(lux) +
               " have drifted apart since they were learned: look at the patch";
  }
  return "";
}

}  // namespace patina::capture
