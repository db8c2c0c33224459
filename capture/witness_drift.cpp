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
  char text[96];
  std::snprintf(text, sizeof text, "%s (%+.1f %%)", row.source.c_str(), (row.ratio - 1) * 100);
  return text;
}

}  // namespace

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
