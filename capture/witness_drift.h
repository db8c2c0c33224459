// SPDX-License-Identifier: GPL-3.0-or-later
// Witnesses of one light that no single shot sets at odds, and the run does: each followed a drift
// of its own. A patch that dirt, snow or growth covers slowly looks like a lamp that drifts, and
// its gain undoes what was never there; a lux sensor knows better.
#pragma once

#include <span>
#include <string>

#include "db/rows.h"

namespace patina::capture {

std::string percent(double share);  // "+6.1 %"

// Of the rows of one judged shot: the first patch (its green) and lux sensor whose changes since
// each was learned differ by more than `band`, a share: "patch:cam0 (+6.1 %) and sensor:lux0
// (-0.2 %) have drifted apart ...". Empty while all agree; rows that were not taken do not count.
std::string driftedApart(std::span<const db::LightCheckRow> rows, double band);

}  // namespace patina::capture
