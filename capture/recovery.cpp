// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/recovery.h"

#include <algorithm>

namespace patina::capture {
namespace {

using devices::Errc;
using devices::Rung;

// Where the ladder is entered: what is known of the camera's state decides.
Rung firstRung(Errc code) {
  switch (code) {
    case Errc::kTimeout:
      return Rung::kDrain;
    case Errc::kLost:
      return Rung::kReopen;
    default:
      return Rung::kRetry;
  }
}

}  // namespace

void RecoveryLadder::failed(const devices::Error& error) {
  last_error_ = std::string(devices::name(error.code)) + ": " + error.what;
  const Rung first = firstRung(error.code);
  if (failures_ == 0) {
    rung_ = first;
  } else if (rung_ == Rung::kPowerCycle) {
    down_ = true;
  } else {
    rung_ = std::max(first, static_cast<Rung>(static_cast<int>(rung_) + 1));
  }
  ++failures_;
}

void RecoveryLadder::succeeded() { *this = RecoveryLadder{}; }

Rung RecoveryLadder::rungWhileDown() {
  return ++steps_down_ % 10 == 0 ? Rung::kPowerCycle : Rung::kReset;
}

}  // namespace patina::capture
