// SPDX-License-Identifier: GPL-3.0-or-later
#include "db/rows.h"

#include "db/failure.h"

namespace patina::db {

const char* name(Decision d) {
  switch (d) {
    case Decision::kPending:
      return "pending";
    case Decision::kCaptured:
      return "captured";
    case Decision::kSkipped:
      return "skipped";
    case Decision::kMissed:
      return "missed";
    case Decision::kFailed:
      return "failed";
    case Decision::kHeld:
      return "held";
  }
  PATINA_CHECK(!"a decision of the enumeration");
}

Decision parseDecision(const std::string& text) {
  for (const Decision d : {Decision::kPending, Decision::kCaptured, Decision::kSkipped,
                           Decision::kMissed, Decision::kFailed, Decision::kHeld})
    if (text == name(d)) return d;
  throw ArchiveError(Exit::kUsage, "'" + text +
                                       "' is no decision: pending, captured, skipped, missed, "
                                       "failed or held");
}

const char* name(ShotState s) {
  switch (s) {
    case ShotState::kArmed:
      return "armed";
    case ShotState::kCaptured:
      return "captured";
    case ShotState::kFailed:
      return "failed";
    case ShotState::kLost:
      return "lost";
  }
  PATINA_CHECK(!"a state of the enumeration");
}

ShotState parseShotState(const std::string& text) {
  for (const ShotState s :
       {ShotState::kArmed, ShotState::kCaptured, ShotState::kFailed, ShotState::kLost})
    if (text == name(s)) return s;
  throw ArchiveError(Exit::kBadData, "'" + text + "' is no state of a shot");
}

}  // namespace patina::db
