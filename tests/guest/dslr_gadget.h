// SPDX-License-Identifier: GPL-3.0-or-later
// The virtual DSLR as a USB gadget: the kernel's own USB stack lies between it and its client.
#pragma once

#include <mutex>

#include "tests/guest/usb_gadget.h"
#include "tests/support/usb/usb_ptp.h"

namespace patina::testing {

class DslrGadget {
 public:
  // The camera outlives it; its clock is a real one.
  explicit DslrGadget(devices::twin::dslr::Dslr& camera);

  UsbGadget& usb() { return usb_; }

 private:
  void serveBulkOut();
  void serveBulkIn();
  void serveInterrupt();
  void pause();

  devices::twin::dslr::Dslr& camera_;
  std::mutex mutex_;
  UsbPtp ptp_;     // guarded by mutex_
  UsbGadget usb_;  // last: its threads use the rest
};

}  // namespace patina::testing
