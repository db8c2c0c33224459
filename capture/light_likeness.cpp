// SPDX-License-Identifier: GPL-3.0-or-later
// Whose light a refused shot has, if not that of its own lamps. See light_gate.h.
#include <cmath>
#include <set>

#include "capture/light_gate.h"

namespace patina::capture {

std::string LightGate::lightLike(std::span<const db::LightCheckRow> rows) const {
  std::set<std::string> states;
  for (const auto& [key, watched] : series_) states.insert(key.light_state);
  for (const std::string& state : states) {
    int alike = 0, patches = 0;
    for (const db::LightCheckRow& row : rows) {
      if (!row.source.starts_with("patch:") || row.light_state == state) continue;
      ++patches;
      const auto found = series_.find({state, row.source, row.channel, row.exposure_index});
      if (found == series_.end() || !(found->second.series.baseline > 0)) continue;
      alike += std::abs(row.level / found->second.series.forecast - 1) <= check_.band ? 1 : 0;
    }
    if (patches > 0 && alike == patches) return state;
  }
  return "";
}

}  // namespace patina::capture
