// SPDX-License-Identifier: GPL-3.0-or-later
// PTP over USB (PIMA 15740, annex D): the camera's end of its three pipes. It knows no kernel.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <span>

#include "devices/twin/dslr/dslr.h"

namespace patina::testing {

constexpr std::uint8_t kBulkIn = 0x81, kBulkOut = 0x02, kInterruptIn = 0x83;

// What a transfer comes to.
struct UsbTransfer {
  enum Kind { kDone, kStalledPipe, kGone };
  Kind kind = kDone;
  Bytes bytes;  // of an IN transfer
};

// Thread-bound.
class UsbPtp {
 public:
  explicit UsbPtp(devices::twin::dslr::Dslr& camera) : camera_(camera) {}

  // Nothing: not yet. The camera may be silent for long, or for ever.
  std::optional<UsbTransfer> bulkOut(std::span<const std::byte> bytes);
  std::optional<UsbTransfer> bulkIn(std::size_t most);
  std::optional<UsbTransfer> interruptIn(std::size_t most);
  // On the default pipe: 8 bytes of setup; of an IN transfer what it answers.
  UsbTransfer control(std::span<const std::byte> setup, std::span<const std::byte> data);

  void takeEvents();                        // from the camera, for the interrupt pipe
  std::optional<MonoTime> nextDue() const;  // when to try again
  void reset();                             // of the bus: pipes are empty, the session has ended
  bool wantsUnplug() const { return wants_unplug_; }

 private:
  struct Pending {
    Bytes bytes;
    std::size_t sent = 0;
    std::optional<devices::twin::dslr::WireTrouble> trouble;
    std::size_t trouble_at = 0;
  };
  bool isStalled();
  void perform(const devices::twin::dslr::PtpCommand& command);
  void push(Bytes container);
  UsbTransfer meetTrouble();

  devices::twin::dslr::Dslr& camera_;
  std::optional<devices::twin::dslr::PtpCommand> waiting_;  // for its data
  Bytes data_;                                              // its container, as far as it is here
  std::deque<Pending> answers_;
  std::deque<Bytes> events_;
  std::optional<MonoTime> stalled_until_;
  bool wants_unplug_ = false;
};

}  // namespace patina::testing
