// SPDX-License-Identifier: GPL-3.0-or-later
// Trouble on order: what the camera does wrong, to which operation, when.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "devices/twin/dslr/ptp_codes.h"
#include "processing/image/units.h"

namespace patina::devices::twin::dslr {

enum class DslrFaultKind {
  kRefuse,       // answers GeneralError, and does nothing
  kBusy,         // answers DeviceBusy, and does nothing
  kStall,        // does it, and is silent for `duration` (0: until the client goes)
  kReset,        // does it, and resets the connection (USB: is unplugged and comes back)
  kClose,        // does it, and closes the connection in the middle (USB: stalls the pipe)
  kEventsTwice,  // of the next picture
  kEventsLate,   // by `duration` (0: 2 s)
  kEventsNever,
  kStalePicture,    // does not expose: the previous picture comes again, under a new name
  kCardFull,        // for `duration` (0: this capture)
  kSettingChanges,  // the exposure time moves to another choice, without a word
  kPowerLoss        // for `duration` (0: 3 s): session and memory are gone, the card is kept
};

struct DslrFault {
  DslrFaultKind kind = DslrFaultKind::kRefuse;
  std::optional<Operation> operation{};  // none: the next one that the kind befalls by itself
  Nanoseconds duration{};                // kRefuse, kBusy: all such operations for so long
  double amount = 0;  // kStall, kReset, kClose: share of the reply that gets out before, in [0,1)
  Nanoseconds at{};   // of a script: after the camera was made
};

const char* name(DslrFaultKind kind);  // "refuse" "events_late" ...
std::vector<DslrFaultKind> allDslrFaults();

// Thread-bound: its camera's lock guards it.
class Misbehaviour {
 public:
  void order(const DslrFault& fault, MonoTime due);
  // From now on each operation is hit with probability `rate`, by a kind that can befall it; no
  // fault lasts longer than `duration`. Pure in seed and the count of operations. Rate 0: none.
  void randomly(std::uint64_t seed, double rate, Nanoseconds duration);
  void clear();  // orders, windows and chance

  // What befalls this operation; an order is used up by it, save in its window of time.
  std::optional<DslrFault> strike(Operation operation, MonoTime now);
  // An ordered loss of power strikes without any operation.
  std::optional<DslrFault> powerLoss(MonoTime now);
  std::optional<MonoTime> nextPowerLoss() const;

 private:
  struct Order {
    DslrFault fault;
    MonoTime due;
    MonoTime until;  // of a window that is open
  };
  std::optional<DslrFault> byChance(Operation operation);

  std::vector<Order> orders_;
  std::uint64_t seed_ = 0, operations_ = 0;
  double rate_ = 0;
  Nanoseconds longest_{};
};

}  // namespace patina::devices::twin::dslr
