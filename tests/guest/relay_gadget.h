// SPDX-License-Identifier: GPL-3.0-or-later
// The common HID relay board as a USB gadget. Not by the kernel's usb_f_hid: up to Linux 6.1 that
// one answers every question for a report with zeros, and this board is read by such questions.
#pragma once

#include <atomic>
#include <string>

#include "tests/guest/usb_gadget.h"

namespace patina::testing {

class RelayGadget {
 public:
  RelayGadget(const std::string& serial, devices::Clock& clock);  // of five characters

  UsbGadget& usb() { return usb_; }
  unsigned relays() const { return relays_; }  // bit 0 = relay 1
  void stick(bool stuck) { stuck_ = stuck; }   // contacts that do not move any more

 private:
  std::optional<Bytes> onSetup(std::span<const std::byte, 8> setup,
                               std::span<const std::byte> data);

  const std::string serial_;
  std::atomic<unsigned> relays_ = 0;
  std::atomic<bool> stuck_ = false;
  UsbGadget usb_;  // last: its threads use the rest
};

}  // namespace patina::testing
