// SPDX-License-Identifier: GPL-3.0-or-later
// A USB device served by this process to this machine: configfs and FunctionFS on the kernel's
// dummy_hcd. Its other end is the real host stack. Root, and a machine that may be spoilt: the
// guest.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "devices/clock.h"
#include "processing/image/picture_file.h"

namespace patina::testing {

struct GadgetIdentity {
  std::string name;  // of its folders; one word
  std::uint16_t vendor = 0, product = 0;
  std::string manufacturer = "Patina", model, serial;
};

// A control request that the kernel does not answer by itself: 8 bytes, and what the host sent with
// it. The answer goes to the host; nothing: the request is stalled.
using OnSetup = std::function<std::optional<Bytes>(std::span<const std::byte, 8> setup,
                                                   std::span<const std::byte> data)>;

// Threads that serve endpoints end when it is destroyed, and so must end at stopping().
class UsbGadget {
 public:
  // `interface`: its descriptor, those of its class and of its endpoints, at high speed. Throws
  // std::system_error where the kernel has no such thing. Plugged out at first.
  UsbGadget(const GadgetIdentity& who, const Bytes& interface, int endpoints, OnSetup on_setup,
            devices::Clock& clock);
  ~UsbGadget();
  UsbGadget(const UsbGadget&) = delete;
  UsbGadget& operator=(const UsbGadget&) = delete;

  void plugIn();
  void unplug();  // as a cable is pulled
  // The host has let go of it, by unplugging or reset: called from the control thread.
  void onDisable(std::function<void()> call);

  // Endpoint 1, 2, ... in the order of its descriptors. Blocking calls on it end with EINTR when
  // the gadget stops.
  int endpoint(int number) const { return endpoints_.at(static_cast<std::size_t>(number - 1)); }
  // Runs `serve` again and again until the gadget stops.
  void serve(std::function<void()> serve);
  bool stopping() const { return stopping_; }

 private:
  void makeFolders(const GadgetIdentity& who);
  void describe(const Bytes& interface);
  void serveControl();
  void answer(std::span<const std::byte, 8> setup);
  void removeFolders();

  const std::string gadget_, function_, mount_;  // folders
  OnSetup on_setup_;
  devices::Clock& clock_;
  int control_ = -1;
  std::vector<int> endpoints_;
  std::mutex mutex_;
  std::function<void()> on_disable_;  // guarded by mutex_
  std::atomic<bool> stopping_ = false;
  std::vector<std::thread> threads_;
  std::atomic<int> running_ = 0;
};

}  // namespace patina::testing
