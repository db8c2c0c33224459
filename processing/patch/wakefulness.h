// SPDX-License-Identifier: GPL-3.0-or-later
// Which target patches are worth judging again. Fewer than one candidate in a hundred is taken, and
// a patch whose neighbours show what they showed before has the same candidates as before: it
// sleeps until something near it changes.
#pragma once

#include <cstdint>
#include <vector>

#include "processing/image/units.h"

namespace patina::patch {

class Wakefulness {
 public:
  // A change keeps the patches next to it awake for `passes` passes (1 to 7), its own among them.
  Wakefulness(SizePx target, bool wraps, int passes);

  void wakeAll();
  void wakeOnly(const std::vector<std::uint8_t>& map);  // where it is not 0; votes: everywhere
  void beginPass();  // spreads what changed before; call from one thread

  // In a pass. Each index is written by one thread only; others read it when that thread rests.
  bool awake(std::size_t at) const { return awake_[at] != 0; }
  bool changedNow(std::size_t at) const { return (history_[at] & 1) != 0; }
  // In this pass or one of the last `passes`.
  bool changedLately(std::size_t at) const { return (before_[at] | (history_[at] & 1)) != 0; }
  void noteChange(std::size_t at) {
    history_[at] |= 1;
    since_vote_[at] = 1;
  }

  // 1 where a patch within `reach` texels has changed since the last call; forgets them.
  std::vector<std::uint8_t> takeChangesWithin(int reach);

  // 1 where `map` is not 0 within `reach` texels.
  std::vector<std::uint8_t> spread(const std::vector<std::uint8_t>& map, int reach) const;

 private:
  SizePx target_;
  bool wraps_;
  std::uint8_t kept_;
  std::vector<std::uint8_t> history_;  // bit n: changed n passes ago
  std::vector<std::uint8_t> before_;   // the history when this pass began
  std::vector<std::uint8_t> awake_, since_vote_;
};

}  // namespace patina::patch
