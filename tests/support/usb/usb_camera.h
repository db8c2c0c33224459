// SPDX-License-Identifier: GPL-3.0-or-later
// A virtual DSLR as a USB device below the real libusb and libgphoto2: umockdev redirects /sys,
// /dev and the ioctls of the device's node to here. Programs run under umockdev-wrapper see it, and
// so does the test itself.
#pragma once

#include <memory>
#include <string>

#include "devices/twin/dslr/dslr.h"

namespace patina::testing {

// The /sys and /dev that programs see instead of the machine's. One a process, before any thread
// that would look. Failure when the test does not run under umockdev-wrapper.
class UsbBus {
 public:
  UsbBus();
  ~UsbBus();
  UsbBus(const UsbBus&) = delete;
  UsbBus& operator=(const UsbBus&) = delete;

  static bool isThere();  // whether umockdev-wrapper runs us

 private:
  friend class UsbCamera;
  struct State;
  std::unique_ptr<State> state_;
};

// Plugged in from the beginning. Thread-safe; serves from threads of its own. Camera and bus
// outlive it.
class UsbCamera {
 public:
  // `port` of the hub: 1 to 9. It is device `port` + 1 of bus 1 at first.
  UsbCamera(UsbBus& bus, devices::twin::dslr::Dslr& camera, int port);
  ~UsbCamera();
  UsbCamera(const UsbCamera&) = delete;
  UsbCamera& operator=(const UsbCamera&) = delete;

  // As a cable is pulled: what is under way fails, the node is gone, udev says so.
  void unplug();
  // Into a port, where it becomes a device with a new number, as the kernel does it.
  void plugIn(int port);
  bool isPluggedIn() const;
  int resets() const;  // of the bus, by clients

  std::string gphotoPort() const;  // "usb:001,002": where it is now
  std::string node() const;        // "/dev/bus/usb/001/002"

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace patina::testing
